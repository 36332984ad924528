#!/usr/bin/env python3
"""Reads VTK XML files with the real VTK and prints what is in them.

    pip install vtk
    python tests/read_vtk.py FILE.vtu FILE.vtp FILE.pvd ...

Every message of the reader counts as a failure; the exit status is 1 when any file fails.
"""
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLUnstructuredGridReader
import numpy

READERS = {".vtu": vtkXMLUnstructuredGridReader, ".vtp": vtkXMLPolyDataReader}


def describe(label, array):
    values = vtk_to_numpy(array)
    bad = int(numpy.count_nonzero(~numpy.isfinite(values)))
    line = f"  {label} {array.GetName()}: {array.GetNumberOfTuples()} x {array.GetNumberOfComponents()}"
    if bad < values.size:
        line += f", {numpy.nanmin(values):.9g} .. {numpy.nanmax(values):.9g}"
    print(line + (f", {bad} not finite" if bad else ""))


def read_data(path):
    messages = []
    reader = READERS[path.suffix]()
    reader.AddObserver("ErrorEvent", lambda *_: messages.append("error"))
    reader.AddObserver("WarningEvent", lambda *_: messages.append("warning"))
    reader.SetFileName(str(path))
    reader.Update()
    data = reader.GetOutput()
    print(f"{path.name}: {data.GetNumberOfPoints()} points, {data.GetNumberOfCells()} cells")
    if data.GetNumberOfPoints():
        print("  bounds " + " ".join(f"{x:.6g}" for x in data.GetBounds()))
    for label, arrays in (("point", data.GetPointData()), ("cell", data.GetCellData())):
        for k in range(arrays.GetNumberOfArrays()):
            describe(label, arrays.GetArray(k))
    return not messages and bool(reader.CanReadFile(str(path)))


def read_collection(path):
    entries = ElementTree.parse(path).getroot().findall("./Collection/DataSet")
    print(f"{path.name}: {len(entries)} times")
    missing = [e.get("file") for e in entries if not (path.parent / e.get("file")).is_file()]
    for name in missing:
        print(f"  missing {name}")
    return not missing


def main(names):
    if not names:
        print(__doc__)
        return 2
    failures = 0
    for path in map(Path, names):
        good = path.is_file() and (read_collection if path.suffix == ".pvd" else read_data)(path)
        if not good:
            print(f"FAILED {path.name}")
            failures += 1
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
