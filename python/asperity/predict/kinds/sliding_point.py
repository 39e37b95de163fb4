"""A point mass that slides on a horizontal plane."""

from __future__ import annotations

from collections.abc import Sequence

from asperity._base.arrays import Array
from asperity._base.storage.toml import NUMBER, TomlFile
from asperity.predict.kinds.base import (
    START,
    Kind,
    Laws,
    Quantity,
    Setup,
    end_point,
    needed,
    planar_law,
    planar_vector,
    section,
    vector,
)
from asperity.runs.model import Model
from asperity.runs.run import Run
from asperity.system import SlidingPoint


def _build(file: TomlFile, laws: Laws) -> Setup:
    mass = needed(file, "body", "mass")
    with file.blamed():
        system = SlidingPoint(
            mass, law=planar_law(file, laws), gravity=section(file, "body").get("gravity", 9.81)
        )
    position = section(file, "start").get("position", [0.0, 0.0])
    return Setup(
        system,
        vector(file, "start.position", position, 2),
        planar_vector(file, "start", "velocity"),
    )


def _paths(_: Model, run: Run) -> dict[str, Array]:
    return {"point": run.q}


def _quantities(_: Model, run: Run) -> Sequence[Quantity]:
    return end_point(run.q, run)


SLIDING_POINT = Kind(
    name="sliding point",
    meaning="a point mass that slides on a horizontal plane until it rests",
    schema={"body": {"mass": NUMBER, "gravity": NUMBER}, "start": START},
    build=_build,
    paths=_paths,
    quantities=_quantities,
    has_end=True,
    example="""\
# A part of 18 g that is pushed along a surface and slides until it rests.
# Lengths are in m, times in s, masses in kg. The axes e1, e2 are those of the friction law,
# angles are counter-clockwise from e1.
kind = "sliding point"
law = "law.toml"            # written by `asperity identify`, or by hand

[body]
mass = 0.018                # kg
gravity = 9.81              # m/s2, presses the part on the plane

[start]
position = [0.0, 0.0]       # m
speed = 1.52                # m/s
direction_deg = 32.0        # or, instead of both, velocity = [1.29, 0.81]

[run]
duration = 1.0              # s, at most
step = 1e-4                 # s
until_rest = true           # end when it rests

[bands]                     # for --bands: what the uncertainty of the law means for the path
samples = 400               # laws that are drawn
confidence = 0.95
seed = 1
""",
)
