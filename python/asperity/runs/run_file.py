"""The files of trajectories and motions: their fields, and what these must be for one another."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from asperity import _core
from asperity._base.storage.archive import Archive
from asperity._base.storage.files import atomic
from asperity.errors import DimensionError, ParameterError
from asperity.runs.event import NO_NUMBER, EventKind
from asperity.runs.state import check_memory
from asperity.status import Outcome, Phase

FORMAT = 2
"""Number of the file layout; 1 had trajectories without names and origin."""

_Fields: TypeAlias = dict[str, tuple[type[np.generic], tuple[str | int, ...]]]
# Types and axes of the fields. Axes of one letter have one length throughout the file.
_SERIES: _Fields = {
    "t": (np.float64, ("t",)),
    "q": (np.float64, ("t", "q")),
    "u": (np.float64, ("t", "u")),
    "slip": (np.float64, ("t", "contact", "p")),
    "force": (np.float64, ("t", "contact", "p")),
    "normal_force": (np.float64, ("t", "contact")),
    "phase": (np.int8, ("t", "contact")),
    "status": (np.str_, ()),
    "steps": (np.int64, ()),
}
_FIELDS: dict[str, _Fields] = {
    "trajectory": {
        **_SERIES,
        "iterations": (np.int64, ("t",)),
        "residual": (np.float64, ("t",)),
        "dt": (np.float64, ()),
        "ambiguous_steps": (np.int64, ()),
        "failed_steps": (np.int64, ()),
        "phase_counts": (np.int64, ("contact", 3)),
    },
    "motion": {
        **_SERIES,
        "rejected_steps": (np.int64, ()),
        "event_time": (np.float64, ("event",)),
        "event_kind": (np.str_, ("event",)),
        "event_contact": (np.int64, ("event",)),
        "event_phase": (np.int8, ("event",)),
        "event_ambiguous": (np.bool_, ("event",)),
    },
}
# Texts that describe the run, from the second layout on; arrays of theirs have a dot in the name.
_TEXTS: _Fields = {"labels": (np.str_, ()), "origin": (np.str_, ())}
# The state from which another run goes on; files of runs that end without one have none of these,
# and the last three are there where they are known.
_END: _Fields = {
    "end_q": (np.float64, ("q",)),
    "end_u": (np.float64, ("u",)),
    "end_t0": (np.float64, ()),
    "end_steps": (np.int64, ()),
    "end_dt": (np.float64, ()),
    "end_contacts": (np.float64, ("contact", 16)),
    "end_momenta": (np.float64, ("body", 3)),
}
_NEEDED_AT_END = ("end_q", "end_u", "end_t0", "end_steps")
_MARKS = {"format": "i", "version": "U"}
_COUNTS = (
    "iterations",
    "steps",
    "ambiguous_steps",
    "failed_steps",
    "rejected_steps",
    "phase_counts",
    "end_steps",
)
_FINITE = ("t", "q", "u", "dt", "event_time", *(name for name in _END if name != "end_steps"))


def save(kind: str, fields: Mapping[str, Any], path: str | os.PathLike[str]) -> None:
    """Write a ``"trajectory"`` or a ``"motion"``; the file is complete or not there."""
    with atomic(path) as file:
        np.savez_compressed(file, format=FORMAT, version=_core.__version__, kind=kind, **fields)


def load(kind: str, path: str | os.PathLike[str]) -> dict[str, Any]:
    """Return the fields of a run, those of its end and what describes it where the file has them.

    Raises:
        ParameterError, DimensionError: naming the field, or the path, with the file in the message.
    """
    known = {**_FIELDS[kind], **(_END if kind == "trajectory" else {}), **_TEXTS}
    with Archive(path, f"a {kind} that this version can read") as file:
        _check_format(file, kind)
        ended = any(name in file for name in _END)
        wanted = [*_FIELDS[kind], *(_NEEDED_AT_END if ended else ())]
        wanted += [name for name in known if name in file and name not in wanted]
        fields = {name: _field(file, name, *known[name]) for name in wanted if name in known}
        beside = [name for name in file.keys if "." in name]
        unknown = sorted(set(file.keys) - {*known, *_MARKS, "kind", *beside})
        if unknown:
            raise ParameterError(unknown[0], f"is no field of a {kind}, in {file.path}")
        try:
            _check_shapes(fields, known)
            _check_values(fields)
        except ParameterError as error:
            raise type(error)(error.argument, f"{error.message}, in {file.path}") from None
        # Scalars as Python's.
        plain = {name: value if value.ndim else value.item() for name, value in fields.items()}
        return {**plain, **{name: file[name] for name in beside}}


def _check_format(file: Archive, kind: str) -> None:
    if "content" in file:
        raise ParameterError("path", f"must be a {kind}, {file.path} is of another result")
    marks = dict(_MARKS)
    if "format" in file and "kind" in file:
        marks["kind"] = "U"
    for mark, letter in marks.items():
        if mark not in file:
            raise ParameterError(mark, f"is missing: {file.path} must be a {kind}")
        found = file[mark]
        if found.shape or found.dtype.kind != letter:
            raise ParameterError(mark, f"must be one value: {file.path} must be a {kind}")
    number = int(file["format"])
    if not 1 <= number <= FORMAT:
        raise ParameterError("format", f"must be {FORMAT} or older, {file.path} has {number}")
    if number > 1 and "kind" not in file:
        raise ParameterError("kind", f"is missing: {file.path} must be a {kind}")
    # The first layout had trajectories only.
    found_kind = str(file["kind"]) if number > 1 else "trajectory"
    if found_kind != kind:
        raise ParameterError("kind", f"must be {kind!r}, {file.path} is of the kind {found_kind!r}")


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


def _check_shapes(fields: Mapping[str, NDArray[Any]], known: _Fields) -> None:
    lengths: dict[str, int] = {}
    for name in fields:
        wanted = tuple(
            axis if isinstance(axis, int) else lengths.setdefault(axis, length)
            for axis, length in zip(known[name][1], fields[name].shape, strict=True)
        )
        if fields[name].shape != wanted:
            raise DimensionError(name, f"must have shape {wanted}, has {fields[name].shape}")
    if lengths["contact"] and not 1 <= lengths["p"] <= 3:
        raise DimensionError("slip", f"must have 1 to 3 components, has {lengths['p']}")


def _check_values(fields: Mapping[str, NDArray[Any]]) -> None:
    for name in fields.keys() & _FINITE:
        if not np.isfinite(fields[name]).all():
            raise ParameterError(name, "must be finite")
    # A motion has two samples at an event, before and after it.
    motion = "event_time" in fields
    steps_back = np.diff(fields["t"]) < 0.0 if motion else np.diff(fields["t"]) <= 0.0
    if steps_back.any():
        raise ParameterError("t", "must ascend")
    for name in fields.keys() & {"dt", "end_dt"}:
        if fields[name] <= 0.0:
            raise ParameterError(name, "must be positive")
    if fields["status"].item() not in list(Outcome):
        raise ParameterError("status", f"must be {' or '.join(Outcome)}")
    for name in fields.keys() & {*_COUNTS, "residual"}:
        if (fields[name] < 0).any():
            raise ParameterError(name, "must not be negative")
    if motion:
        _check_events(fields)
    else:
        _check_steps(fields)
    _check_phases(fields["phase"])
    _check_gaps(fields, first=0 if motion else 1)
    if "end_q" in fields:
        _check_end(fields)


def _check_steps(fields: Mapping[str, NDArray[Any]]) -> None:
    steps = int(fields["steps"])
    if len(fields["t"]) > steps + 1:
        raise ParameterError("steps", f"must be at least {len(fields['t']) - 1}, the samples' own")
    for name in ("ambiguous_steps", "failed_steps"):
        if fields[name] > steps:
            raise ParameterError(name, f"must be at most {steps}, the number of steps")
    if (fields["phase_counts"].sum(axis=1) > steps).any():
        raise ParameterError("phase_counts", f"must count at most {steps} steps of a contact")


def _check_events(fields: Mapping[str, NDArray[Any]]) -> None:
    if (np.diff(fields["event_time"]) < 0.0).any():
        raise ParameterError("event_time", "must ascend")
    known = list(EventKind)
    strange = sorted(set(fields["event_kind"].tolist()) - set(known))
    if strange:
        raise ParameterError("event_kind", f"must be {' or '.join(known)}, got {strange[0]!r}")
    contacts = fields["phase"].shape[1]
    for name, allowed in (("event_contact", range(contacts)), ("event_phase", Phase)):
        wrong = ~np.isin(fields[name], [*allowed, NO_NUMBER])
        if wrong.any():
            found = int(fields[name][wrong.argmax()])
            raise ParameterError(name, f"must be of this motion, or {NO_NUMBER} for none: {found}")


def _check_end(fields: Mapping[str, NDArray[Any]]) -> None:
    """Check what the next step asks for: it must be of the last sample."""
    # After a step all of it is known.
    for name in _END:
        if name not in fields and fields["end_steps"] > 0:
            raise ParameterError(name, "is missing")
    if not len(fields["t"]):
        raise ParameterError("end_q", "must be of the last sample, there is none")
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


def _check_gaps(fields: Mapping[str, NDArray[Any]], *, first: int) -> None:
    """Refuse NaN but in an initial state and for components that a contact does not have.

    Args:
        fields: of the file.
        first: number of the first sample with forces: a trajectory's initial state has none.
    """
    for name in fields.keys() & {"slip", "force", "normal_force", "residual"}:
        if np.isinf(fields[name]).any():
            raise ParameterError(name, "must be finite")
    for name in fields.keys() & {"normal_force", "residual"}:
        if np.isnan(fields[name][first:]).any():
            raise ParameterError(name, "must be known, but in the initial state")
    if not len(fields["t"]):
        return
    absent = np.isnan(fields["slip"][-1])
    if absent[:, :1].any() or (absent[:, :-1] & ~absent[:, 1:]).any():
        raise ParameterError("slip", "must be known in the first components of every contact")
    for name, since in (("slip", 0), ("force", first)):
        if (np.isnan(fields[name][since:]) != absent).any():
            raise ParameterError(name, "must be known in the same components in every sample")
