"""The view of a spreading run in ParaView: the cell cut open on its substrate, and its contact from below.

    pvpython examples/common/paraview_view.py out/spreading_uniform [--time 4us] [--output view.png] [--state view.pvsm]

On a machine without a display write `xvfb-run -a -s -noreset pvpython …` (a server that begins anew when its last client has
gone misses ParaView's second connection). ParaView's window opens the state file by File > Load State; there all times of the
series can be played.
"""

import argparse
import os
import re
import sys
import xml.etree.ElementTree as ElementTree

from paraview import servermanager
from paraview.modules.vtkRemotingViews import vtkPVRenderingCapabilitiesInformation as Capabilities
from paraview.simple import *

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import plot_program

UM = 1e6  # m to the µm of the view
SIZE = [1560, 620]
BLACK, GREY, WHITE = [0.0, 0.0, 0.0], [0.80, 0.80, 0.83], [1.0, 1.0, 1.0]
NUCLEUS = 0  # number of the region, as in the order of the bodies' materials


def parse_time(text):
    match = re.fullmatch(r"\s*([-+.\deE]+?)\s*(s|ms|us|µs|ns)?\s*", text)
    try:
        return float(match[1]) * {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "ns": 1e-9, None: 1.0}[match[2]]
    except (TypeError, ValueError):
        raise argparse.ArgumentTypeError(f'"{text}" is no time; write 4us, or a number of seconds') from None


def check_files(series):
    """ParaView tells of a missing file on its error output only."""
    names = set()
    try:
        entries = list(ElementTree.parse(series).getroot().iter("DataSet"))
    except ElementTree.ParseError as error:
        raise ValueError(f"{series} is no series of ParaView, or it is cut off: {error}.") from None
    for entry in entries:
        path = os.path.join(os.path.dirname(series), entry.get("file"))
        if not os.path.isfile(path):
            raise ValueError(f"{series} names {entry.get('file')}, which is not there.")
        names.add(entry.get("name"))
    if not {"cell", "substrate"} <= names:
        raise ValueError(f"{series} is no series of a cell on a substrate: its bodies are {', '.join(sorted(names)) or 'none'}.")


def check_display():
    """Without a display a ParaView that draws through one dies of a segmentation fault."""
    headless = Capabilities.HEADLESS_RENDERING_USES_EGL | Capabilities.HEADLESS_RENDERING_USES_OSMESA
    if sys.platform.startswith("linux") and not os.environ.get("DISPLAY") and not Capabilities.GetLocalCapabilities() & headless:
        raise ValueError("There is no display, and this ParaView needs one to draw; write xvfb-run -a -s -noreset pvpython … .")


def bond_range(folder):
    """ε of the run, m: the gap below which the surface counts as spread."""
    try:
        with open(os.path.join(folder, "parameters.toml")) as file:
            return float(re.search(r"^bond-range = (\S+)$", file.read(), re.MULTILINE)[1])
    except (OSError, TypeError):
        return 100e-9


def body(series, name):
    """One body in µm: its hexahedra, without the vertices that stand for the particles."""
    block = ExtractBlock(Input=series, Selectors=[f"/Root/{name}"])
    grid = MergeBlocks(Input=block, MergePoints=0)
    solid = ExtractCellsByType(Input=grid, CellTypes=["Hexahedron"])
    scaled = Transform(Input=solid, TransformAllInputVectors=0)
    scaled.Transform.Scale = [UM, UM, UM]
    return scaled


def clip(source, origin, normal):
    """What lies beyond a plane, on the side of its normal."""
    kept = Clip(Input=source, ClipType="Plane", Invert=0)
    kept.ClipType.Origin, kept.ClipType.Normal = origin, normal
    return kept


def behind(source):
    """What is left behind the plane y = 0."""
    return clip(source, [0.0, 0.0, 0.0], [0.0, 1.0, 0.0])


def cut(source):
    result = Slice(Input=source, SliceType="Plane")
    result.SliceType.Origin, result.SliceType.Normal = [0.0, 0.0, 0.0], [0.0, 1.0, 0.0]
    return result


def where(source, array, value):
    """Cells whose corners all have this value."""
    chosen = Threshold(Input=source, Scalars=["POINTS", array], AllScalars=1)
    chosen.LowerThreshold = chosen.UpperThreshold = value  # afterwards: a new array resets the range
    return chosen


def in_unit(source, array, factor, name):
    return Calculator(Input=source, ResultArrayName=name, Function=f"{array}*{factor!r}")


def show(source, view, color=None, **properties):
    shown = Show(source, view)
    shown.Representation = "Surface"
    if color is not None:
        shown.ColorArrayName = [None, ""]
        shown.AmbientColor = shown.DiffuseColor = color
    for name, value in properties.items():
        setattr(shown, name, value)
    return shown


def show_scalar(source, view, array, title, limit, preset, above=None, **properties):
    """Coloured by an array from 0 to `limit`, another colour `above` it; with a bar that says what and in which unit."""
    shown = show(source, view, **properties)
    ColorBy(shown, ("POINTS", array))
    colors = GetColorTransferFunction(array)
    colors.ApplyPreset(preset, True)
    colors.AutomaticRescaleRangeMode = "Never"
    colors.RescaleTransferFunction(0.0, limit)
    if above is not None:
        colors.UseAboveRangeColor, colors.AboveRangeColor = 1, above
    scale = GetScalarBar(colors, view)
    scale.Title, scale.ComponentTitle = title, ""
    scale.TitleColor = scale.LabelColor = BLACK
    scale.TitleFontSize, scale.LabelFontSize = 20, 18
    scale.Orientation, scale.ScalarBarThickness = "Horizontal", 16
    scale.WindowLocation = "Any Location"
    scale.Position, scale.ScalarBarLength = [0.25, 0.05], 0.5
    scale.AutomaticLabelFormat, scale.LabelFormat, scale.RangeLabelFormat = 0, "%g", "%g"
    scale.UseCustomLabels = 1
    scale.CustomLabels = [limit * k / 4 for k in range(5)]
    scale.AddRangeLabels, scale.DrawTickMarks = 0, 1
    shown.SetScalarBarVisibility(view, True)
    return shown


def label(view, text, position):
    """Words at a place in space, µm."""
    shown = Show(Text(Text=text), view, "TextSourceRepresentation")
    shown.TextPropMode = "Billboard 3D Text"
    shown.BillboardPosition = position
    shown.Color, shown.FontSize = BLACK, 20


def heading(view, text):
    shown = Show(Text(Text=text), view, "TextSourceRepresentation")
    shown.WindowLocation, shown.Position = "Any Location", [0.03, 0.92]
    shown.Color, shown.FontSize = BLACK, 22


def length_bar(view, start, length):
    """A bar along x with its length above it, from `start`, µm."""
    bar = Line(Point1=start, Point2=[start[0] + length, start[1], start[2]])
    show(bar, view, BLACK, LineWidth=5.0, Ambient=1.0, Diffuse=0.0)
    label(view, f"{length:g} µm", [start[0] + 0.32 * length, start[1], start[2] + 0.2])


def rods(cell, low, high, count=26):
    """The director on a regular grid in the plane y = 0 between two corners, as rods: head and tail of it are the same."""
    spacing = (high[0] - low[0]) / count
    rows = max(1, int((high[2] - low[2]) / spacing))
    plane = Plane(Origin=[low[0], 0.0, low[2] + 0.5 * spacing], Point1=[high[0], 0.0, low[2] + 0.5 * spacing],
                         Point2=[low[0], 0.0, low[2] + (rows + 0.5) * spacing], XResolution=count, YResolution=rows)
    sampled = ResampleWithDataset(SourceDataArrays=cell, DestinationMesh=plane)
    inside = where(sampled, "vtkValidPointMask", 1)
    glyph = Glyph(Input=inside, GlyphType="Cylinder", OrientationArray=["POINTS", "director"], ScaleArray=["POINTS", "No scale array"],
                  ScaleFactor=0.75 * spacing, GlyphMode="All Points")
    glyph.GlyphType.Radius = 0.07
    glyph.GlyphTransform.Rotate = [0.0, 0.0, 90.0]  # ParaView's cylinder lies along y
    return glyph


def new_view():
    view = CreateView("RenderView")
    view.UseColorPaletteForBackground = 0
    view.Background = WHITE
    view.OrientationAxesVisibility = 0
    view.CenterAxesVisibility = 0
    view.CameraParallelProjection = 1
    return view


def look(view, at, direction, up, half_height):
    """From `direction` (where the viewer stands) at a point, without perspective; lengths in µm."""
    view.CameraFocalPoint = at
    view.CameraPosition = [a + 60.0 * d for a, d in zip(at, direction)]
    view.CameraViewUp, view.CameraParallelScale = up, half_height


def bounds_of(source, time):
    source.UpdatePipeline(time)
    return source.GetDataInformation().GetBounds()


def draw(folder, time, output, state):
    path = os.path.abspath(os.path.join(folder, "fields.pvd"))
    check_files(path)
    for file in filter(None, (output, state)):
        if not os.access(os.path.dirname(os.path.abspath(file)), os.W_OK):
            raise ValueError(f"Cannot write {file}: its folder is not there, or nothing may be written in it.")
    check_display()
    series = PVDReader(FileName=path)
    times = list(series.TimestepValues)
    now = times[-1] if time is None else min(times, key=lambda t: abs(t - time))
    epsilon = 1e9 * bond_range(folder)

    cell, substrate = body(series, "cell"), body(series, "substrate")
    bounds = bounds_of(cell, now)
    if cell.GetDataInformation().GetNumberOfCells() == 0:
        raise ValueError(f"{path} has no hexahedra: a meridian section is drawn by the plot.py of spreading_axisymmetric.")
    radius, top = max(bounds[1], -bounds[0], bounds[3], -bounds[2]), bounds[5]
    scene = GetAnimationScene()
    scene.UpdateAnimationUsingDataTimeSteps()
    scene.AnimationTime = now

    # Left: cut open. The bar of the stress ends where 2 % of the particles are above it.
    left = new_view()
    stress = behind(in_unit(cell, "effective_stress", 1e-3, "effective stress (kPa)"))
    show_scalar(stress, left, "effective stress (kPa)", "effective stress (kPa)", stress_limit(cell, now), "Viridis (matplotlib)",
                Ambient=0.7, Diffuse=0.35, Specular=0.0)
    show(clip(behind(substrate), [0.0, 0.0, -2.0], [0.0, 0.0, 1.0]), left, GREY)
    outline = cut(ExtractSurface(Input=where(cell, "region", NUCLEUS)))
    show(outline, left, BLACK, LineWidth=3.0, Ambient=1.0, Diffuse=0.0, RenderLinesAsTubes=1)
    if cell.PointData.GetArray("director") is not None:
        first = bounds_of(cell, times[0])  # the round cell is higher, the spread one wider
        low, high = ([f(a, b) for a, b in zip(first[side::2], bounds[side::2])] for side, f in ((0, min), (1, max)))
        show(rods(cell, low, high), left, WHITE, Ambient=1.0, Diffuse=0.0)
    heading(left, "Cut at y = 0: stress, nucleus (outlined), director (rods)")
    length_bar(left, [-2.5, -0.3, -1.5], 5.0)

    # Right: what the substrate sees of the cell.
    right = new_view()
    under = in_unit(ExtractSurface(Input=cell), "gap", 1e9, "gap (nm)")
    show_scalar(under, right, "gap (nm)", "gap to the substrate (nm)", epsilon, "Inferno (matplotlib)", above=GREY,
                Interpolation="Gouraud", Ambient=0.7, Diffuse=0.35, Specular=0.0)
    heading(right, f"From below: contact (gap below {epsilon:g} nm)")
    length_bar(right, [-2.5, 1.2 * radius, bounds[4]], 5.0)

    layout = GetLayoutByName("Layout #1") or CreateLayout("Tactoid")
    layout.AssignView(0, left)
    layout.AssignView(layout.SplitHorizontal(0, 0.6) + 1, right)
    layout.SetSize(*SIZE)
    clock = Show(AnnotateTimeFilter(Input=series, Format="t = {time:.3g} µs", Scale=UM), left, "TextSourceRepresentation")
    clock.WindowLocation, clock.Position, clock.Color, clock.FontSize = "Any Location", [0.03, 0.83], BLACK, 22
    for view in (left, right):
        view.ViewTime = now
        Render(view)  # the first one sets the camera
    half_height = 0.9 * max(radius, top)
    look(left, [0.0, 0.0, 0.6 * half_height - 2.0], [-0.13, -0.95, 0.29], [0.0, 0.0, 1.0], half_height)
    look(right, [0.0, 0.2 * radius, 0.0], [0.0, 0.0, -1.0], [0.0, -1.0, 0.0], 1.68 * radius)
    SaveScreenshot(output, layout, ImageResolution=SIZE, SeparatorWidth=0)
    if state is not None:
        SaveState(state)
    return now, len(times)


def stress_limit(cell, time):
    """kPa, rounded up to a half."""
    cell.UpdatePipeline(time)
    values = servermanager.Fetch(cell).GetPointData().GetArray("effective_stress")
    stresses = sorted(values.GetValue(i) for i in range(values.GetNumberOfValues()))
    return max(0.5, int(2e-3 * stresses[int(0.98 * (len(stresses) - 1))] + 1.0) / 2)


def main():
    parser = argparse.ArgumentParser(prog="paraview_view.py", description="Draws a spreading run in ParaView.")
    parser.add_argument("folder", help="results of spreading_uniform, spreading_graded or wavy_front")
    parser.add_argument("--time", type=parse_time, help="the frame nearest to this time; default: the last")
    parser.add_argument("--output", metavar="FILE.png", help="default: paraview.png in the folder")
    parser.add_argument("--state", metavar="FILE.pvsm", help="writes a state file of ParaView, too")
    options = parser.parse_args()
    output = options.output or os.path.join(options.folder, "paraview.png")
    time, count = draw(options.folder, options.time, output, options.state)
    print(f"{output}: t = {time * UM:.4g} µs, of {count} time steps")


if __name__ == "__main__":
    plot_program.run(main)
