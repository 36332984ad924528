"""Aeroelastic loads from a surface file, without a mesh."""

from os import PathLike
from pathlib import Path
from typing import Any, Callable, Mapping, Optional, TypedDict, Union

import numpy as np
from numpy.typing import NDArray

__version__: str

Case = Union[str, PathLike[str], Mapping[str, Any]]
Folder = Optional[Union[str, PathLike[str]]]
Progress = Optional[Callable[[dict[str, Any]], Any]]
Numbers = NDArray[np.float64]
Table = dict[str, NDArray[Any]]

class Loads(TypedDict):
    """Half widths of error bars of lift, drag and moment coefficients."""

    cl: float
    cd: float
    cm: float

class Mistake(TypedDict):
    """A mistake in a case; None where unknown. Lines and columns are counted from 1, in files only."""

    key: Optional[str]
    line: Optional[int]
    column: Optional[int]
    end_column: Optional[int]
    message: str
    value: Optional[str]
    allowed: Optional[str]
    hint: Optional[str]

class CaseError(ValueError):
    """A case cannot be computed as it is written."""

    mistakes: list[Mistake]

class ComputationError(RuntimeError):
    """A computation broke off: the message says where, and what may help."""

class Result:
    """What a run found.

    Lengths are in the unit of the geometry. In a stream with units (`pressure`, `temperature`, ... in the case) all else is in SI
    units; otherwise densities are over that of the free stream, velocities over its sound speed c, pressures over density times c².
    """

    @property
    def title(self) -> str:
        """Title of the case."""
    @property
    def cl(self) -> float:
        """Lift coefficient; of a polar that of its last point, of a march that of its end.

        Means and harmonics of the last period of a motion are in `summary["periodic_loads"]`.
        """
    @property
    def cd(self) -> float:
        """Drag coefficient."""
    @property
    def cm(self) -> float:
        """Moment coefficient about the reference point, nose up positive."""
    @property
    def loads_error(self) -> Optional[Loads]:
        """Half widths of the error bars of the loads; None without a family of clouds.

        Those of marches and harmonic balances (`accuracy.error`) are in `summary["error_bars"]["bars"]`.
        """
    @property
    def converged(self) -> Optional[bool]:
        """True when the goal was reached; None of a march that came to its end and was asked for nothing else."""
    @property
    def summary(self) -> dict[str, Any]:
        """Everything else that is one number: what `summary.json` holds."""
    @property
    def history(self) -> dict[str, NDArray[np.float64]]:
        """Arrays of shape (iterations,), named as the columns of `history.csv`."""
    @property
    def fields(self) -> dict[str, NDArray[np.float64]]:
        """Arrays over all N particles.

        `positions`, `velocity` (N, 2 or 3); `vorticity` (N,) in the plane, else (N, 3); `density`, `pressure`, `mach`, `cp`,
        `temperature` (K; without units over that of the free stream), `total_pressure`, `total_pressure_loss`, `entropy`, `spacing`, `volume`, `level`,
        `kind` (0 fluid, 1 wall, 2 outer) (N,).
        """
    @property
    def surface(self) -> dict[str, NDArray[Any]]:
        """Arrays over the M particles on walls.

        `positions`, `normal` (into the gas), `area_vector`, `velocity` (M, 2 or 3); `area`, `arc`, `x_c`, `pressure`, `cp`, `mach`,
        `density`, with viscosity `cf`, `heat_flux` and `y_plus` (M,); indices `body` and `tag` (M,) into `bodies` and `tags`.
        """
    @property
    def solid(self) -> Optional[dict[str, NDArray[np.float64]]]:
        """Arrays over the particles of bodies made of particles at the end, as `Solid.fields`; None without such bodies."""
    @property
    def bodies(self) -> list[str]:
        """Names of bodies."""
    @property
    def tags(self) -> list[str]:
        """Names of their parts."""
    @property
    def polar(self) -> Optional[dict[str, Any]]:
        """Arrays over the points of a polar, NaN where a point failed; None for a single flow.

        `mach`, `alpha_deg`, `cl`, `cd`, `cm`, `cl_error`, `cd_error`, `cm_error` (half widths of error bars), `converged`, and the lists
        `long_bars` (names of loads whose bars are longer than asked for), `within_accuracy` (whether all are as short as that; None where
        there are none) and `reason`, empty where a point converged.
        """
    @property
    def folder(self) -> Optional[Path]:
        """Folder of the run; None without one."""

class Flutter:
    """A flutter boundary."""

    @property
    def title(self) -> str:
        """Title of the case."""
    @property
    def mach(self) -> Numbers:
        """Mach numbers (n,)."""
    @property
    def speeds(self) -> Numbers:
        """Speed at which a motion begins to grow at each Mach number (n,).

        At constant density the lowest, at varied density or altitude that of the first crossing. NaN where nothing grows, or something from
        the first speed on.
        """
    @property
    def speed_errors(self) -> Numbers:
        """Half widths of the error bars of `speeds` (n,); NaN where they are not known or the speed is not what varies."""
    @property
    def frequencies(self) -> Numbers:
        """Frequencies of the motions that begin to grow (n,), in cycles per unit of time; 0 of divergence."""
    @property
    def crossings(self) -> list[dict[str, Any]]:
        """Every crossing with the names of `flutter.json`; None where something is not known or has no meaning.

        `mach`, `kind` (`flutter`, `restabilised`, `divergence`), `branch`, `mode`, `speed`, `frequency`, `density`, `dynamic_pressure`,
        `speed_index`, ..., half widths of error bars `..._error`, `remarks`, `shape`.
        """
    @property
    def doubts(self) -> list[dict[str, Any]]:
        """Ranges of speed in which the spacing of the cloud decides whether a motion grows.

        `mach`, `branch`, `kind`, `speed` (first, last), `damping`, `damping_coarser`, ...
        """
    @property
    def vg(self) -> Table:
        """Motions at all speeds that were looked at, for V-g and V-f diagrams: arrays (m,).

        `mach`, `branch`, `mode` (NaN where motions do not oscillate), `speed`, `damping` (g, growth positive), `frequency`,
        `reduced_frequency` (NaN where nothing flows), `eigenvalue` (complex), `speed_ratio`, `equivalent_airspeed`, `density`,
        `dynamic_pressure`, `altitude`.
        """
    @property
    def lco(self) -> list[dict[str, Any]]:
        """Limit cycles, where `[lco]` asks for them."""
    @property
    def units(self) -> dict[str, str]:
        """Units of the numbers in `crossings` and `vg` by name, as in UCUM: `1` of a pure number.

        Without units in the case `a` is the sound speed and `rho` the density of the free stream, `L` the unit of the geometry.
        """
    @property
    def conventions(self) -> str:
        """Signs and definitions."""
    @property
    def warnings(self) -> list[str]:
        """What makes results doubtful, with the Mach number."""
    @property
    def folder(self) -> Optional[Path]:
        """Folder of the boundary; None without one."""
    def to_dict(self) -> dict[str, Any]:
        """Everything as plain dicts and lists, as in `flutter.json`.

        Also generalised forces, natural modes, clearance and cost of each Mach number.
        """

class Gaf:
    """Generalised aerodynamic forces of N modes at K reduced frequencies.

    Motions are Re q exp(i omega t) with the reduced frequency k = omega L/U; the force on mode i over the coordinate of mode j that makes it is
    q S c Q_ij with the dynamic pressure q, the area S (in the plane the chord, for a unit of span) and the chord c.
    """

    @property
    def title(self) -> str:
        """Title of the case."""
    @property
    def modes(self) -> list[str]:
        """Names of the N modes, in the order of rows and columns."""
    @property
    def reduced_frequencies(self) -> Numbers:
        """Reduced frequencies k (K,), in the order of the case."""
    @property
    def frequencies(self) -> Numbers:
        """Frequencies (K,), in cycles per unit of time: k U/(2 pi L)."""
    @property
    def q(self) -> NDArray[np.complex128]:
        """Generalised forces (K, N, N): `q[k, i, j]` is the force on mode i that mode j makes."""
    @property
    def q_error(self) -> Numbers:
        """Error bars of `q` for the spacing of the cloud (K, N, N).

        Radii of circles in the complex plane; NaN where no coarser cloud tells them.
        """
    @property
    def cl(self) -> NDArray[np.complex128]:
        """Lift over motion (K, N)."""
    @property
    def cl_error(self) -> Numbers:
        """Error bars of `cl` (K, N)."""
    @property
    def cm(self) -> NDArray[np.complex128]:
        """Moment about the pivot over motion, nose up positive (K, N)."""
    @property
    def cm_error(self) -> Numbers:
        """Error bars of `cm` (K, N)."""
    @property
    def converged(self) -> NDArray[np.bool_]:
        """True where the equations were solved (K, N)."""
    @property
    def nonlinearity(self) -> Numbers:
        """Part by which forces change when the amplitude is halved (K, N); NaN of infinitely small motions."""
    @property
    def conditions(self) -> dict[str, Any]:
        """What the forces hold for, in the units of the case.

        `mach`, `alpha_deg`, `speed` U and `dynamic_pressure` q of the stream, `chord` c, `area` S, `reduced_length` L and `pivot` (None
        without one).
        """
    @property
    def units(self) -> dict[str, str]:
        """Units as in UCUM of `frequencies`, `q`, `cl`, `cm` and of the numbers in `conditions`."""
    @property
    def conventions(self) -> str:
        """Signs and definitions."""
    @property
    def folder(self) -> Optional[Path]:
        """Folder of the matrices; None without one."""
    def to_dict(self) -> Table:
        """A dict of columns, one row for each column of the matrices: `pandas.DataFrame` takes it.

        `k`, `mode` (that moves), `cl_re`, `cl_im`, `cm_re`, `cm_im`, `converged`, `q_<mode>_re`, `q_<mode>_im` and, where known, `..._error`, as
        the columns of `gaf.csv`.
        """

class Solid:
    """What was found of a structure of particles alone.

    All is in SI units; masses and energies of plane bodies are those of their `thickness`, of bodies of revolution those of a whole turn.
    """

    @property
    def title(self) -> str:
        """Title of the case."""
    @property
    def study(self) -> str:
        """`equilibrium`, `march`, `modes` or `periodic`."""
    @property
    def converged(self) -> bool:
        """False where the energy is so far from closed that results are wrong."""
    @property
    def bodies(self) -> list[str]:
        """Names of the bodies, which `fields["body"]` counts from 0."""
    @property
    def fields(self) -> dict[str, Numbers]:
        """Arrays over the N particles at the end, of a periodic motion at the start of the period.

        `positions`, `at_rest` (positions before), `displacement`, `velocity` (N, 2 or 3); `stress` (Cauchy's, N, 3, 3); `von_mises_stress`,
        `pressure`, of metals `plastic_strain` and `temperature`, `body`, `material`, `volume` and `spacing` at rest (N,).
        """
    @property
    def history(self) -> dict[str, Numbers]:
        """Arrays (T,) over recorded times, named as the columns of `history.csv`.

        About 1000 of a march, the steps of the load of an equilibrium, one period of a periodic motion: `step`, `time`, energies (`kinetic`,
        `strain`, `stabilisation`, `contact`, `dissipated`, `damped`), `work`, `open` (part of the energy that is missing), displacements of probes.
        """
    @property
    def probes(self) -> dict[str, Numbers]:
        """Displacements of the probes by name (T, 2 or 3), over `history["time"]`."""
    @property
    def energies(self) -> Optional[dict[str, float]]:
        """Energies at the end, and `work`; None of natural modes without a load."""
    @property
    def modes(self) -> Optional[dict[str, Numbers]]:
        """Natural modes (M,): `frequency` (Hz), `omega` (rad/s), `generalised_mass`, `residual`; None where there are none."""
    @property
    def shapes(self) -> Optional[Numbers]:
        """Displacement of every particle in each mode (M, N, 2 or 3), the greatest component of which is one; None without modes."""
    @property
    def summary(self) -> dict[str, Any]:
        """Everything that is one number: what `summary.json` holds."""
    @property
    def folder(self) -> Optional[Path]:
        """Folder of the run; None without one."""

class Cloud:
    """The cloud of a case before a run, in the unit of the geometry.

    Images across planes of symmetry and periodic sides are left out.
    """

    @property
    def title(self) -> str:
        """Title of the case."""
    @property
    def positions(self) -> Numbers:
        """Places (N, 2 or 3)."""
    @property
    def kind(self) -> NDArray[np.uint8]:
        """0 fluid, 1 on a wall, 2 on a side of the domain (N,)."""
    @property
    def spacing(self) -> Numbers:
        """Distance of neighbours (N,)."""
    @property
    def volume(self) -> Numbers:
        """Volume that a particle stands for, area in the plane (N,)."""
    @property
    def normal(self) -> Numbers:
        """Unit normals (N, 2 or 3): of walls into the gas, of sides of the domain out of it; zero of fluid particles."""
    @property
    def area_vector(self) -> Numbers:
        """Area times normal of particles on walls (N, 2 or 3), else zero; it closes around a body."""
    @property
    def body(self) -> NDArray[np.int32]:
        """Index into `bodies` (N,); -1 of particles on no body."""
    @property
    def boundary(self) -> NDArray[np.int32]:
        """Index into `boundaries` (N,); -1 of fluid particles."""
    @property
    def bodies(self) -> list[str]:
        """Names of the bodies."""
    @property
    def boundaries(self) -> list[str]:
        """Names of the parts of bodies (a body without parts is one), then of the sides of the domain, `x_min` to `y_max` or `z_max`."""
    @property
    def conditions(self) -> dict[str, Any]:
        """Condition of each side of the domain, in the words of the case file."""
    @property
    def notes(self) -> list[str]:
        """What was repaired or assumed."""

class Geometry:
    """Bodies, in the unit of the geometry."""

    @property
    def dimension(self) -> int:
        """Number of space dimensions, 2 or 3."""
    @property
    def vertices(self) -> Numbers:
        """Places of the vertices (V, dimension)."""
    @property
    def elements(self) -> NDArray[np.uint32]:
        """Vertices of the elements (E, dimension).

        Segments, counter-clockwise along outlines, or triangles, counter-clockwise seen from the gas.
        """
    @property
    def area_vectors(self) -> Numbers:
        """Length of segments or area of triangles times the unit normal into the gas (E, dimension)."""
    @property
    def body(self) -> NDArray[np.uint16]:
        """Index into `bodies` of each element (E,)."""
    @property
    def tag(self) -> NDArray[np.uint16]:
        """Index into `tags` of each element (E,)."""
    @property
    def bodies(self) -> list[str]:
        """Names of the bodies."""
    @property
    def tags(self) -> list[str]:
        """Names of their parts; a body without parts is one."""
    @property
    def outlines(self) -> Optional[list[Numbers]]:
        """Outlines of plane bodies, each an array (P, 2) whose last point is its first one; None in space."""
    @property
    def area(self) -> float:
        """Wetted area; in the plane the length of the outlines."""
    @property
    def volume(self) -> float:
        """Volume; in the plane the area within the outlines."""
    @property
    def closed(self) -> bool:
        """True where every edge belongs to two elements."""
    @property
    def chord(self) -> float:
        """Chord that coefficients are made with: that of `[reference]`, else of the bodies."""
    @property
    def reference_area(self) -> float:
        """Area that coefficients are made with; in the plane the chord."""
    @property
    def span(self) -> Optional[float]:
        """Extent along y of what is drawn; None in the plane."""
    @property
    def extents(self) -> Numbers:
        """Smallest and largest coordinates (2, dimension)."""
    @property
    def boxes(self) -> dict[str, Numbers]:
        """The same of each body by name."""
    @property
    def notes(self) -> list[str]:
        """What was assumed, repaired or closed."""

def run(
    case: Case,
    out: Folder = None,
    progress: Progress = None,
    threads: Optional[int] = None,
) -> Result:
    """Solves a case: the path of a case file, or a dict with its keys.

    `out` is a folder for tables, checkpoints, fields, pictures and the report; without it no file is written. `progress` is called with
    a dict for every iteration (`"event": "iteration"`) and for what is worth a line (`"note"`, `"warning"`). `threads` is the number
    of threads, by default one for each core.

    Raises CaseError, ComputationError, OSError, and KeyboardInterrupt at the end of the iteration in which Ctrl-C came.
    """

def flutter(
    case: Case,
    out: Folder = None,
    forces: Optional[Union[str, PathLike[str]]] = None,
    progress: Progress = None,
    threads: Optional[int] = None,
) -> Flutter:
    """Seeks the flutter boundary of the table `[flutter]` of a case.

    `forces` is `flutter.json` or `gaf.json` of a former run: the boundary of the structure with these forces, without a flow. All else is as for
    `run`; with `out`, `resume` goes on with the Mach numbers that Ctrl-C left.
    """

def gaf(
    case: Case,
    out: Folder = None,
    progress: Progress = None,
    threads: Optional[int] = None,
) -> Gaf:
    """Computes the generalised aerodynamic forces of the table `[gaf]` of a case. All else is as for `run`."""

def solid(
    case: Case,
    out: Folder = None,
    progress: Progress = None,
    threads: Optional[int] = None,
) -> Solid:
    """Solves a structure of particles alone: its equilibrium, a march, its natural modes or a periodic motion, as `[time]` says.

    All else is as for `run`.
    """

def resume(
    out: Union[str, PathLike[str]],
    progress: Progress = None,
    threads: Optional[int] = None,
) -> Union[Result, Flutter, Solid]:
    """Goes on with what was stopped in the folder `out`, from its checkpoint, to the same bits as if it had not been.

    A run, a structure alone, or a flutter boundary, of which the Mach numbers go on that were not finished. Raises CaseError where there is
    nothing to go on with, else what `run` raises.
    """

def check(case: Case) -> dict[str, Any]:
    """Reads a case, builds its cloud or structure, and tells what it means and what a run will take; computes no flow.

    Raises CaseError, with all that is refused, OSError and, at Ctrl-C, KeyboardInterrupt.
    """

def cloud(case: Case) -> Cloud:
    """Builds the cloud of a case, as a run on it would begin with; computes no flow. Raises what `check` raises."""

def geometry(shape: Case) -> Geometry:
    """Reads bodies as a run would have them: placed, repaired, clipped where they intersect, closed.

    `shape` is a case, of which `body` is enough in a dict, or the path of a surface file: triangles (`.stl`, `.obj`, `.ply`), else the coordinates
    of a section. A file whose name ends in `.toml` is a case. Raises what `check` raises.
    """
