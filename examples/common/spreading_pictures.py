"""Pictures of a cell on its substrate: in space, as a cut, and of a meridian section."""

import numpy as np
import matplotlib
import matplotlib.pyplot as plt
from matplotlib.collections import PolyCollection
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from vtu_reader import HEXAHEDRON, QUAD, Grid

UM, KPA = 1e6, 1e-3  # from SI to the units of the figures
COLORS = plt.get_cmap("viridis")
GREY = np.array([0.86, 0.86, 0.88, 1.0])
VIEW = {"elev": 24.0, "azim": -62.0}
TETRAHEDRA = [[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]]


def normals(corners):
    n = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    return n / np.maximum(np.linalg.norm(n, axis=1, keepdims=True), 1e-300)


def view_direction():
    elevation, azimuth = np.radians(VIEW["elev"]), np.radians(VIEW["azim"])
    return np.array([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)])


def lit(colors, n):
    """Colours of facets under a lamp from the upper left, behind the viewer."""
    lamp = view_direction() + np.array([-0.6, 0.1, 0.9])
    brightness = 0.55 + 0.45 * np.clip(n @ (lamp / np.linalg.norm(lamp)), 0.0, 1.0)
    return np.column_stack([colors[:, :3] * brightness[:, None], colors[:, 3]])


def stress(grid):
    return np.nan_to_num(grid.point_data["effective_stress"]) * KPA


def draw_scene(axes, cell, substrate, norm, zoom=1.38, ground=np.inf, arrows=260, bar=True):
    """The cell coloured by stress, with about `arrows` arrows of the director on its surface, on the part of the
    substrate within `ground` (µm)."""
    x = cell.points * UM
    facets = cell.surface()
    center, extent = x.mean(axis=0), np.ptp(x, axis=0).max()
    n = normals(x[facets])
    polygons = [x[facets]]
    colors = [lit(COLORS(norm(stress(cell)[facets].mean(axis=1))), n)]
    edges = [np.tile([0.0, 0.0, 0.0, 0.12], (len(facets), 1))]
    if substrate is not None:
        y = substrate.points * UM
        below = substrate.surface()
        up = normals(y[below])
        top = (up[:, 2] > 0.3) & (np.hypot(y[below][:, :, 0], y[below][:, :, 1]).max(axis=1) < ground)
        polygons.append(y[below[top]])
        colors.append(lit(np.tile(GREY, (top.sum(), 1)), up[top]))
        edges.append(np.tile([0.0, 0.0, 0.0, 0.06], (top.sum(), 1)))
    # One collection, so that the facets of both bodies are sorted by depth together.
    axes.add_collection3d(
        Poly3DCollection(np.concatenate(polygons), facecolors=np.concatenate(colors),
                         edgecolors=np.concatenate(edges), linewidths=0.3, zsort="average"))
    if arrows > 0 and "director" in cell.point_data:
        seen = n @ view_direction() > 0.15
        middle = x[facets].mean(axis=1)[seen] + 0.05 * n[seen]
        h = cell.point_data["director"][facets].mean(axis=1)[seen]
        step = max(1, len(middle) // arrows)
        middle, h = middle[::step], h[::step]
        length = 0.055 * extent
        axes.quiver(*(middle - 0.5 * length * h).T, *(length * h).T, color="black", linewidth=0.8, arrow_length_ratio=0.35,
                    zorder=10)
    everything = np.concatenate([p.reshape(-1, 3) for p in polygons])
    low, high = everything.min(axis=0), everything.max(axis=0)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    axes.set_box_aspect(high - low, zoom=zoom)
    axes.set_axis_off()
    if not bar:
        return
    # A scale bar on the ground, in front.
    bar = 5.0
    front = [center[0] - bar / 2, low[1], low[2] if substrate is None else everything[:, 2].min()]
    axes.plot([front[0], front[0] + bar], [front[1]] * 2, [front[2]] * 2, color="black", linewidth=3, zorder=11)
    axes.text(front[0] + bar / 2, front[1], front[2] - 0.09 * extent, f"{bar:g} µm", ha="center", va="top", zorder=11)


def cut(grid, values, plane_y):
    """The cut of the hexahedra with the plane y = plane_y: polygons (x, z) and the mean value on each."""
    hexahedra = grid.cells(HEXAHEDRON)
    y = grid.points[:, 1] - plane_y
    crossing = (y[hexahedra].min(axis=1) <= 0.0) & (y[hexahedra].max(axis=1) > 0.0)
    polygons, means = [], []
    for tetrahedron in hexahedra[crossing][:, TETRAHEDRA].reshape(-1, 4):
        inside, outside = tetrahedron[y[tetrahedron] <= 0.0], tetrahedron[y[tetrahedron] > 0.0]
        if len(inside) == 0 or len(outside) == 0:
            continue
        if len(inside) == 2:
            pairs = [(inside[0], outside[0]), (inside[0], outside[1]), (inside[1], outside[1]), (inside[1], outside[0])]
        else:
            pairs = [(a, b) for a in inside for b in outside]
        weights = [y[a] / (y[a] - y[b]) for a, b in pairs]
        polygons.append([((1 - w) * grid.points[a] + w * grid.points[b])[[0, 2]] for (a, b), w in zip(pairs, weights)])
        means.append(np.mean([(1 - w) * values[a] + w * values[b] for (a, b), w in zip(pairs, weights)]))
    return polygons, np.array(means)


def spread_out(x, chosen, distance):
    """Indices of chosen points that keep a distance in the (x, z) plane from each other, so that arrows do not overlap."""
    kept = []
    for i in np.flatnonzero(chosen):
        if all((x[i, 0] - x[j, 0]) ** 2 + (x[i, 2] - x[j, 2]) ** 2 >= distance**2 for j in kept):
            kept.append(i)
    return np.array(kept, dtype=int)


def draw_cut(axes, cell, substrate, norm):
    """Both bodies in the plane through the middle of the cell, with the director."""
    x = cell.points * UM
    center = x.mean(axis=0)
    plane = cell.points[:, 1].mean()
    if substrate is not None:
        polygons, _ = cut(substrate, stress(substrate), plane)
        axes.add_collection(PolyCollection([np.array(p) * UM for p in polygons], facecolors=[GREY], edgecolors=[GREY],
                                           linewidths=0.4))
    polygons, values = cut(cell, stress(cell), plane)
    colors = COLORS(norm(values))
    axes.add_collection(PolyCollection([np.array(p) * UM for p in polygons], facecolors=colors, edgecolors=colors,
                                       linewidths=0.4))
    reference_y = cell.points[:, 1] - cell.point_data["displacement"][:, 1]
    spacing = (np.prod(np.ptp(cell.points, axis=0)) / len(cell.points)) ** (1 / 3)
    near = np.abs(reference_y - reference_y.mean()) < 0.3 * spacing
    if "director" in cell.point_data:
        near = spread_out(x, near, 0.85 * spacing * UM)
        h = cell.point_data["director"][near]
        axes.quiver(x[near, 0], x[near, 2], h[:, 0], h[:, 2], pivot="mid", color="white", scale_units="xy", angles="xy",
                    scale=1.3 / (spacing * UM), width=0.0022, headwidth=3.5)
    low, high = x.min(axis=0), x.max(axis=0)
    half = 0.62 * np.ptp(x, axis=0)[:2].max()
    axes.set(xlim=(center[0] - half, center[0] + half), ylim=(low[2] - 2.2, high[2] + 0.6), xlabel="x (µm)", ylabel="z (µm)")
    axes.set_aspect("equal", adjustable="box")
    axes.set_title(f"cut at y = {plane * UM + 0.0:.1f} µm".replace("-0.0", "0.0"), loc="left", fontsize=10)


def scale(*cells, on_surface=False):
    """Colours for the effective stress of all these, kPa: up to what 2 % of the particles exceed."""
    shown = np.concatenate([stress(cell)[np.unique(cell.surface())] if on_surface else stress(cell) for cell in cells])
    return matplotlib.colors.Normalize(0.0, max(float(np.percentile(shown, 98.0)), 1e-9), clip=True)


def colorbar(figure, norm, axes, **options):
    figure.colorbar(matplotlib.cm.ScalarMappable(norm, COLORS), ax=axes, extend="max", **options)


def view(axes):
    """Axes of a projection="3d" as draw_scene wants them."""
    axes.view_init(**VIEW)
    axes.computed_zorder = False


def draw_meridian(axes, cell, substrate, norm):
    """Both halves of a meridian section, the axis in the middle, with the director on the right."""
    low, high = np.inf, -np.inf
    for grid, is_cell in ((substrate, False), (cell, True)):
        x = grid.points[:, :2] * UM
        corners = grid.cells(QUAD)
        colors = COLORS(norm(stress(grid)[corners].mean(axis=1))) if is_cell else np.tile(GREY, (len(corners), 1))
        edges = colors if is_cell else np.tile([0.75, 0.75, 0.78, 1.0], (len(corners), 1))
        for side in (1.0, -1.0):
            axes.add_collection(PolyCollection(x[corners] * [side, 1.0], facecolors=colors, edgecolors=edges, linewidths=0.3))
        if is_cell:
            low, high = x[:, 1].min(), x[:, 1].max()
    if "director" in cell.point_data:
        x = cell.points * UM
        spacing = np.sqrt(np.ptp(x[:, 0]) * np.ptp(x[:, 1]) / 60.0)
        kept = spread_out(x[:, [0, 2, 1]], np.full(len(x), True), spacing)
        h = cell.point_data["director"][kept]
        axes.quiver(x[kept, 0], x[kept, 1], h[:, 0], h[:, 1], pivot="mid", color="white", scale_units="xy", angles="xy",
                    scale=1.5 / spacing, width=0.004, headwidth=3.5)
    axes.set(xlim=(-8.6, 8.6), ylim=(low - 1.6, high + 0.4))
    axes.set_aspect("equal", adjustable="box")


def seen_from_above(cell):
    """Facets that face up, the lowest first: corners (n, 4, 2), µm, and effective stress (n), kPa."""
    facets = cell.surface()
    corners = cell.points[facets] * UM
    up = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])[:, 2] > 0.0
    order = np.argsort(corners[up][:, :, 2].mean(axis=1))
    return corners[up][order][:, :, :2], stress(cell)[facets].mean(axis=1)[up][order]


def views_from_above(frames):
    """The cell of each frame as (time, corners, stress), and what half of a picture needs to hold them all, µm."""
    views = [(time, *seen_from_above(Grid(parts["cell"]))) for time, parts in frames]
    return views, 1.15 * max(np.abs(corners).max() for _, corners, _ in views)


def draw_from_above(axes, corners, stresses, norm, soft, stiff, half):
    """Such facets on the substrate whose factor grows with the angle, from `soft` at +x to `stiff` at −x; within ±half, µm."""
    x, y = np.meshgrid(np.linspace(-half, half, 201), np.linspace(-half, half, 201))
    factor = soft + (stiff - soft) * np.abs(np.arctan2(y, x)) / np.pi
    axes.imshow(factor, extent=(-half, half, -half, half), origin="lower", cmap="Greys", vmin=0.0, vmax=1.6 * max(soft, stiff),
                interpolation="bilinear")
    axes.add_collection(PolyCollection(corners, facecolors=COLORS(norm(stresses)), edgecolors=(0, 0, 0, 0.15), linewidths=0.2))
    axes.set(xlabel="x (µm): stiff ← → soft" if stiff > soft else "x (µm): soft ← → stiff", aspect="equal")


def evenly(items, count):
    """So many of a list, the first and the last among them; all where there are fewer."""
    return [items[k] for k in np.unique(np.linspace(0, len(items) - 1, min(count, len(items))).round().astype(int))]


def draw_sections(figure, grid, frames, count=6):
    """Frames (time, {part: file}) of a run, evenly chosen, as meridian sections in the first two rows of a grid of three columns."""
    if not frames:
        return
    chosen = evenly(frames, count)
    cells = [Grid(parts["cell"]) for _, parts in chosen]
    norm = scale(*cells)
    axes = [figure.add_subplot(grid[k // 3, k % 3]) for k in range(len(chosen))]
    for axis, cell, (time, parts) in zip(axes, cells, chosen):
        draw_meridian(axis, cell, Grid(parts["substrate"]), norm)
        axis.set_title(f"{time * 1e6:.3g} µs", loc="left")
        axis.grid(False)
        axis.tick_params(labelsize=7)
    colorbar(figure, norm, axes, label="effective stress (kPa)", shrink=0.8)
