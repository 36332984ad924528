"""What the state script of a run needs of `paraview.simple`, made of VTK alone: tests run the script without ParaView.

Everything that is shown is computed and must not be empty; arrays are looked for by name as ParaView does. `SHOWN` tells what was shown.
"""
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from types import SimpleNamespace

from vtkmodules.vtkCommonDataModel import vtkPlane, vtkPolyData
from vtkmodules.vtkFiltersCore import vtkCutter
from vtkmodules.vtkFiltersFlowPaths import vtkStreamTracer
from vtkmodules.vtkFiltersGeneral import vtkWarpVector
from vtkmodules.vtkFiltersSources import vtkLineSource
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLUnstructuredGridReader

READERS = {".vtu": vtkXMLUnstructuredGridReader, ".vtp": vtkXMLPolyDataReader}
SHOWN = []


class Arrays(dict):
    """The arrays at the points, by name."""

    def __init__(self, data):
        arrays = data.GetPointData()
        super().__init__((arrays.GetArrayName(k), Array(arrays.GetArray(k))) for k in range(arrays.GetNumberOfArrays()))


class Array:
    def __init__(self, array):
        self.array = array

    def GetRange(self, component):
        return self.array.GetRange(component)


class Source:
    """A file or a filter: `Input` and what ParaView calls its properties."""

    def __init__(self, compute, **properties):
        self._compute, self._data, self.name = compute, None, ""
        self.__dict__.update(properties)

    def UpdatePipeline(self):
        self.data()

    def data(self):
        if self._data is None:
            self._data = self._compute(self)
        return self._data

    @property
    def PointData(self):
        return Arrays(self.data())

    def GetDataInformation(self):
        return SimpleNamespace(GetBounds=lambda: self.data().GetBounds())


def run(filter, data):
    filter.SetInputData(data)
    filter.Update()
    return filter.GetOutput()


def OpenDataFile(path):
    path = Path(path)
    if path.suffix == ".pvd":
        entries = ElementTree.parse(path).getroot().findall("./Collection/DataSet")
        path = path.parent / entries[-1].get("file")

    def read(_):
        reader = READERS[path.suffix]()
        reader.SetFileName(str(path))
        reader.Update()
        return reader.GetOutput()

    return Source(read, name=path.name)


def Slice(Input):
    def cut(self):
        plane, cutter = vtkPlane(), vtkCutter()
        plane.SetOrigin(*self.SliceType.Origin)
        plane.SetNormal(*self.SliceType.Normal)
        cutter.SetCutFunction(plane)
        return run(cutter, Input.data())

    source = Source(cut)
    # the kind of plane is set by its name, as in ParaView
    object.__setattr__(source, "SliceType", SimpleNamespace(Origin=[0, 0, 0], Normal=[1, 0, 0]))
    source.__class__ = type("Slice", (Source,), {"__setattr__": keep_slice_type})
    return source


def keep_slice_type(self, name, value):
    if name == "SliceType":
        assert value == "Plane"
    else:
        object.__setattr__(self, name, value)


def StreamTracer(Input, SeedType):
    assert SeedType == "Line"

    def trace(self):
        seeds, tracer = vtkLineSource(), vtkStreamTracer()
        seeds.SetPoint1(*self.SeedType.Point1)
        seeds.SetPoint2(*self.SeedType.Point2)
        seeds.SetResolution(self.SeedType.Resolution)
        tracer.SetSourceConnection(seeds.GetOutputPort())
        tracer.SetInputArrayToProcess(0, 0, 0, 0, self.Vectors[1])
        tracer.SetMaximumPropagation(self.MaximumStreamlineLength)
        tracer.SetIntegratorTypeToRungeKutta45()
        return run(tracer, Input.data())

    return Source(trace, SeedType=SimpleNamespace())


def WarpByVector(Input):
    def warp(self):
        warp = vtkWarpVector()
        warp.SetScaleFactor(self.ScaleFactor)
        warp.SetInputArrayToProcess(0, 0, 0, 0, self.Vectors[1])
        return run(warp, Input.data())

    return Source(warp)


def Show(source, view):
    data = source.data()
    cells = data.GetNumberOfCells()
    if isinstance(data, vtkPolyData) and data.GetNumberOfVerts() == cells or not cells:
        raise AssertionError(f"`{source.name}` shows no lines, faces or cells")
    shown = SimpleNamespace(name=source.name, data=data, colour=None, Visibility=True)
    shown.RescaleTransferFunctionToDataRange = lambda *_: None
    shown.SetScalarBarVisibility = lambda *_: None
    SHOWN.append(shown)
    return shown


def ColorBy(display, array):
    where, name = array
    assert where == "POINTS" and display.data.GetPointData().HasArray(name), name
    display.colour = name


def RenameSource(name, source):
    source.name = name


def GetActiveViewOrCreate(kind):
    return kind


def GetAnimationScene():
    return SimpleNamespace(UpdateAnimationUsingDataTimeSteps=lambda: None)


def ResetCamera(view):
    pass


def Render(view):
    pass


def SaveScreenshot(path, view):
    pass
