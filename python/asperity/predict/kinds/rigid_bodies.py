"""Boxes, balls and cylinders on planes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any, cast

import numpy as np

from asperity._base.arrays import Array
from asperity._base.storage.toml import NUMBER, NUMBERS, TEXT, Tables, TomlFile, advice_on
from asperity.errors import ParameterError
from asperity.law import FrictionLaw
from asperity.predict.kinds.base import Kind, Laws, Quantity, Setup, vector
from asperity.runs.model import Model
from asperity.runs.run import Run
from asperity.runs.trajectory import Trajectory
from asperity.system import Body, BoxPlane, Plane, PointPlane, RigidBodies, SpherePlane
from asperity.system.rigid import SphereSphere
from asperity.system.rigid.pairs import Pair

_SIZES = {"box": ("size",), "ball": ("diameter",), "cylinder": ("diameter", "height")}
# A cylinder touches planes with so many points of either edge.
_EDGE_POINTS = 12
# A body may start so deep within a plane, relative to its smallest size: positions are rounded.
_DEEPEST = 0.01


@contextmanager
def _blaming(file: TomlFile, key: str) -> Iterator[None]:
    """Say of a wrong argument in which table of the file it is."""
    renamed = {"half_sizes": "size", "radius": "diameter", "orientation": "turned_about"}
    try:
        yield
    except ParameterError as error:
        name = renamed.get(error.argument, error.argument)
        raise file.error(f"{key}.{name}", error.message) from None


def _tables(file: TomlFile, name: str) -> list[Mapping[str, Any]]:
    tables = file.values.get(name, [])
    if not tables:
        raise file.error(name, f"is missing: give at least one [[{name}]]")
    return list(tables)


def _number(file: TomlFile, key: str, table: Mapping[str, Any], name: str) -> float:
    if name not in table:
        raise file.error(f"{key}.{name}", "is missing")
    if table[name] <= 0.0:
        raise file.error(f"{key}.{name}", f"must be positive, got {table[name]!r}")
    return float(table[name])


def _half_sizes(file: TomlFile, key: str, table: Mapping[str, Any]) -> Array:
    if "size" not in table:
        raise file.error(f"{key}.size", "is missing: a box has three edges")
    return 0.5 * vector(file, f"{key}.size", table["size"], 3)


def _body(file: TomlFile, key: str, table: Mapping[str, Any]) -> Body:
    shape = table.get("shape", "box")
    if shape not in _SIZES:
        raise file.error(
            f"{key}.shape", f"of the name {shape!r} is not known{advice_on(shape, _SIZES)}"
        )
    for name in ("size", "diameter", "height"):
        if name in table and name not in _SIZES[shape]:
            raise file.error(f"{key}.{name}", f"is not known of a {shape}")
    state: dict[str, Any] = {
        name: vector(file, f"{key}.{name}", table[name], 3)
        for name in ("position", "velocity", "angular_velocity")
        if name in table
    }
    if "turned_about" in table or "turned_deg" in table:
        from scipy.spatial.transform import Rotation

        axis = vector(file, f"{key}.turned_about", table.get("turned_about", [0.0, 0.0, 1.0]), 3)
        if not axis.any():
            raise file.error(f"{key}.turned_about", "must not be zero")
        angle = np.deg2rad(table.get("turned_deg", 0.0))
        state["orientation"] = Rotation.from_rotvec(angle * axis / np.linalg.norm(axis))
    state["name"] = table["name"]
    mass = _number(file, key, table, "mass")
    with _blaming(file, key):
        if shape == "box":
            return Body.box(mass, half_sizes=_half_sizes(file, key, table), **state)
        radius = 0.5 * _number(file, key, table, "diameter")
        if shape == "ball":
            return Body.ball(mass, radius=radius, **state)
        return Body.cylinder(
            mass, radius=radius, height=_number(file, key, table, "height"), **state
        )


def _outermost(shape: Mapping[str, Any]) -> Array:
    """Return points of a body, in its axes, between which and planes is the distance of the body.

    Those of a ball are its centre, from which its radius is to be taken off.
    """
    if shape.get("shape", "box") == "box":
        half = 0.5 * np.asarray(shape["size"], float)
        return half * (np.stack(np.unravel_index(np.arange(8), (2, 2, 2)), axis=1) * 2.0 - 1.0)
    if shape["shape"] == "ball":
        return np.zeros((1, 3))
    radius, half_height = 0.5 * float(shape["diameter"]), 0.5 * float(shape["height"])
    angle = 2.0 * np.pi * np.arange(_EDGE_POINTS) / _EDGE_POINTS
    edge = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return np.array([(*at, z) for z in (-half_height, half_height) for at in edge.tolist()])


def _check_outside(
    file: TomlFile, key: str, shape: Mapping[str, Any], body: Body, plane: Plane, name: str
) -> None:
    """Refuse a body that starts within a plane, such as one whose centre was put on it."""
    from scipy.spatial.transform import Rotation

    # SciPy has the scalar part of quaternions last.
    turned = Rotation.from_quat(np.roll(body.orientation, -1)).apply(_outermost(shape))
    radius = 0.5 * float(shape["diameter"]) if shape.get("shape") == "ball" else 0.0
    deep = radius - float(((body.position + turned - plane.point) @ plane.axes[2]).min())
    if deep > _DEEPEST * min(np.min(shape[one]) for one in _SIZES[shape.get("shape", "box")]):
        raise file.error(
            f"{key}.position", f"is that of the centre: the body is {deep:.3g} m within {name!r}"
        )


def _pairs(
    file: TomlFile,
    key: str,
    table: Mapping[str, Any],
    shapes: Sequence[Mapping[str, Any]],
    bodies: Sequence[Body],
    planes: Mapping[str, Plane],
    laws: Laws,
) -> list[Pair]:
    """Return the pairs of a table ``[[contacts]]``."""
    names = [str(shape["name"]) for shape in shapes]

    def numbered(word: str) -> int:
        name = table.get(word)
        if name not in names:
            problem = "is missing" if name is None else f"of the name {name!r} is not there"
            raise file.error(f"{key}.{word}", f"{problem}; bodies are {', '.join(names)}")
        return names.index(name)

    law: FrictionLaw = laws[table["law"] if "law" in table else file.values["law"]]
    given = {
        name: table[name]
        for name in ("normal_restitution", "tangential_restitution")
        if name in table
    }
    first = numbered("body")
    shape = shapes[first]
    if ("plane" in table) == ("other" in table):
        raise file.error(key, "must have either a plane or another body that the body touches")
    with _blaming(file, key):
        if "other" in table:
            second = numbered("other")
            for i in (first, second):
                if shapes[i].get("shape") != "ball":
                    raise file.error(f"{key}.other", "must be a ball that touches a ball")
            radii = [0.5 * float(shapes[i]["diameter"]) for i in (first, second)]
            return [
                SphereSphere(
                    first,
                    radius=radii[0],
                    other=second,
                    other_radius=radii[1],
                    law=law,
                    **given,
                )
            ]
        if table["plane"] not in planes:
            known = ", ".join(planes)
            raise file.error(
                f"{key}.plane", f"of the name {table['plane']!r} is not there; planes are {known}"
            )
        plane = planes[table["plane"]]
        _check_outside(file, f"bodies[{first}]", shape, bodies[first], plane, table["plane"])
        kind = shape.get("shape", "box")
        if kind == "box":
            half = 0.5 * np.asarray(shape["size"], float)
            return [BoxPlane(first, half_sizes=half, plane=plane, law=law, **given)]
        if kind == "ball":
            radius = 0.5 * float(shape["diameter"])
            return [SpherePlane(first, radius=radius, plane=plane, law=law, **given)]
        return [
            PointPlane(first, point=point, plane=plane, law=law, **given)
            for point in _outermost(shape)
        ]


def _named(file: TomlFile, name: str, tables: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Return tables with names, those that have none with numbered ones."""
    whole = [{"name": f"{name[:-1]} {i + 1}", **one} for i, one in enumerate(tables)]
    seen: set[str] = set()
    for i, one in enumerate(whole):
        if one["name"] in seen:
            raise file.error(f"{name}[{i}].name", f"{one['name']!r} is there twice")
        seen.add(one["name"])
    return whole


def _build(file: TomlFile, laws: Laws) -> Setup:
    shapes = _named(file, "bodies", _tables(file, "bodies"))
    bodies = [_body(file, f"bodies[{i}]", one) for i, one in enumerate(shapes)]
    planes: dict[str, Plane] = {}
    tables = file.values.get("planes") or [{"name": "floor"}]
    for i, table in enumerate(_named(file, "planes", tables)):
        name = table.pop("name")
        with _blaming(file, f"planes[{i}]"):
            planes[name] = Plane(**table)
    pairs: list[Pair] = []
    for i, one in enumerate(_tables(file, "contacts")):
        pairs += _pairs(file, f"contacts[{i}]", one, shapes, bodies, planes, laws)
    gravity = vector(file, "gravity", file.values.get("gravity", [0.0, 0.0, -9.81]), 3)
    with file.blamed():
        return Setup(RigidBodies(bodies, pairs=pairs, gravity=gravity))


def _paths(system: Model, run: Run) -> dict[str, Array]:
    bodies = cast(RigidBodies, system)
    positions = bodies.positions(cast(Trajectory, run))
    return {name: positions[:, i] for i, name in enumerate(bodies.body_names)}


def _quantities(system: Model, run: Run) -> Sequence[Quantity]:
    return [
        Quantity(f"end of {name}, {axis}", "m", float(value))
        for name, path in _paths(system, run).items()
        for axis, value in zip("xyz", path[-1], strict=True)
    ]


_BODY: dict[str, Any] = {
    "name": TEXT,
    "shape": TEXT,
    "mass": NUMBER,
    "size": NUMBERS,
    "diameter": NUMBER,
    "height": NUMBER,
    "position": NUMBERS,
    "velocity": NUMBERS,
    "angular_velocity": NUMBERS,
    "turned_about": NUMBERS,
    "turned_deg": NUMBER,
}
_PLANE: dict[str, Any] = {
    "name": TEXT,
    "point": NUMBERS,
    "normal": NUMBERS,
    "axis": NUMBERS,
    "velocity": NUMBERS,
    "spin": NUMBER,
}
_CONTACT: dict[str, Any] = {
    "body": TEXT,
    "plane": TEXT,
    "other": TEXT,
    "law": TEXT,
    "normal_restitution": NUMBER,
    "tangential_restitution": NUMBER,
}

RIGID_BODIES = Kind(
    name="rigid bodies",
    meaning="boxes, balls and cylinders that slide, roll, tip and hop on planes",
    schema={
        "gravity": NUMBERS,
        "bodies": Tables(_BODY),
        "planes": Tables(_PLANE),
        "contacts": Tables(_CONTACT),
    },
    build=_build,
    paths=_paths,
    quantities=_quantities,
    has_end=False,
    example="""\
# A box and a ball that slide and roll on a plane.
# Lengths are in m, times in s, masses in kg; x and y are horizontal, z points up.
kind = "rigid bodies"
law = "law.toml"            # written by `asperity identify`, or by hand
gravity = [0.0, 0.0, -9.81] # m/s2

[[bodies]]
name = "box"
shape = "box"
mass = 1.0                  # kg
size = [0.1, 0.1, 0.04]     # m, its edges
position = [0.0, 0.0, 0.02] # m, of the centre of mass
velocity = [1.0, 0.5, 0.0]  # m/s
turned_about = [0.0, 0.0, 1.0]
turned_deg = 20.0

[[bodies]]
name = "ball"
shape = "ball"
mass = 0.5                  # kg
diameter = 0.06             # m
position = [0.0, 0.3, 0.03]
velocity = [1.0, 0.0, 0.0]

[[planes]]
name = "floor"              # through the origin, with its normal along z
axis = [1.0, 0.0, 0.0]      # e1 of the friction law

[[contacts]]
body = "box"
plane = "floor"

[[contacts]]
body = "ball"
plane = "floor"

[run]
duration = 1.0              # s, at most
step = 1e-3                 # s

[bands]                     # for --bands: what the uncertainty of the law means for the motion
samples = 50                # laws that are drawn
confidence = 0.95
seed = 1
""",
)
