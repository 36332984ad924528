"""What a run of Alula wrote, shown in ParaView 5.10 or later: bodies, flow in a plane, streamlines; solids; modes in motion.

    paraview --script=paraview-state.py             (in the folder of the run; or File, Load State...)
    pvpython paraview-state.py picture.png          saves a picture without a window

It reads the files of the folder that it lies in, whatever these are, and uses names of arrays alone: edit it as you like.
"""
import os
import sys

from paraview.simple import *  # noqa: F403  (as states that ParaView saves do)

WRITTEN_IN = @FOLDER@
# What is shown first of each kind of file, and how streamlines begin: so many seeds.
FIELD, WALL, SOLID, MODE = ["mach"], ["cp"], ["von_mises_stress"], ["cp_unsteady", "displacement"]
SEEDS = 24
# Largest displacement of a natural mode that is drawn, over the largest extent of the body.
LARGE = 0.1


def run_folder():
    """The folder of the run: that of this file, else the working folder, else where it was written."""
    own = [os.path.dirname(os.path.abspath(__file__))] if "__file__" in globals() else []
    return next((f for f in [*own, os.getcwd(), WRITTEN_IN] if os.path.isfile(os.path.join(f, "case.toml"))), WRITTEN_IN)


FOLDER = run_folder()


def opened(*names):
    """The first of these files that is there."""
    for name in names:
        path = os.path.join(FOLDER, name)
        if os.path.isfile(path):
            source = OpenDataFile(path)
            RenameSource(name, source)
            source.UpdatePipeline()
            return source
    return None


def listed(start, end):
    return sorted(name for name in os.listdir(FOLDER) if name.startswith(start) and name.endswith(end))


def bounds(source):
    """Least and greatest x, y and z."""
    b = source.GetDataInformation().GetBounds()
    return b[0::2], b[1::2]


def show(source, view, arrays, bar=True):
    """Shows a source, coloured by the first of these arrays that it has."""
    display = Show(source, view)
    known = source.PointData.keys()
    array = next((name for name in arrays if name in known), None)
    if array:
        ColorBy(display, ("POINTS", array))
        display.RescaleTransferFunctionToDataRange(False, True)
        display.SetScalarBarVisibility(view, bar)
    return display


def streamlines(field, low, high, view):
    """Streamlines through a line of seeds ahead of the bodies, whose box is `low` to `high`."""
    size = max(h - l for l, h in zip(low, high))
    middle = [0.5 * (l + h) for l, h in zip(low, high)]
    first, last = bounds(field)
    flat = last[2] - first[2] <= 0.0
    across = 1 if flat or high[1] - low[1] >= high[2] - low[2] else 2
    lines = StreamTracer(Input=field, SeedType="Line")
    lines.Vectors = ["POINTS", "velocity"]
    ends = [list(middle), list(middle)]
    for end, sign in zip(ends, (-1.0, 1.0)):
        end[0] = max(low[0] - 0.5 * size, first[0] + 0.01 * (last[0] - first[0]))
        reach = (0.5 if flat else 0.1) * size
        end[across] = middle[across] + sign * (0.5 * (high[across] - low[across]) + reach)
        inset = 0.01 * (last[across] - first[across])
        end[across] = min(max(end[across], first[across] + inset), last[across] - inset)
    lines.SeedType.Point1, lines.SeedType.Point2 = ends
    lines.SeedType.Resolution = SEEDS
    lines.MaximumStreamlineLength = 3.0 * (last[0] - first[0])
    RenameSource("streamlines", lines)
    return show(lines, view, FIELD, bar=False)


def gas(view):
    """The flow: in the plane all of it, in space the walls and a slice along the span's middle or the plane of symmetry."""
    field = opened("series.pvd", "film.pvd", "field.pvd")
    if field is None:
        return False
    wall = opened("hull.vtp", "surface.vtp")
    low, high = bounds(wall or field)
    first, last = bounds(field)
    if last[2] - first[2] <= 0.0:
        show(field, view, FIELD)
    else:
        if wall:
            show(wall, view, WALL)
        # a half model ends at its plane of symmetry
        width = high[1] - low[1]
        half = [y for y, end in ((low[1], first[1]), (high[1], last[1])) if abs(y - end) < 0.01 * width]
        plane = Slice(Input=field)
        plane.SliceType = "Plane"
        middle = [0.5 * (l + h) for l, h in zip(low, high)]
        # walls reach a shade beyond that plane
        y = round((half[0] if half else middle[1]) / width, 5) * width
        plane.SliceType.Origin = [middle[0], y, middle[2]]
        plane.SliceType.Normal = [0.0, 1.0, 0.0]
        RenameSource("slice y = %.6g" % (y + 0.0), plane)
        show(plane, view, FIELD)
    streamlines(field, low, high, view)
    return True


def solid(view):
    """Bodies made of particles as deformed, coloured by stress."""
    source = opened("solid.pvd", "solid.vtu")
    if source is not None:
        show(source, view, SOLID)
    return source is not None


def modes(view):
    """Motions of flutter, and natural modes: the first is seen, the others wait in the pipeline."""
    shown = False
    for name in listed("flutter-mode-", ".pvd"):
        display = show(opened(name), view, MODE)
        display.Visibility, shown = not shown, True
    for name in listed("mode-", ".vtu"):
        source = opened(name)
        low, high = bounds(source)
        ranges = [source.PointData["displacement"].GetRange(k) for k in range(3)]
        largest = max(abs(x) for ends in ranges for x in ends) or 1.0
        warped = WarpByVector(Input=source)
        warped.Vectors = ["POINTS", "displacement"]
        warped.ScaleFactor = LARGE * max(h - l for l, h in zip(low, high)) / largest
        RenameSource(name + " warped", warped)
        display = show(warped, view, MODE, bar=not shown)
        display.Visibility, shown = not shown, True
    return shown


def main():
    view = GetActiveViewOrCreate("RenderView")
    flow = gas(view)
    # modes of a structure alone stand in place of it at rest
    if not modes(view) or flow:
        solid(view)
    GetAnimationScene().UpdateAnimationUsingDataTimeSteps()
    ResetCamera(view)
    Render(view)
    if len(sys.argv) > 1 and sys.argv[1].endswith(".png"):
        SaveScreenshot(sys.argv[1], view)


main()
