"""A finite-element model whose contacts slide, as a file."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from asperity._base.arrays import Array
from asperity._base.storage.toml import (
    COUNT,
    NUMBER,
    NUMBERS,
    SWITCH,
    TEXT,
    Kind,
    Schema,
    Tables,
    TomlFile,
)
from asperity.errors import ParameterError
from asperity.law import FrictionLaw
from asperity.predict.law_sheet import planar_law
from asperity.system import (
    FiniteElementModel,
    LinearSystem,
    MeshContacts,
    SparseLinearSystem,
    read_calculix,
    read_matrices,
)

_NODES = Kind("the name of a set or numbers of nodes", lambda x: TEXT.holds(x) or NUMBERS.holds(x))
# Largest |Re s|, as a share of the band's upper end, unless the file says it; that of `stability`.
_GROWTH = 0.05
_ROLES = ("mass", "stiffness", "damping")
_SCHEMA: Schema = {
    "law": TEXT,
    "title": TEXT,
    "model": {
        "calculix": TEXT,
        **dict.fromkeys(_ROLES, TEXT),
        **{f"{role}_name": TEXT for role in _ROLES},
        "deck": TEXT,
        "first_node": COUNT,
    },
    "damping": {"mass": NUMBER, "stiffness": NUMBER},
    "contacts": {"nodes": _NODES, "normal": NUMBERS, "tangent": NUMBERS, "gap": NUMBER},
    "surface": {"velocity": NUMBERS, "rate": NUMBERS, "centre": NUMBERS, "circles": SWITCH},
    "loads": Tables({"nodes": _NODES, "force": NUMBERS}),
    "squeal": {"band": NUMBERS, "growth": NUMBER, "count": COUNT, "certify": SWITCH},
    "parameters": {"friction": NUMBERS, "direction_deg": NUMBERS},
}


@dataclass(frozen=True)
class SquealModel:
    """Matrices, contacts, loads and the motion of the surface; made by `SquealModel.load`.

    Attributes:
        file: the file, for messages.
        law: the friction law of all contacts.
        law_path: of its file.
        model: the matrices, and what was found in them.
        band: frequencies in Hz between which eigenvalues are sought.
        options: of `stability` besides.
        friction: factors of the friction force.
        directions: angles in rad by which the motion of the surface is turned about the normal.
    """

    file: TomlFile
    law: FrictionLaw
    law_path: Path
    model: FiniteElementModel
    band: tuple[float, float]
    options: Mapping[str, Any]
    friction: Array
    directions: Array

    @classmethod
    def load(
        cls, path: str | os.PathLike[str], *, law: str | os.PathLike[str] | None = None
    ) -> SquealModel:
        """Read a model; files that it names are beside it or at absolute paths.

        Args:
            path: of the TOML file; ``asperity init --kind squeal`` writes an example.
            law: file of a law that takes the place of the one in the key ``law``.

        Raises:
            ConfigurationError: with file, line and key of what is wrong.
        """
        file = TomlFile(path, _SCHEMA)
        if law is None and "law" not in file.values:
            raise file.error("law", "is missing: name the file of a friction law")
        place = _path(file, "law", str(file.values["law"])) if law is None else Path(law)
        known = planar_law(place).law
        search = dict(file.values.get("squeal", {}))
        band = np.asarray(search.pop("band", ()), dtype=float)
        if band.shape != (2,) or not 0.0 <= band[0] < band[1]:
            raise file.error("squeal.band", "must be two frequencies in Hz, the lower one first")
        search.setdefault("growth", _GROWTH * 2.0 * math.pi * float(band[1]))
        scan = file.values.get("parameters", {})
        friction = np.atleast_1d(np.asarray(scan.get("friction", 1.0), dtype=float))
        directions = np.atleast_1d(np.asarray(scan.get("direction_deg", 0.0), dtype=float))
        for name, values in (("friction", friction), ("direction_deg", directions)):
            if values.ndim != 1 or not values.size or (name == "friction" and values.min() <= 0):
                raise file.error(f"parameters.{name}", "must be numbers, of friction above 0")
        made = cls(
            file,
            known,
            place,
            _model(file),
            (float(band[0]), float(band[1])),
            search,
            friction,
            np.deg2rad(directions),
        )
        _ = made.system
        return made

    @property
    def title(self) -> str:
        """Of pictures and reports: what the file says, or its name."""
        return str(self.file.values.get("title", self.file.path.stem))

    @cached_property
    def system(self) -> SparseLinearSystem:
        """The system with the friction and the direction of the file.

        Raises:
            ConfigurationError: if the file does not describe one.
        """
        file, model = self.file, self.model
        contacts = self._contacts()
        force = np.zeros(len(model.nodes))
        for i, load in enumerate(file.values.get("loads", [])):
            key = f"loads[{i}]"
            for name in ("nodes", "force"):
                if name not in load:
                    raise file.error(f"{key}.{name}", "is missing")
            with at(file, key):
                places = np.unique(model.coordinates(load["nodes"]), axis=0)
                force[places] += _vector(load["force"], "force") / len(places)
        damping = file.values.get("damping", {})
        with at(file, "model"):
            C = damping.get("mass", 0.0) * model.mass
            C = C + damping.get("stiffness", 0.0) * model.stiffness
            made = LinearSystem(
                model.mass,
                stiffness=model.stiffness,
                damping=C if model.damping is None else C + model.damping,
                force=force,
                contacts=contacts,
            )
        assert isinstance(made, SparseLinearSystem)
        return made

    def _contacts(self) -> MeshContacts:
        file, model, law = self.file, self.model, self.law
        given, surface = file.values.get("contacts", {}), file.values.get("surface", {})
        if "nodes" not in given:
            raise file.error("contacts.nodes", "is missing: name the set of the contact nodes")
        if ("velocity" in surface) == ("rate" in surface):
            raise file.error("surface", "needs either velocity, or rate of a disc that turns")
        with at(file, "contacts"):
            options: dict[str, Any] = {
                "coordinates": model.coordinates(given["nodes"]),
                "normals": _vector(given.get("normal", [0.0, 0.0, 1.0]), "normal"),
                "gap": given.get("gap", 0.0),
            }
            if "tangent" in given:
                options["tangents"] = _vector(given["tangent"], "tangent")
        with at(file, "surface"):
            if "rate" in surface:
                return MeshContacts.on_disc(
                    law,
                    positions=model.positions(given["nodes"]),
                    rate=_vector(surface["rate"], "rate"),
                    centre=_vector(surface.get("centre", [0.0, 0.0, 0.0]), "centre"),
                    circumferential=surface.get("circles", False),
                    **options,
                )
            velocity = _vector(surface["velocity"], "velocity")
            return MeshContacts(law, velocity=velocity, **options)


def _model(file: TomlFile) -> FiniteElementModel:
    given = file.values.get("model", {})
    deck = _path(file, "model.deck", given["deck"]) if "deck" in given else None
    if "calculix" in given:
        for name in given:
            if name not in ("calculix", "deck"):
                raise file.error(f"model.{name}", "does not go with calculix, which has M and K")
        with at(file, "model", path="calculix"):
            return read_calculix(Path(file.path.parent, given["calculix"]), deck=deck)
    sources: dict[str, Any] = {}
    for role in _ROLES:
        if role not in given:
            continue
        sources[role] = _path(file, f"model.{role}", given[role])
        if f"{role}_name" in given:
            sources[role] = sources[role], given[f"{role}_name"]
    for role in ("mass", "stiffness"):
        if role not in sources:
            raise file.error(f"model.{role}", "is missing: name the file, or calculix = JOB")
    with at(file, "model"):
        found = read_matrices(**sources, deck=deck)
        if found.nodes.any() or "first_node" not in given:
            return found
        # Rows of x, y, z of one node after the other.
        n = len(found.nodes)
        numbers = given["first_node"] + np.arange(n) // 3
        dof = np.stack([numbers, 1 + np.arange(n) % 3], axis=1)
        return read_matrices(**sources, deck=deck, dof=dof)


def _path(file: TomlFile, key: str, name: str) -> Path:
    place = Path(file.path.parent, name)
    if not place.is_file():
        raise file.error(key, f"names the file {place}, which is not there")
    return place


@contextmanager
def at(file: TomlFile, section: str, **renamed: str) -> Iterator[None]:
    """Say of a wrong argument in which section of the file it is."""
    names = {"normals": "normal", "tangents": "tangent", "coordinates": "nodes", **renamed}
    try:
        yield
    except ParameterError as error:
        name = names.get(error.argument, error.argument)
        # Contacts are made of both sections.
        section = "contacts" if name in _SCHEMA["contacts"] else section
        raise file.error(f"{section}.{name}", error.message) from None


def _vector(values: Any, name: str) -> Array:
    vector = np.asarray(values, dtype=float)
    if vector.shape != (3,):
        raise ParameterError(name, f"must be three numbers, got {values!r}")
    return vector
