"""The file of a trajectory: its fields, and what they must be for one another."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity import _core
from asperity._base.archive import Archive
from asperity._base.files import atomic
from asperity.errors import DimensionError, ParameterError
from asperity.runs.state import check_memory
from asperity.status import Outcome, Phase

FORMAT = 1
"""Number of the file layout."""

_KIND = "a trajectory that this version can read"
# Types and axes of the fields. Axes of one letter have one length throughout the file.
_FIELDS: dict[str, tuple[type[np.generic], tuple[str | int, ...]]] = {
    "t": (np.float64, ("t",)),
    "q": (np.float64, ("t", "q")),
    "u": (np.float64, ("t", "u")),
    "slip": (np.float64, ("t", "contact", "p")),
    "force": (np.float64, ("t", "contact", "p")),
    "normal_force": (np.float64, ("t", "contact")),
    "phase": (np.int8, ("t", "contact")),
    "iterations": (np.int64, ("t",)),
    "residual": (np.float64, ("t",)),
    "status": (np.str_, ()),
    "dt": (np.float64, ()),
    "steps": (np.int64, ()),
    "ambiguous_steps": (np.int64, ()),
    "failed_steps": (np.int64, ()),
    "phase_counts": (np.int64, ("contact", 3)),
}
# The state from which another run goes on; files of runs that end without one have none of these,
# and the last three are there where they are known.
_END: dict[str, tuple[type[np.generic], tuple[str | int, ...]]] = {
    "end_q": (np.float64, ("q",)),
    "end_u": (np.float64, ("u",)),
    "end_t0": (np.float64, ()),
    "end_steps": (np.int64, ()),
    "end_dt": (np.float64, ()),
    "end_contacts": (np.float64, ("contact", 16)),
    "end_momenta": (np.float64, ("body", 3)),
}
_ALL = {**_FIELDS, **_END}
_NEEDED_AT_END = ("end_q", "end_u", "end_t0", "end_steps")
_MARKS = ("format", "version")
_COUNTS = ("iterations", "steps", "ambiguous_steps", "failed_steps", "phase_counts", "end_steps")
_FINITE = ("t", "q", "u", "dt", *(name for name in _END if name != "end_steps"))


def save(fields: Mapping[str, Any], path: str | os.PathLike[str]) -> None:
    """Write a trajectory; the file is complete or not there."""
    with atomic(path) as file:
        np.savez_compressed(file, format=FORMAT, version=_core.__version__, **fields)


def load(path: str | os.PathLike[str]) -> dict[str, Any]:
    """Return the fields of a trajectory, those of its end only where the file has them.

    Raises:
        ParameterError, DimensionError: naming the field, or the path, with the file in the message.
    """
    with Archive(path, _KIND) as file:
        _check_format(file)
        ended = any(name in file for name in _END)
        wanted = [*_FIELDS, *(_NEEDED_AT_END if ended else ())]
        wanted += [name for name in _END if name in file and name not in wanted]
        fields = {name: _field(file, name, *_ALL[name]) for name in wanted}
        unknown = sorted(set(file.keys) - set(_ALL) - set(_MARKS))
        if unknown:
            raise ParameterError(unknown[0], f"is no field of a trajectory, in {file.path}")
        try:
            _check_shapes(fields)
            _check_values(fields)
        except ParameterError as error:
            raise type(error)(error.argument, f"{error.message}, in {file.path}") from None
    # Scalars as Python's.
    return {name: value if value.ndim else value.item() for name, value in fields.items()}


def _check_format(file: Archive) -> None:
    for mark, kind in zip(_MARKS, "iU", strict=True):
        if mark not in file:
            raise ParameterError(mark, f"is missing: {file.path} must be {_KIND}")
        found = file[mark]
        if found.shape or found.dtype.kind != kind:
            raise ParameterError(mark, f"must be one value: {file.path} must be {_KIND}")
    if not 1 <= int(file["format"]) <= FORMAT:
        raise ParameterError(
            "format", f"must be {FORMAT} or older, {file.path} has {int(file['format'])}"
        )


def _field(
    file: Archive, name: str, kind: type[np.generic], axes: tuple[str | int, ...]
) -> NDArray[Any]:
    found = file[name]
    if not np.issubdtype(found.dtype, kind):
        wanted = np.dtype(kind).name
        raise ParameterError(name, f"must be of {wanted}, is of {found.dtype}, in {file.path}")
    if found.ndim != len(axes):
        raise DimensionError(
            name, f"must have {len(axes)} axes, has shape {found.shape}, in {file.path}"
        )
    return found


def _check_shapes(fields: Mapping[str, NDArray[Any]]) -> None:
    lengths: dict[str, int] = {}
    for name in fields:
        wanted = tuple(
            axis if isinstance(axis, int) else lengths.setdefault(axis, length)
            for axis, length in zip(_ALL[name][1], fields[name].shape, strict=True)
        )
        if fields[name].shape != wanted:
            raise DimensionError(name, f"must have shape {wanted}, has {fields[name].shape}")
    if not lengths["t"]:
        raise DimensionError("t", "must hold a sample")
    if lengths["contact"] and not 1 <= lengths["p"] <= 3:
        raise DimensionError("slip", f"must have 1 to 3 components, has {lengths['p']}")


def _check_values(fields: Mapping[str, NDArray[Any]]) -> None:
    for name in fields.keys() & _FINITE:
        if not np.isfinite(fields[name]).all():
            raise ParameterError(name, "must be finite")
    if (np.diff(fields["t"]) <= 0.0).any():
        raise ParameterError("t", "must ascend")
    for name in fields.keys() & {"dt", "end_dt"}:
        if fields[name] <= 0.0:
            raise ParameterError(name, "must be positive")
    if fields["status"].item() not in list(Outcome):
        raise ParameterError("status", f"must be {' or '.join(Outcome)}")
    for name in fields.keys() & {*_COUNTS, "residual"}:
        if (fields[name] < 0).any():
            raise ParameterError(name, "must not be negative")
    steps = int(fields["steps"])
    if len(fields["t"]) > steps + 1:
        raise ParameterError("steps", f"must be at least {len(fields['t']) - 1}, the samples' own")
    for name in ("ambiguous_steps", "failed_steps"):
        if fields[name] > steps:
            raise ParameterError(name, f"must be at most {steps}, the number of steps")
    if (fields["phase_counts"].sum(axis=1) > steps).any():
        raise ParameterError("phase_counts", f"must count at most {steps} steps of a contact")
    _check_phases(fields["phase"])
    _check_gaps(fields)
    if "end_q" in fields:
        _check_end(fields)


def _check_end(fields: Mapping[str, NDArray[Any]]) -> None:
    """Check what the next step asks for: it must be of the last sample."""
    # After a step all of it is known.
    for name in _END:
        if name not in fields and fields["end_steps"] > 0:
            raise ParameterError(name, "is missing")
    for name in ("q", "u", "dt"):
        last = fields[name] if name == "dt" else fields[name][-1]
        if not np.array_equal(fields.get(f"end_{name}", last), last):
            raise ParameterError(f"end_{name}", f"must be the last {name}")
    if fields["end_steps"] < fields["steps"]:
        raise ParameterError("end_steps", f"must be at least {fields['steps']}")
    if fields["end_t0"] + fields["end_steps"] * fields["dt"] != fields["t"][-1]:
        raise ParameterError("end_t0", "must fit the last time")
    if "end_contacts" in fields:
        check_memory(fields["end_contacts"], "end_contacts")


def _check_phases(phase: NDArray[Any]) -> None:
    if not np.isin(phase, list(Phase)).all() or (phase[1:] == Phase.NONE).any():
        raise ParameterError("phase", "must be 0, 1 or 2, and -1 in the initial state alone")


def _check_gaps(fields: Mapping[str, NDArray[Any]]) -> None:
    """NaN stands in the initial state, and for components that a contact does not have."""
    for name in ("slip", "force", "normal_force", "residual"):
        if np.isinf(fields[name]).any():
            raise ParameterError(name, "must be finite")
    for name in ("normal_force", "residual"):
        if np.isnan(fields[name][1:]).any():
            raise ParameterError(name, "must be known, but in the initial state")
    absent = np.isnan(fields["slip"][-1])
    if absent[:, :1].any() or (absent[:, :-1] & ~absent[:, 1:]).any():
        raise ParameterError("slip", "must be known in the first components of every contact")
    for name, first in (("slip", 0), ("force", 1)):
        if (np.isnan(fields[name][first:]) != absent).any():
            raise ParameterError(name, "must be known in the same components in every sample")
