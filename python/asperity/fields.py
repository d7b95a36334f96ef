"""The fields of one step, and the mesh that they are on."""

from __future__ import annotations

import base64
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from ._arguments import as_array, items
from ._errors import AsperityError, CaseError
from ._optional import need

__all__ = ["Fields", "Mesh"]

_VTK_HEXAHEDRON = 12
_TYPES = {"Float64": "<f8", "Int64": "<i8", "Int32": "<i4", "UInt8": "u1"}


def _rows(name: str, value: Any, width: tuple[int, ...] | None, kinds: str, count: int | None = None) -> np.ndarray:
    """An array of numbers, a row for each of something."""
    array = np.asarray(as_array(name, value))
    fits = array.ndim > 0 and array.dtype.kind in kinds and (width is None or array.shape[1:] == width) and count in (None, len(array))
    if not fits:
        shape = "" if width is None else f" of {width[0]} in a row"
        rows = "" if count is None else f", {count} rows"
        raise CaseError(f"{name}: is {array.dtype.name} of the shape {array.shape}. Allowed: numbers{shape}{rows}")
    return array


def _data(name: str, data: Any, count: int) -> dict[str, np.ndarray]:
    return {key: _rows(f"{name}.{key}", values, None, "fiu", count) for key, values in items(name, data, "a dictionary of arrays")}


class Mesh:
    """The meshed half of the sphere, y >= 0, before deformation.

    ``points`` are positions (n, 3), lengths; ``cells`` the eight nodes of each hexahedron (m, 8), in the order of VTK and meshio.
    """

    def __init__(self, points: np.ndarray, cells: np.ndarray) -> None:
        self.points = _rows("points", points, (3,), "f")
        self.cells = _rows("cells", cells, (8,), "iu")

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {len(self.points)} points, {len(self.cells)} hexahedra>"

    def to_pyvista(self) -> Any:
        """A ``pyvista.UnstructuredGrid``."""
        pyvista = need("pyvista", "pyvista", "to_pyvista()")
        return pyvista.UnstructuredGrid({_VTK_HEXAHEDRON: self.cells}, self.points)

    def to_meshio(self) -> Any:
        """A ``meshio.Mesh``."""
        return need("meshio", "meshio", "to_meshio()").Mesh(self.points, [("hexahedron", self.cells)])


class Fields(Mesh):
    """What a step shows: ``point_data`` and ``cell_data`` by their names.

    On the points: ``displacement`` (n, 3), a length; ``contact_pressure`` and ``contact_traction``, stresses, forces over the area before deformation;
    ``gap``, a length (-1 away from the contact surface); ``contact_status``, 0 open, 1 stick, 2 slip. On the cells: ``stress`` (m, 6), Cauchy's, xx yy zz xy yz xz;
    ``mises``, a stress; ``alpha``, the equivalent plastic strain; ``plastic``, 1 where the element has yielded.
    """

    def __init__(self, points: np.ndarray, cells: np.ndarray, point_data: dict[str, np.ndarray], cell_data: dict[str, np.ndarray]) -> None:
        super().__init__(points, cells)
        self.point_data = _data("point_data", point_data, len(self.points))
        self.cell_data = _data("cell_data", cell_data, len(self.cells))

    def __getitem__(self, name: str) -> np.ndarray:
        for data in (self.point_data, self.cell_data):
            if name in data:
                return data[name]
        raise KeyError(f"{name}: no such field. there are {', '.join([*self.point_data, *self.cell_data])}")

    def to_pyvista(self) -> Any:
        """A ``pyvista.UnstructuredGrid`` with all fields; ``grid.warp_by_vector("displacement")`` deforms it."""
        grid = super().to_pyvista()
        grid.point_data.update(self.point_data)
        grid.cell_data.update(self.cell_data)
        return grid

    def to_meshio(self) -> Any:
        """A ``meshio.Mesh`` with all fields."""
        mesh = super().to_meshio()
        mesh.point_data = dict(self.point_data)
        mesh.cell_data = {name: [values] for name, values in self.cell_data.items()}
        return mesh


def read_vtu(path: Path) -> Fields:
    """Reads a ``.vtu`` file of a run: inline base64, uncompressed, little-endian, with 64-bit lengths."""
    try:
        return _read(path)
    except (ElementTree.ParseError, ValueError, KeyError, RecursionError) as error:
        raise AsperityError(f"{path}: is not a file of fields of an Asperity run ({error}). Run the case again") from None


def _read(path: Path) -> Fields:
    piece = ElementTree.parse(path).getroot().find("UnstructuredGrid/Piece")
    if piece is None:
        raise ValueError("it has no grid")

    def arrays(part: str) -> dict[str, np.ndarray]:
        read: dict[str, np.ndarray] = {}
        for element in piece.find(part) or ():
            values = np.frombuffer(base64.b64decode(element.text or ""), dtype=_TYPES[element.attrib["type"]], offset=0)
            header = 8 // values.itemsize
            components = int(element.attrib["NumberOfComponents"])
            values = values[header:]
            read[element.attrib["Name"]] = values.reshape(-1, components) if components > 1 else values
        return read

    cells = arrays("Cells")["connectivity"].reshape(-1, 8)
    return Fields(arrays("Points")["Points"], cells, arrays("PointData"), arrays("CellData"))
