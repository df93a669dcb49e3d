"""Reads what Tactoid writes (.vtu, .pvd, history.csv) with numpy alone."""

import csv
import os
import re
import xml.etree.ElementTree as ElementTree

import numpy as np

VERTEX, LINE, QUAD, HEXAHEDRON = 1, 3, 9, 12
NUMBERS = {"Float64": "f8", "Float32": "f4", "Int64": "i8", "Int32": "i4", "UInt32": "u4", "UInt8": "u1"}
# Faces of a hexahedron in VTK's order of vertices, oriented outwards.
HEXAHEDRON_FACES = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]


class Grid:
    """points (n, 3), time, point_data and cell_data by name; cells(type) gives the vertices of one kind of cells."""

    def __init__(self, path):
        with open(path, "rb") as file:
            content = file.read()
        mark = b'<AppendedData encoding="raw">'
        at = content.find(mark)
        if at < 0:
            raise ValueError(f"{path} has no appended raw data; it is no grid of Tactoid, or it is cut off.")
        start = content.index(b"_", at + len(mark)) + 1
        head = ElementTree.fromstring(content[:at].decode() + "</VTKFile>")
        order = "<" if head.get("byte_order") == "LittleEndian" else ">"
        if head.get("header_type") != "UInt64":
            raise ValueError(f"{path}: blocks with a {head.get('header_type')} header are not read here.")

        def array(element):
            offset = start + int(element.get("offset"))
            size = int(np.frombuffer(content, order + "u8", 1, offset)[0])
            kind = np.dtype(order + NUMBERS[element.get("type")])
            values = np.frombuffer(content, kind, size // kind.itemsize, offset + 8)
            components = int(element.get("NumberOfComponents", "1"))
            return values.reshape(-1, components) if components > 1 else values

        grid = head.find("UnstructuredGrid")
        piece = grid.find("Piece")
        self.time = float(grid.find("FieldData/DataArray[@Name='TimeValue']").text)
        self.points = array(piece.find("Points/DataArray"))
        cells = {element.get("Name"): array(element) for element in piece.findall("Cells/DataArray")}
        self.connectivity, self.offsets, self.types = cells["connectivity"], cells["offsets"], cells["types"]
        self.point_data = {e.get("Name"): array(e) for e in piece.findall("PointData/DataArray")}
        self.cell_data = {e.get("Name"): array(e) for e in piece.findall("CellData/DataArray")}
        if len(self.points) != int(piece.get("NumberOfPoints")) or len(self.types) != int(piece.get("NumberOfCells")):
            raise ValueError(f"{path}: the data is not of the size that its head announces.")

    def cells(self, kind):
        corners = {VERTEX: 1, LINE: 2, QUAD: 4, HEXAHEDRON: 8}[kind]
        ends = self.offsets[self.types == kind]
        return self.connectivity[ends[:, None] - corners + np.arange(corners)]

    def surface(self):
        """Facets that belong to one hexahedron alone: vertices (m, 4), oriented outwards."""
        faces = self.cells(HEXAHEDRON)[:, HEXAHEDRON_FACES].reshape(-1, 4)
        _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
        return faces[np.sort(first[count == 1])]


def read_series(path):
    """The frames of a .pvd file, in the order of time: a list of (time, {name of the part: file})."""
    folder = os.path.dirname(path)
    frames = {}
    for entry in ElementTree.parse(path).getroot().find("Collection"):
        name = entry.get("name") or re.sub(r"_?\d*\.vtu$", "", os.path.basename(entry.get("file")))
        frames.setdefault(float(entry.get("timestep")), {})[name] = os.path.join(folder, entry.get("file"))
    return sorted(frames.items())


def read_history(path):
    """The columns of a history by name."""
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    values = np.array([[float(value) for value in row] for row in rows[1:] if len(row) == len(rows[0])])
    return dict(zip(rows[0], values.reshape(-1, len(rows[0])).T))
