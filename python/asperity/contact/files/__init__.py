"""Files of contact problems: ``.npz`` of NumPy, and HDF5 in the layout of FCLIB.

Both hold a problem u = W r + q with W = G, r = P, q = b, and rows normal, tangent 1, tangent 2.

**Plain problems** (all contacts unilateral and isotropic, no restitution) are files that other
engines read and write. NPZ, for p = 2: the CSR matrix ``W_data, W_indices, W_indptr, W_shape``, the
vectors ``q`` and ``mu``; of bodies also ``M_*`` (mass), ``H_*`` (directions), ``f`` and ``b`` of
M v = f + H r, u = Hᵀ v + b. HDF5, for p = 1 and 2: the groups ``fclib_local`` (W, q, mu, spacedim)
and, of bodies, ``fclib_global`` (M, H, f, w, mu, spacedim). A problem does not keep f: it writes
f = 0 and its whole b. Reading takes q where it is given, else b = Hᵀ M⁻¹ f + w, and G of the
bodies. Triplets have rows in `i` and columns in `p`, as in CSparse; of a mass matrix one triangle
stands for both. Rolling friction (`fclib_local_rolling`, `fclib_global_rolling`) is refused.
`percussions` returns what a file of FCLIB holds as solution and guesses.

G is kept sparse in files. A problem with a dense one, or with one that is made of the bodies, says
so in ``W_form``, of HDF5 in ``data/form``: it comes back as it was.

Of bodies that bilateral rows hold, W and q are what these leave, and b (w) is the bodies' own;
``E_*`` and ``s`` are those of Eᵀ v + s = 0, in HDF5 G and b of ``fclib_global``. Joints that a file
of FCLIB has in ``fclib_local`` (V, R) are refused.

What asperity writes has checksums throughout: damage is refused. HDF5 files of other engines have
none, and the HDF5 library itself may fail on damaged ones.

**Other problems** have no ``mu`` (and no ``spacedim``), so that nobody takes them for plain ones.
They hold besides, in HDF5 within the group ``data``: ``laws``, the different laws as JSON of the
tables that `FrictionLaw.save` writes, ``law``, the number of each contact's law therein, −1 of a
contact without friction, ``normal_force`` (NaN where unilateral), ``normal_restitution``,
``tangential_restitution`` and ``initial_velocity``; in HDF5 texts are bytes of UTF-8. Nothing is
pickled: reading a file cannot run code.

A coefficient μ = 0 is read as a disk of radius `FRICTIONLESS`, and that is written as 0.

Reference: [AcaryBremondHuber2018].
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Protocol

from asperity.contact.files import fclib, npz
from asperity.contact.files.contents import FRICTIONLESS, Percussions
from asperity.contact.problem import ContactProblem
from asperity.errors import ParameterError

__all__ = ["FRICTIONLESS", "SUFFIXES", "Percussions", "load", "percussions", "save"]


class _Format(Protocol):
    """A module that writes and reads one kind of file."""

    def save(self, problem: ContactProblem, path: Path) -> None: ...
    def load(self, path: Path) -> ContactProblem: ...
    def percussions(self, path: Path) -> Percussions: ...


_FORMATS: dict[str, _Format] = {".npz": npz, ".h5": fclib, ".hdf5": fclib}
SUFFIXES = tuple(_FORMATS)


def save(problem: ContactProblem, path: str | os.PathLike[str]) -> None:
    """Write a problem; the file is complete or not there."""
    target = Path(path)
    _format(target).save(problem, target)


def load(path: str | os.PathLike[str]) -> ContactProblem:
    """Read a problem; errors name the key."""
    source = Path(path)
    return _format(source).load(source)


def percussions(path: str | os.PathLike[str]) -> Percussions:
    """Return the percussions that a file holds beside its problem.

    Grade a solution by `ContactProblem.natural_map` or `certificate`, start from a guess by
    ``solve(start=...)``: a file may call anything a solution.

    >>> import tempfile
    >>> from pathlib import Path
    >>> from asperity import ContactProblem, FrictionLaw
    >>> problem = ContactProblem(
    ...     [[1.0]],
    ...     free_velocity=[0.5],
    ...     laws=FrictionLaw.isotropic(0.3, dimension=1),
    ...     normal_force=1.0,
    ... )
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     problem.save(Path(folder, "problem.npz"))
    ...     percussions(Path(folder, "problem.npz"))
    Percussions(solution=None, guesses=())
    """
    source = Path(path)
    return _format(source).percussions(source)


def _format(path: Path) -> _Format:
    if path.suffix not in _FORMATS:
        raise ParameterError("path", f"must end in {', '.join(SUFFIXES)}, got {path.name}")
    return _FORMATS[path.suffix]
