"""A disk on three pads that slides on a horizontal plane and may turn."""

from __future__ import annotations

from collections.abc import Sequence
from typing import cast

import numpy as np

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
from asperity.runs.trajectory import Trajectory
from asperity.system import SlidingDisk

_SIZES = ("mass", "diameter", "height", "pad_circle", "pad_height")


def _build(file: TomlFile, laws: Laws) -> Setup:
    sizes = {name: needed(file, "body", name) for name in _SIZES}
    start = section(file, "start")
    gravity = float(section(file, "body").get("gravity", 9.81))
    if gravity <= 0.0:
        raise file.error("body.gravity", f"must be positive, got {gravity!r}")
    with file.blamed():
        disk = SlidingDisk(
            planar_law(file, laws),
            position=vector(file, "start.position", start.get("position", [0.0, 0.0]), 2),
            velocity=planar_vector(file, "start", "velocity"),
            spin=start.get("spin", 0.0),
            angle=float(np.deg2rad(start.get("angle_deg", 0.0))),
            gravity=(0.0, 0.0, -gravity),
            **sizes,
        )
    return Setup(disk)


def _paths(system: Model, run: Run) -> dict[str, Array]:
    return {"disk": cast(SlidingDisk, system).path(cast(Trajectory, run))}


def _quantities(system: Model, run: Run) -> Sequence[Quantity]:
    disk = cast(SlidingDisk, system)
    rotations = disk.rotations(cast(Trajectory, run))[:, 0]
    turned = rotations[-1] @ rotations[0].T
    angle = float(np.rad2deg(np.arctan2(turned[1, 0], turned[0, 0])))
    return [
        *end_point(disk.path(cast(Trajectory, run)), run),
        Quantity("angle turned about the vertical, up to whole turns", "deg", angle),
    ]


SLIDING_DISK = Kind(
    name="sliding disk",
    meaning="a disk on three pads that slides on a horizontal plane and may spin",
    schema={
        "body": dict.fromkeys((*_SIZES, "gravity"), NUMBER),
        "start": {**START, "spin": NUMBER, "angle_deg": NUMBER},
    },
    build=_build,
    paths=_paths,
    quantities=_quantities,
    has_end=True,
    example="""\
# A disk on three pads that is launched along a surface and slides until it rests.
# Lengths are in m, times in s, masses in kg. The axes e1, e2 are those of the friction law,
# angles are counter-clockwise from e1.
kind = "sliding disk"
law = "law.toml"            # written by `asperity identify`, or by hand

[body]
mass = 0.018                # kg
diameter = 0.028            # m
height = 0.013              # m
pad_circle = 0.021          # m, diameter of the circle on which the three pads are
pad_height = 0.001          # m

[start]
position = [0.0, 0.0]       # m
speed = 1.52                # m/s
direction_deg = 32.0        # or, instead of both, velocity = [1.29, 0.81]
spin = 0.0                  # rad/s about the vertical
angle_deg = 0.0             # of the first pad

[run]
duration = 1.0              # s, at most
step = 1e-4                 # s
until_rest = true           # end when it rests

[bands]                     # for --bands: what the uncertainty of the law means for the path
samples = 200               # laws that are drawn
confidence = 0.95
seed = 1
""",
)
