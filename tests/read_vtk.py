#!/usr/bin/env python3
"""Reads VTK XML files with the real VTK and prints what is in them.

    pip install vtk
    python tests/read_vtk.py FILE.vtu FILE.vtp FILE.pvd ...
    python tests/read_vtk.py --plane RUN
    python tests/read_vtk.py --space RUN
    python tests/read_vtk.py --half RUN
    python tests/read_vtk.py --solid RUN
    python tests/read_vtk.py --state RUN

Every message of the reader counts as a failure; the exit status is 1 when any file fails. With `--plane` the field of a plane
run is used as in ParaView: its triangles cover the domain without the bodies, a contour and a slice are cut, and the
pressure on the wall is integrated along its lines, which must give the forces of `loads.csv`. With `--space` the same is done with
the tetrahedra of a run in space and the triangles of its walls, and a streamline is followed past the body. With `--half` a half
model is cut along its plane of symmetry, y = 0. With `--solid` the cells of a structure alone fill its volume. With `--state` the
script that a run leaves for ParaView is run on a stand-in for ParaView: all that it shows is there.
"""
import csv
import runpy
import sys
import types
import xml.etree.ElementTree as ElementTree
from pathlib import Path

from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import VTK_TETRA, VTK_TRIANGLE, vtkPlane, vtkPolyData
from vtkmodules.vtkFiltersCore import vtkContourFilter, vtkCutter, vtkMassProperties, vtkProbeFilter, vtkTriangleFilter
from vtkmodules.vtkFiltersFlowPaths import vtkStreamTracer
from vtkmodules.vtkFiltersGeneral import vtkWarpVector
from vtkmodules.vtkFiltersModeling import vtkSelectEnclosedPoints
from vtkmodules.vtkFiltersSources import vtkPointSource
from vtkmodules.vtkFiltersVerdict import vtkCellSizeFilter
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


def told(data):
    """Field data by name: numbers and texts."""
    field = data.GetFieldData()
    arrays = (field.GetAbstractArray(k) for k in range(field.GetNumberOfArrays()))
    return {a.GetName(): [a.GetValue(i) for i in range(a.GetNumberOfValues())] for a in arrays}


def unit(array):
    return (array.GetInformation().Get(array.UNITS_LABEL()) or "").strip()


def tells(name, data, conditions):
    """Whether a file tells these conditions, a unit of every array twice over, and what is seen first."""
    own, points = told(data), data.GetPointData()
    units = dict(text.rstrip("]").split(" [", 1) for text in own.get("units", []))
    arrays = [points.GetArray(k) for k in range(points.GetNumberOfArrays())]
    without = [a.GetName() for a in arrays if not unit(a) or units.get(a.GetName()) != unit(a)]
    missing = [key for key in [*conditions, "title", "unit system"] if key not in own]
    first = points.GetScalars() and points.GetScalars().GetName()
    print(f"  {name} tells {own}; coloured by {first}")
    for what, names in (("has no unit of", without), ("does not tell", missing)):
        if names:
            print(f"  {name} {what} {', '.join(names)}")
    return bool(first) and not without and not missing


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


def array(data, name):
    return vtk_to_numpy(data.GetPointData().GetArray(name))


def opened(path):
    reader = READERS[path.suffix]()
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def length(lines):
    """Length of all segments of a contour or a slice."""
    points = vtk_to_numpy(lines.GetPoints().GetData())
    corners = vtk_to_numpy(lines.GetLines().GetConnectivityArray()).reshape(-1, 2)
    return float(numpy.linalg.norm(points[corners[:, 1]] - points[corners[:, 0]], axis=1).sum())


def polygon_area(points):
    x, y = points[:, 0], points[:, 1]
    return 0.5 * abs(float(numpy.sum(x * numpy.roll(y, -1) - y * numpy.roll(x, -1))))


def hull(points):
    """Corners of the convex hull, counterclockwise (Andrew's monotone chain)."""
    def half(ordered):
        chain = []
        for p in ordered:
            while len(chain) > 1 and turn(chain[-2], chain[-1], p) <= 0.0:
                chain.pop()
            chain.append(p)
        return chain[:-1]

    def turn(a, b, c):
        return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])

    ordered = sorted(map(tuple, points[:, :2]))
    return numpy.array(half(ordered) + half(ordered[::-1]))


def chains(wall):
    cells = wall.GetLines()
    offsets, corners = (vtk_to_numpy(a()) for a in (cells.GetOffsetsArray, cells.GetConnectivityArray))
    return [corners[a:b] for a, b in zip(offsets[:-1], offsets[1:])]


# Triangles cover the hull of the particles without the bodies; what is off is round-off.
AREA = 1e-9
# Wall forces in what the range of the pressure could exert on the whole wall. Trapezoids between the middles of panels were off
# by 7e-5 at a spacing of 1/16 and 4e-6 at 1/64; sums over the area vectors of panels are what the program does itself.
FORCE, PANELS = 2e-4, 1e-9


def off(run, wall, force):
    """By how much a force integrated over cells, and one over the panels of the wall, differ from the table of loads."""
    pressure, area = array(wall, "pressure"), array(wall, "area_vector")
    with open(run / "loads.csv") as table:
        rows = list(csv.DictReader(table))
    told = numpy.array([sum(float(row[key]) for row in rows) for key in ("fx", "fy", "fz")])
    scale = numpy.ptp(pressure) * numpy.linalg.norm(area, axis=1).sum()
    errors = [float(numpy.abs(f - told).max() / scale) for f in (force, -pressure @ area)]
    print(f"  force {force}, loads.csv {told}: off by {errors[0]:.2g}, panels {errors[1]:.2g}")
    return errors


# What every file of a gas tells of its case.
CONDITIONS = ["Mach number", "alpha [deg]", "TimeValue"]


def check_plane(run):
    field, wall = opened(run / "field.vtu"), opened(run / "surface.vtp")
    if not all([tells("field.vtu", field, CONDITIONS), tells("surface.vtp", wall, CONDITIONS)]):
        return False
    if field.GetCellType(0) != VTK_TRIANGLE:
        print(f"{run.name}: the cells of the field are no triangles")
        return False
    points, lines = vtk_to_numpy(field.GetPoints().GetData()), chains(wall)
    corners = vtk_to_numpy(field.GetCells().GetConnectivityArray()).reshape(-1, 3)
    a, b, c = (points[corners[:, k]] for k in range(3))
    areas = 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    at_wall = vtk_to_numpy(wall.GetPoints().GetData())
    closed = all(line[0] == line[-1] for line in lines)
    bodies = sum(polygon_area(at_wall[line]) for line in lines)
    domain = polygon_area(hull(points)) - bodies
    missing = abs(areas.sum() - domain) / domain
    print(f"{run.name}: {len(corners)} triangles, smallest {areas.min():.3g}; area off by {missing:.2g}")

    contour = vtkContourFilter()
    contour.SetInputData(field)
    contour.SetInputArrayToProcess(0, 0, 0, 0, "mach")
    contour.SetValue(0, float(numpy.median(array(wall, "mach"))))
    contour.Update()
    plane, cutter = vtkPlane(), vtkCutter()
    middle = at_wall.mean(axis=0)
    plane.SetOrigin(*middle)
    plane.SetNormal(1.0, 0.0, 0.0)
    cutter.SetInputData(field)
    cutter.SetCutFunction(plane)
    cutter.Update()
    through = sorted(y for line in lines for y in crossings(at_wall[line], middle[0]))
    expected = numpy.ptp(points[:, 1]) - sum(b - a for a, b in zip(through[::2], through[1::2]))
    cut = length(cutter.GetOutput())
    print(f"  contour of Mach {length(contour.GetOutput()):.4g} long, slice {cut:.9g} of {expected:.9g}")

    pressure, normal = array(wall, "pressure"), array(wall, "normal")
    force = numpy.zeros(3)
    for line in lines:
        ends = at_wall[line]
        across = numpy.diff(ends, axis=0)[:, [1, 0]] * [1.0, -1.0]
        outward = numpy.sign(numpy.sum(across * normal[line[:-1], :2]))
        mean = 0.5 * (pressure[line[:-1]] + pressure[line[1:]])
        force[:2] -= outward * (mean[:, None] * across).sum(axis=0)
    errors = off(run, wall, force)
    return (closed and areas.min() > 0.0 and missing < AREA and length(contour.GetOutput()) > 0.0
            and abs(cut - expected) < 1e-6 * expected and errors[0] < FORCE and errors[1] < PANELS)


# Area of a slice along a plane of symmetry: triangles end at the middles of the panels next to it.
SLICE = 0.02


def area(polygons):
    mass = vtkMassProperties()
    triangles = vtkTriangleFilter()
    triangles.SetInputData(polygons)
    mass.SetInputConnection(triangles.GetOutputPort())
    mass.Update()
    return mass.GetSurfaceArea()


def sliced(data, y):
    plane, cutter = vtkPlane(), vtkCutter()
    plane.SetOrigin(0.0, y, 0.0)
    plane.SetNormal(0.0, 1.0, 0.0)
    cutter.SetInputData(data)
    cutter.SetCutFunction(plane)
    cutter.Update()
    return cutter.GetOutput()


def check_half(run):
    """The plane of symmetry y = 0 of a half model: as large as the plane next to it, and nothing flows through it."""
    field, hull = opened(run / "field.vtu"), opened(run / "hull.vtp")
    slices = [sliced(field, y) for y in (0.0, 0.02 * field.GetBounds()[3])]
    areas = [area(cut) for cut in slices]
    rim = sliced(hull, 0.0).GetNumberOfCells()
    across = numpy.abs(array(slices[0], "velocity")[:, 1]).max() if areas[0] else numpy.inf
    speed = numpy.linalg.norm(array(field, "velocity"), axis=1).max()
    kinds = numpy.unique(array(field, "kind"))
    print(f"{run.name}: slice y = 0 of {areas[0]:.6g}, beside it {areas[1]:.6g}, {rim} pieces of the walls; speed across it {across:.2g}")
    return bool(areas[0] and abs(areas[0] / areas[1] - 1.0) < SLICE and rim and across < 1e-3 * speed and 3.0 in kinds)


def check_solid(run):
    """Cells of a structure: they fill what particles fill at rest, and are told and coloured."""
    good = True
    for path in sorted([*run.glob("solid*.vtu"), *run.glob("mode-*.vtu")]):
        data = opened(path)
        good = tells(path.name, data, []) and good
        quality = vtkCellSizeFilter()
        at_rest = vtkWarpVector()
        at_rest.SetInputData(data)
        at_rest.SetInputArrayToProcess(0, 0, 0, 0, "displacement")
        # modes are written where the structure is at rest
        at_rest.SetScaleFactor(-1.0 if path.name.startswith("solid") else 0.0)
        quality.SetInputConnection(at_rest.GetOutputPort())
        quality.Update()
        sizes = quality.GetOutput().GetCellData()
        filled = sum(vtk_to_numpy(sizes.GetArray(name)).sum() for name in ("Area", "Volume"))
        kind = data.GetCellType(0)
        if path.name == "solid.vtu":
            whole = array(data, "volume").sum()
            good = good and abs(filled / whole - 1.0) < 0.02
            print(f"  cells fill {filled:.6g} of {whole:.6g}")
        good = good and kind in (VTK_TRIANGLE, VTK_TETRA) and filled > 0.0
    return good


def check_state(run):
    """The script that shows a run, on a stand-in for ParaView."""
    stand_in = types.ModuleType("paraview.simple")
    exec(compile((Path(__file__).parent / "paraview_stand_in.py").read_text(), "stand-in", "exec"), stand_in.__dict__)
    package = types.ModuleType("paraview")
    package.simple = stand_in
    arguments, sys.argv = sys.argv, ["paraview-state.py"]
    sys.modules.update({"paraview": package, "paraview.simple": stand_in})
    try:
        runpy.run_path(str(run / "paraview-state.py"), run_name="__main__")
    finally:
        sys.argv = arguments
    for shown in stand_in.SHOWN:
        print(f"  {run.name} shows {shown.name} by {shown.colour}: {shown.data.GetNumberOfCells()} cells")
    return bool(stand_in.SHOWN) and all(shown.colour for shown in stand_in.SHOWN)


# Part of the places in the gas that are in no tetrahedron, and of those in the body that are in one.
PLACES = 1e-3
# Wall forces from the triangles between wall particles, as above: a body of flat triangles is smaller than a round one.
TRIANGLES = 2e-2
# What the area vectors of the triangles of a body add up to; sharp edges leave gaps.
GAP = 1e-3


def covered(field, wall, middle, reach, count=20000):
    """For places around the body: is each outside the triangles of the wall, and in a cell of the field."""
    places = middle + reach * numpy.random.default_rng(1).uniform(-1.0, 1.0, (count, 3))
    points, cloud = vtkPoints(), vtkPolyData()
    points.SetData(numpy_to_vtk(places))
    cloud.SetPoints(points)
    enclosed, probe = vtkSelectEnclosedPoints(), vtkProbeFilter()
    enclosed.SetInputData(cloud)
    enclosed.SetSurfaceData(wall)
    enclosed.Update()
    probe.SetInputData(cloud)
    probe.SetSourceData(field)
    probe.ComputeToleranceOff()
    probe.SetTolerance(1e-9)
    probe.Update()
    inside = vtk_to_numpy(enclosed.GetOutput().GetPointData().GetArray("SelectedPoints"))
    known = vtk_to_numpy(probe.GetOutput().GetPointData().GetArray(probe.GetValidPointMaskArrayName()))
    return inside == 0, known != 0


def check_space(run):
    field, wall = opened(run / "field.vtu"), opened(run / "surface.vtp")
    if not all([tells("field.vtu", field, CONDITIONS), tells("hull.vtp", opened(run / "hull.vtp"), CONDITIONS)]):
        return False
    if field.GetCellType(0) != VTK_TETRA or not wall.GetNumberOfPolys():
        print(f"{run.name}: the cells of the field are no tetrahedra, or those of the walls no triangles")
        return False
    points = vtk_to_numpy(field.GetPoints().GetData())
    corners = vtk_to_numpy(field.GetCells().GetConnectivityArray()).reshape(-1, 4)
    a, b, c, d = (points[corners[:, k]] for k in range(4))
    volumes = numpy.einsum("ij,ij->i", numpy.cross(b - a, c - a), d - a) / 6.0
    mass = vtkMassProperties()
    mass.SetInputData(wall)
    mass.Update()
    at_wall = vtk_to_numpy(wall.GetPoints().GetData())
    triangles = vtk_to_numpy(wall.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    middle, reach = at_wall.mean(axis=0), numpy.ptp(at_wall, axis=0)
    gas, found = covered(field, wall, middle, numpy.minimum(1.5 * reach, 0.4 * numpy.ptp(points, axis=0)))
    missing = numpy.count_nonzero(gas & ~found) / numpy.count_nonzero(gas)
    inside = numpy.count_nonzero(~gas & found) / max(1, numpy.count_nonzero(~gas))
    print(f"{run.name}: {len(corners)} tetrahedra, smallest {volumes.min():.3g}; of places in the gas {missing:.2g} in none, of those "
          f"in the body {inside:.2g} in one; {len(triangles)} triangles around a body of {mass.GetVolume():.6g}")

    contour, plane, cutter = vtkContourFilter(), vtkPlane(), vtkCutter()
    contour.SetInputData(field)
    contour.SetInputArrayToProcess(0, 0, 0, 0, "mach")
    contour.SetValue(0, float(numpy.median(array(wall, "mach"))))
    contour.Update()
    plane.SetOrigin(*(middle + 1e-3))
    plane.SetNormal(0.0, 1.0, 0.0)
    cutter.SetInputData(field)
    cutter.SetCutFunction(plane)
    cutter.Update()
    cut = cutter.GetOutput().GetNumberOfPolys()
    seeds, tracer = vtkPointSource(), vtkStreamTracer()
    seeds.SetNumberOfPoints(1)
    seeds.SetRadius(0.0)
    seeds.SetCenter(middle[0] - reach[0], middle[1] + 0.1 * reach[1], middle[2] + 0.1 * reach[2])
    tracer.SetInputData(field)
    tracer.SetSourceConnection(seeds.GetOutputPort())
    tracer.SetInputArrayToProcess(0, 0, 0, 0, "velocity")
    tracer.SetMaximumPropagation(float(4.0 * reach[0]))
    tracer.SetIntegratorTypeToRungeKutta45()
    tracer.Update()
    path = vtk_to_numpy(tracer.GetOutput().GetPoints().GetData())
    past = path[:, 0].max() > middle[0] + reach[0]
    polygons = contour.GetOutput().GetNumberOfPolys()
    print(f"  contour of Mach with {polygons} triangles, slice with {cut}, streamline to x = {path[:, 0].max():.4g}")

    pressure = array(wall, "pressure")
    a, b, c = (at_wall[triangles[:, k]] for k in range(3))
    outward = 0.5 * numpy.cross(b - a, c - a)
    force = -(pressure[triangles].mean(axis=1) @ outward)
    errors = off(run, wall, force)
    gap = numpy.abs(outward.sum(axis=0)).max() / numpy.abs(outward).sum()
    print(f"  areas of the triangles add up to {gap:.2g} of all")
    covers = gap < GAP and volumes.min() > 0.0 and missing < PLACES and inside < PLACES
    return bool(covers and polygons > 0 and cut > 0 and past and errors[0] < TRIANGLES and errors[1] < PANELS)


def crossings(chain, x):
    """Heights at which a chain of points crosses a vertical line."""
    a, b = chain[:-1], chain[1:]
    hit = (a[:, 0] < x) != (b[:, 0] < x)
    part = (x - a[hit, 0]) / (b[hit, 0] - a[hit, 0])
    return list(a[hit, 1] + part * (b[hit, 1] - a[hit, 1]))


def main(names):
    if not names:
        print(__doc__)
        return 2
    checks = {"--plane": check_plane, "--space": check_space, "--half": check_half, "--solid": check_solid, "--state": check_state}
    if names[0] in checks:
        bad = [run for run in names[1:] if not checks[names[0]](Path(run))]
        for run in bad:
            print(f"FAILED {run}")
        return 1 if bad else 0
    failures = 0
    for path in map(Path, names):
        good = path.is_file() and (read_collection if path.suffix == ".pvd" else read_data)(path)
        if not good:
            print(f"FAILED {path.name}")
            failures += 1
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
