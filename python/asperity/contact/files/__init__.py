"""Files of contact problems: ``.npz`` of NumPy, and HDF5 in the layout of FCLIB.

Both hold a problem u = W r + q with W = G, r = P, q = b, and rows normal, tangent 1, tangent 2.

**Plain problems** (all contacts unilateral and isotropic, no restitution) are files that other
engines read and write. NPZ, for p = 2: the CSR matrix ``W_data, W_indices, W_indptr, W_shape``, the
vectors ``q`` and ``mu``; of bodies also ``M_*`` (mass), ``H_*`` (directions), ``f`` and ``b`` of
M v = f + H r, u = Hᵀ v + b. HDF5, for p = 1 and 2: the groups ``fclib_local`` (W, q, mu, spacedim)
and, of bodies, ``fclib_global`` (M, H, f, w, mu, spacedim). A problem does not keep f: it writes
f = 0 and its whole b. Reading takes q where it is given.

**Other problems** have no ``mu`` (and no ``spacedim``), so that nobody takes them for plain ones.
They hold besides, in HDF5 within the group ``data``: ``laws``, the different laws as JSON of
constructor names and parameters, ``law``, the number of each contact's law therein,
``normal_force`` (NaN where unilateral), ``normal_restitution``, ``tangential_restitution`` and
``initial_velocity``. Nothing is pickled: reading a file cannot run code.

A coefficient μ = 0 is read as a disk of radius `FRICTIONLESS`, and that is written as 0.

Reference: [AcaryBremondHuber2018].
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Protocol

from asperity.contact.files import fclib, npz
from asperity.contact.files.contents import FRICTIONLESS
from asperity.contact.problem import ContactProblem
from asperity.errors import ParameterError

__all__ = ["FRICTIONLESS", "SUFFIXES", "load", "save"]


class _Format(Protocol):
    """A module that writes and reads one kind of file."""

    def save(self, problem: ContactProblem, path: Path) -> None: ...
    def load(self, path: Path) -> ContactProblem: ...


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


def _format(path: Path) -> _Format:
    if path.suffix not in _FORMATS:
        raise ParameterError("path", f"must end in {', '.join(SUFFIXES)}, got {path.name}")
    return _FORMATS[path.suffix]
