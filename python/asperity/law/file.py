"""Friction laws as tables of data, and in files."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from importlib import import_module
from typing import Any, Self

import asperity._core as _core
from asperity._base import arrays
from asperity._base.storage import data, provenance, toml
from asperity._base.storage.data import HEAD_SCHEMA, FileFormat
from asperity._base.storage.provenance import Provenance
from asperity._base.storage.toml import NUMBERS, TABLE, TEXTS, Kind, Schema, TomlFile
from asperity._base.value import Value
from asperity.errors import ParameterError
from asperity.law.engine_report import EngineReport
from asperity.law.flow import FlowReport
from asperity.law.friction import FrictionLaw
from asperity.law.rate import Stribeck
from asperity.sets import StarSet
from asperity.sets import file as set_file

FORMAT = FileFormat("asperity law", 1)
_MODEL = Kind("a model: its name, or a table", lambda value: isinstance(value, str | dict))
_PART = {"degrees_of_freedom": NUMBERS, "matrix": NUMBERS}
SCHEMA: Schema = {
    **HEAD_SCHEMA,
    "law": {"reservoir": TABLE, "direction": TABLE, "rate": TABLE, "report": TABLE},
    "parameters": {
        "model": _MODEL,
        "reservoir_model": _MODEL,
        "direction_model": _MODEL,
        "names": TEXTS,
        "values": NUMBERS,
        "units": TEXTS,
        "coordinates": TEXTS,
        "covariance": {"turns": _PART, "calibration": _PART, "zeros": _PART},
    },
    "provenance": provenance.SCHEMA,
}
"""Of a file of a law. What the parameters mean, `identify.IdentifiedLaw` knows."""

COMMENTS = {
    "": "A law of dry friction, per unit normal force λ_N. The friction force λ on the body is\n"
    "such that -λ/λ_N lies in the force reservoir C: inside while the contact sticks, on its\n"
    "boundary while it slips. Sliding is along the normal of the direction set D in the direction\n"
    "of -λ. Axes e1, e2 are fixed to the surface, angles counter-clockwise from e1 in rad.",
    "law.reservoir": "C, the force reservoir: dimensionless like a friction coefficient",
    "law.direction": "D, the direction set: only its shape has an effect",
    "law.rate": "factor of the force in slip over the speed: speed in m/s, viscous in s/m",
    "law.report": "how C and D were found",
    "parameters.covariance.turns": "covariance of the coordinates: what differs between turns",
    "parameters.covariance.calibration": "the same from errors of the calibration",
    "parameters.covariance.zeros": "the same from errors of the zeros",
    "provenance": "where this law comes from",
}


def table_of(law: FrictionLaw, key: str) -> dict[str, Any]:
    """Return a law as a table: the arguments of its constructor, sets with their ``type``.

    Raises:
        ParameterError: for a law, a set or a factor of a class that is not asperity's.
    """
    _refuse_other_class(law, FrictionLaw, key)
    return data.arguments(law, key, _table_of_part)


def _table_of_part(value: Value, key: str) -> dict[str, Any]:
    if isinstance(value, StarSet):
        return set_file.table_of(value, key)
    known = (kind for kind in (Stribeck, EngineReport) if isinstance(value, kind))
    _refuse_other_class(value, next(known, FlowReport), key)
    return data.arguments(value, key, _table_of_part)


def _refuse_other_class(value: Value, kind: type[Value], key: str) -> None:
    if type(value) is not kind:
        raise ParameterError(
            key,
            f"of the class {type(value).__name__} is code, and a file holds data: it takes "
            f"{kind.__name__}",
        )


def law_of(table: Any, key: str) -> FrictionLaw:
    """Return the law of a table.

    Raises:
        ParameterError: whose argument is the key of what is wrong.
    """

    def part(table: Any, inner: str) -> Value:
        if inner == f"{key}.rate":
            return data.built(Stribeck, table, inner, set_file.set_of)
        if inner == f"{key}.report":
            # Only an engine's says which engine.
            is_engine = isinstance(table, dict) and "engine" in table
            kind = EngineReport if is_engine else FlowReport
            return data.built(kind, table, inner, set_file.set_of)
        return set_file.set_of(table, inner)

    return data.built(FrictionLaw, table, key, part)


class LawFile(Value):
    """What a file of a law holds: the law and where it comes from.

    `FrictionLaw.save` and `load` write and read such files; this class also has the provenance. Of
    a law that was fitted to measurements the file has the parameters and their covariance, too:
    then `load` returns an `identify.IdentifiedLaw`.

    Args:
        law: the law.
        provenance: where it comes from.

    >>> import os, tempfile
    >>> from asperity import FrictionLaw, LawFile, Provenance
    >>> path = os.path.join(tempfile.mkdtemp(), "pvc.toml")
    >>> law, origin = FrictionLaw.isotropic(0.3), Provenance(note="PVC on PVC, dry")
    >>> LawFile(law, provenance=origin).save(path)
    >>> LawFile.load(path).provenance.note
    'PVC on PVC, dry'
    """

    law: FrictionLaw
    provenance: Provenance

    def __init__(self, law: FrictionLaw, *, provenance: Provenance | None = None) -> None:
        self._set(**checked(law, provenance))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the file, with the version of the package and the date of today.

        Args:
            path: of the file; it is complete or not there.

        Raises:
            ParameterError: if the law, or a set in it, is of a class that is not asperity's.
        """
        parameters, comment = self._parameters_table()
        written = {
            **FORMAT.head(),
            "law": table_of(self.law, "law"),
            "parameters": parameters,
            "provenance": self.provenance.written_by(_core.__version__).table(),
        }
        toml.write(path, written, {**COMMENTS, "parameters": comment})

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Read a file, as an `identify.IdentifiedLaw` if it has parameters.

        Nothing in it is executed.

        Args:
            path: of the file.

        Raises:
            ConfigurationError: with file, line and key of what is wrong.
        """
        with read(path) as (law, origin, parameters):
            kind = cls
            if parameters is not None and cls is LawFile:
                # The meaning of parameters belongs to `identify`, which imports SciPy.
                kind = import_module("asperity.identify").IdentifiedLaw
            return kind._of_parts(law, origin, parameters)

    def _parameters_table(self) -> tuple[dict[str, Any] | None, str]:
        """Return the section ``[parameters]`` and what is said above it."""
        return None, ""

    @classmethod
    def _of_parts(
        cls, law: FrictionLaw, provenance: Provenance, parameters: Mapping[str, Any] | None
    ) -> Self:
        """Return what the sections of a file hold."""
        return cls(law, provenance=provenance)


def checked(law: FrictionLaw, provenance: Provenance | None) -> dict[str, Any]:
    """Return the arguments of `LawFile`."""
    arrays.of_kind(law, "law", FrictionLaw, "a FrictionLaw")
    arrays.of_kind(provenance, "provenance", Provenance | None, "a Provenance or None")
    return {"law": law, "provenance": Provenance() if provenance is None else provenance}


@contextmanager
def read(
    path: str | os.PathLike[str],
) -> Iterator[tuple[FrictionLaw, Provenance, Mapping[str, Any] | None]]:
    """Yield law, provenance and parameters of a file; say of what is wrong with them where it is.

    Raises:
        ConfigurationError: with file, line and key of what is wrong.
    """
    file = TomlFile(path, SCHEMA, FORMAT.check)
    with file.named():
        if "law" not in file.values:
            raise ParameterError("law", "is missing")
        law = law_of(file.values["law"], "law")
        origin = Provenance.of_table(file.values.get("provenance", {}), "provenance")
        yield law, origin, file.values.get("parameters")
