"""What VTK's own readers find in image data (.vti), structured grids (.vts), lines (.vtp) and collections (.pvd).

    python3 files/checks/vti.py FILE...

prints the grid, the time and the arrays with their ranges, and ends with a failure where the
reader reports an error or a warning. With --samples the values are compared cell by cell, and the
middles of the cells one by one, with what the example `vti_samples` writes:

    cargo run -p wellposed-files --example vti_samples -- FOLDER
    python3 files/checks/vti.py --samples FOLDER/samples.pvd

Needs VTK and NumPy (`pip install vtk numpy`).
"""

import argparse
import pathlib
import sys
import xml.etree.ElementTree as tree

import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

ORIGIN = [-1.5, 0.25, 1e-7]
SPACING = [0.1, 1.0 / 3.0, 2.5e-8]
ODD = [np.nan, np.inf, -0.0, 5e-324, np.finfo(float).max, 1.0 / 3.0]
DEFORMATION = np.array([[1.0, 0.5], [-0.25, 1.25]])
KINDS = {3: "lines", 8: "flat cells", 9: "skew cells", 11: "solid cells"}

READERS = {
    ".vti": (vtk.vtkXMLImageDataReader, vtk.vtkImageData),
    ".vts": (vtk.vtkXMLStructuredGridReader, vtk.vtkStructuredGrid),
    ".vtp": (vtk.vtkXMLPolyDataReader, vtk.vtkPolyData),
}


def read(path):
    """The data in a file and the errors and warnings that reading it caused."""
    new_reader, new_data = READERS[path.suffix]
    reader = new_reader()
    messages = []
    readable = reader.CanReadFile(str(path))
    if not readable:
        messages.append("the reader does not take the file")
    for event in ("ErrorEvent", "WarningEvent"):
        reader.AddObserver(event, lambda source, name: messages.append(name))
    reader.SetFileName(str(path))
    reader.Update()
    if reader.GetErrorCode() != 0:
        messages.append(vtk.vtkErrorCode.GetStringFromErrorCode(reader.GetErrorCode()))
    data = new_data()
    data.DeepCopy(reader.GetOutput())
    return data, reader.GetErrorCode(), messages


def arrays(data):
    """The arrays of the cells by name, as NumPy arrays with the cells first."""
    cells = data.GetCellData()
    found = (cells.GetArray(index) for index in range(cells.GetNumberOfArrays()))
    return {array.GetName(): vtk_to_numpy(array) for array in found}


def time(data):
    """The time of the data, None where it has none."""
    value = data.GetFieldData().GetArray("TimeValue")
    return None if value is None else value.GetValue(0)


def dimensions(data):
    """Nodes along each of three axes."""
    first_and_last = data.GetExtent()
    return tuple(first_and_last[2 * axis + 1] - first_and_last[2 * axis] + 1 for axis in range(3))


def show(path, data, code):
    """Prints what a file holds."""
    kind = KINDS.get(data.GetCellType(0), f"cells of type {data.GetCellType(0)}")
    print(f"{path}: error code {code}, time {time(data)}")
    if isinstance(data, vtk.vtkPolyData):
        print(f"  {data.GetNumberOfPoints()} points, {data.GetNumberOfCells()} {kind}")
    else:
        print(f"  nodes {dimensions(data)}, {data.GetNumberOfCells()} {kind}, "
              f"{data.GetDataDimension()} dimensions")
    if isinstance(data, vtk.vtkImageData):
        print(f"  origin {data.GetOrigin()}, spacing {data.GetSpacing()}")
    else:
        print(f"  bounds {data.GetBounds()}")
    for name, values in arrays(data).items():
        components = 1 if values.ndim == 1 else values.shape[1]
        finite = values[np.isfinite(values)]
        ends = f"{finite.min()} to {finite.max()}" if finite.size else "nothing finite"
        print(f"  {name}: {values.dtype}, {components} of {len(values)}, {ends}")


def middles(data):
    """The middle of each cell as VTK finds it."""
    centres = vtk.vtkCellCenters()
    centres.SetInputData(data)
    centres.Update()
    return vtk_to_numpy(centres.GetOutput().GetPoints().GetData())


def same(found, expected):
    """Whether two arrays agree in kind, shape and every bit; any not-a-number is as good."""
    return (found.dtype == expected.dtype and found.shape == expected.shape
            and np.array_equal(found, expected, equal_nan=found.dtype.kind == "f")
            and np.array_equal(np.signbit(found), np.signbit(expected)))


def differences(path, data):
    """What differs from the values that the example writes into a file of this name."""
    lengths, _, bits = path.stem.split("_")
    cells = [int(length) for length in lengths.split("x")]
    axes = len(cells)
    cells += [1] * (3 - axes)
    k, j, i = (index.ravel() for index in np.indices(cells[::-1]))
    real = np.dtype(f"float{bits}")
    tell = i - 100.0 * j + 10_000.0 * k
    six = (tell[:, None] + 0.125 * np.arange(6)).astype(real)
    vector = np.column_stack([six[:, 0], six[:, 1], np.zeros(len(tell), real)])
    expected = {"scalar [Pa]": six[:, 0], "vector <σ & \"ε\"> [m/s]": vector, "six [1]": six}
    if bits == "64":
        expected["odd"] = np.resize(ODD, len(tell))
        expected["number"] = np.arange(len(tell), dtype=np.int32)
    found = arrays(data)
    if list(found) != list(expected):
        yield f"arrays {list(found)}"
        return
    for name, values in expected.items():
        if not same(found[name], values):
            yield name
    nodes = tuple(length + 1 for length in cells[:axes]) + (1,) * (3 - axes)
    if dimensions(data) != nodes or data.GetDataDimension() != axes:
        yield "nodes"
    origin = ORIGIN[:axes] + [0.0] * (3 - axes)
    spacing = SPACING[:axes] + [1.0] * (3 - axes)
    is_image = isinstance(data, vtk.vtkImageData)
    if is_image and data.GetOrigin() != tuple(ORIGIN[:axes] + [0.0] * (3 - axes)):
        yield "origin"
    if is_image and data.GetSpacing() != tuple(SPACING[:axes] + [1.0] * (3 - axes)):
        yield "spacing"
    kinds = {2: vtk.VTK_PIXEL, 3: vtk.VTK_VOXEL} if is_image else {2: vtk.VTK_QUAD}
    if data.GetCellType(0) != kinds[axes]:
        yield "kind of cells"
    if time(data) != 0.1:
        yield "time"
    flat = (axes == 3) * 0.5
    expected = np.column_stack([
        origin[axis] + spacing[axis] * (index + (0.5, 0.5, flat)[axis])
        for axis, index in enumerate((i, j, k))])
    if not is_image:
        expected[:, :2] = expected[:, :2] @ DEFORMATION.T
    if not np.allclose(middles(data), expected, rtol=1e-6, atol=0.0 if is_image else 1e-6):
        yield "middles of the cells"


def files(path):
    """The files that a path stands for: itself, or what a collection names."""
    if path.suffix != ".pvd":
        return [path]
    entries = tree.parse(path).getroot().iter("DataSet")
    return [path.parent / entry.attrib["file"] for entry in entries]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("paths", nargs="+", type=pathlib.Path, metavar="FILE")
    parser.add_argument("--samples", action="store_true", help="compare with the example's values")
    options = parser.parse_args()
    wrong = 0
    for path in [file for path in options.paths for file in files(path)]:
        data, code, messages = read(path)
        show(path, data, code)
        if options.samples and not messages:
            messages += [f"differs: {what}" for what in differences(path, data)]
            if not messages:
                print("  every cell as written")
        for message in messages:
            print(f"  {message}")
        wrong += bool(messages)
    sys.exit(f"{wrong} files with something wrong" if wrong else 0)


if __name__ == "__main__":
    main()
