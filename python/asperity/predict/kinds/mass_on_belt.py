"""A mass held by springs on a moving belt."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from asperity._base.arrays import Array
from asperity._base.storage.toml import NUMBER, NUMBERS, TomlFile
from asperity.predict.kinds.base import (
    Kind,
    Laws,
    Quantity,
    Setup,
    needed,
    planar_law,
    planar_vector,
    section,
    vector,
)
from asperity.runs.model import Model
from asperity.runs.run import Run
from asperity.status import Phase
from asperity.system import MassOnBelt


def _build(file: TomlFile, laws: Laws) -> Setup:
    mass, stiffness = needed(file, "body", "mass"), needed(file, "body", "stiffness")
    load = needed(file, "body", "normal_force")
    belt = planar_vector(file, "belt", "velocity")
    if not belt.any():
        raise file.error("belt", "must move: give speed and direction_deg, or velocity")
    with file.blamed():
        system = MassOnBelt(
            mass,
            stiffness=stiffness,
            law=planar_law(file, laws),
            normal_force=load,
            belt_velocity=belt,
        )
    start = section(file, "start")
    return Setup(
        system,
        *(
            vector(file, f"start.{name}", start.get(name, [0.0, 0.0]), 2)
            for name in ("position", "velocity")
        ),
    )


def _paths(_: Model, run: Run) -> dict[str, Array]:
    return {"mass": run.q}


def _quantities(_: Model, run: Run) -> Sequence[Quantity]:
    late = run.t >= 0.5 * (run.t[0] + run.t[-1])
    q, stuck = run.q[late], run.phase[late, 0] == Phase.STICK
    # A sample has the phase of the time before it; events make samples of unequal distance.
    spans = np.diff(run.t[late])
    extremes = [
        Quantity(f"{word} of q{i + 1} in the second half", "m", float(extreme(q[:, i])))
        for i in range(2)
        for word, extreme in (("smallest", np.min), ("largest", np.max))
    ]
    return [
        *extremes,
        Quantity("share of stick in the second half", "", float(spans @ stuck[1:] / spans.sum())),
    ]


MASS_ON_BELT = Kind(
    name="mass on belt",
    meaning="a mass that springs hold on a moving belt: does it slide steadily, or stick and slip?",
    schema={
        "body": {"mass": NUMBER, "stiffness": NUMBERS, "normal_force": NUMBER},
        "belt": {"velocity": NUMBERS, "speed": NUMBER, "direction_deg": NUMBER},
        "start": {"position": NUMBERS, "velocity": NUMBERS},
    },
    build=_build,
    paths=_paths,
    quantities=_quantities,
    has_end=False,
    example="""\
# A mass that springs hold on a moving belt.
# Lengths are in m, times in s, masses in kg, forces in N. The axes e1, e2 are those of the
# friction law, angles are counter-clockwise from e1.
kind = "mass on belt"
law = "law.toml"            # written by `asperity identify`, or by hand

[body]
mass = 1.0                  # kg
stiffness = 100.0           # N/m, or [[100.0, 0.0], [0.0, 200.0]] along e1 and e2
normal_force = 10.0         # N

[belt]
speed = 0.1                 # m/s
direction_deg = 50.0        # or, instead of both, velocity = [0.064, 0.077]

[start]
position = [0.0, 0.0]       # m, 0 where the springs are relaxed
velocity = [0.0, 0.0]       # m/s

[run]
duration = 20.0             # s
step = 1e-3                 # s

[bands]                     # for --bands: what the uncertainty of the law means for the motion
samples = 100               # laws that are drawn
confidence = 0.95
seed = 1
""",
)
