"""Aeroelastic loads from a surface file, without a mesh."""

from os import PathLike
from pathlib import Path
from typing import Any, Callable, Mapping, Optional, TypedDict, Union

import numpy as np
from numpy.typing import NDArray

__version__: str

Case = Union[str, PathLike[str], Mapping[str, Any]]

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
        `temperature` (over that of the free stream), `total_pressure`, `total_pressure_loss`, `entropy`, `spacing`, `volume`, `level`,
        `kind` (0 fluid, 1 wall, 2 outer) (N,).
        """
    @property
    def surface(self) -> dict[str, NDArray[Any]]:
        """Arrays over the M particles on walls.

        `positions`, `normal` (into the gas), `area_vector`, `velocity` (M, 2 or 3); `area`, `arc`, `x_c`, `pressure`, `cp`, `mach`,
        `density`, with viscosity `cf`, `heat_flux` and `y_plus` (M,); indices `body` and `tag` (M,) into `bodies` and `tags`.
        """
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

def run(
    case: Case,
    out: Optional[Union[str, PathLike[str]]] = None,
    progress: Optional[Callable[[dict[str, Any]], Any]] = None,
    threads: Optional[int] = None,
) -> Result:
    """Solves a case: the path of a case file, or a dict with its keys.

    `out` is a folder for tables, checkpoints, fields, pictures and the report; without it no file is written. `progress` is called with
    a dict for every iteration (`"event": "iteration"`) and for what is worth a line (`"note"`, `"warning"`). `threads` is the number
    of threads, by default one for each core.

    Raises CaseError, ComputationError, OSError, and KeyboardInterrupt at the end of the iteration in which Ctrl-C came.
    """

def resume(
    out: Union[str, PathLike[str]],
    progress: Optional[Callable[[dict[str, Any]], Any]] = None,
    threads: Optional[int] = None,
) -> Result:
    """Goes on with the run in the folder `out` that was stopped, from its checkpoint, to the same bits as if it had not been.

    Raises CaseError where there is nothing to go on with, else what `run` raises.
    """

def check(case: Case) -> dict[str, Any]:
    """Reads a case, builds its cloud, and tells what it means and what a run will take; computes no flow.

    Raises CaseError and OSError.
    """
