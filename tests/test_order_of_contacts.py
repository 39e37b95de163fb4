"""Redundant feet: the motion of a box is the same in whatever order its contacts are given."""

from __future__ import annotations

from dataclasses import dataclass

import asperity as asp
import numpy as np
import pytest
from numpy.typing import NDArray

Array = NDArray[np.float64]

GRAVITY = 9.81
TOUCH = 1e-12
KINDS = ("slides", "flat", "tilted", "steps", "flat steps")
"""A box slides, falls flat, falls tilted by `integrate`; slides and falls by `simulate`."""


@dataclass(frozen=True)
class Scene:
    """A low box on four to eight feet, at random in all else."""

    kind: str
    mass: float
    height: float
    feet: Array
    laws: tuple[asp.FrictionLaw, ...]
    plane: asp.Plane
    restitution: float
    position: Array
    orientation: Array
    velocity: Array
    spin: Array

    @classmethod
    def random(cls, kind: str, seed: int) -> Scene:
        rng = np.random.default_rng([seed, KINDS.index(kind)])
        count = int(rng.integers(4, 9))
        angles = (np.arange(count) + rng.uniform(-0.3, 0.3, count)) * 2.0 * np.pi / count
        radii = rng.uniform(0.06, 0.12, count)
        height = rng.uniform(0.005, 0.02)
        feet = np.column_stack([radii * np.cos(angles), radii * np.sin(angles), 0.0 * radii])
        ellipse = asp.Ellipse(*rng.uniform(0.15, 0.5, 2), angle=rng.uniform(0.0, 3.0))
        law = [
            asp.FrictionLaw.isotropic(rng.uniform(0.1, 0.5)),
            asp.FrictionLaw(ellipse, direction=ellipse),
            asp.FrictionLaw(ellipse, direction=asp.Disk(1.0)),
        ][seed % 3]
        falls = "slides" not in kind and kind != "steps"
        tilt = rng.normal(size=2) * (0.01 if kind == "tilted" else 0.0)
        drop = rng.uniform(1e-4, 3e-3) + 0.24 * np.abs(tilt).sum() if falls else -TOUCH
        return cls(
            kind,
            10.0 ** rng.uniform(-1.0, 1.0),
            height,
            feet - [0.0, 0.0, height],
            (law,) * count,
            asp.Plane(velocity=rng.uniform(-0.5, 0.5, 2)) if seed % 2 else asp.Plane(),
            0.5 if falls and seed % 6 > 3 else 0.0,
            np.array([0.0, 0.0, height + drop]),
            np.array([np.sqrt(1.0 - tilt @ tilt), *tilt, 0.0]),
            np.array([*rng.normal(size=2), 0.0]),
            np.array([0.0, 0.0, 8.0 * rng.normal()]),
        )

    def run(self, order: Array) -> asp.Motion | asp.Trajectory:
        body = asp.Body.box(
            self.mass,
            half_sizes=[0.1, 0.1, self.height],
            position=self.position,
            orientation=self.orientation,
            velocity=self.velocity,
            angular_velocity=self.spin,
        )
        pairs = [
            asp.PointPlane(
                0,
                plane=self.plane,
                point=self.feet[i],
                law=self.laws[i],
                normal_restitution=self.restitution,
            )
            for i in order
        ]
        system = asp.RigidBodies([body], pairs=pairs, gravity=(0.0, 0.0, -GRAVITY))
        start = asp.State(system.q0, system.u0)
        if "steps" in self.kind:
            return asp.simulate(system, dt=1e-3, t_end=0.3, start=start)
        return asp.integrate(system, t_end=0.2, start=start, sample_every=0.01)

    def spread(self, orders: int) -> float:
        """Largest difference of positions in m and of the quaternion."""
        rng = np.random.default_rng(1)
        count = len(self.feet)
        first = self.run(np.arange(count)).q
        runs = (self.run(rng.permutation(count)).q for _ in range(orders))
        return max(np.abs(q - first).max() for q in runs)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", [0, 4])
def test_the_order_of_redundant_feet_leaves_the_motion(seed, kind):
    assert Scene.random(kind, seed).spread(3) <= 1e-9


OPEN = pytest.mark.xfail(
    strict=True, reason="2e-6 m in a few of 100 orders of a fall on tilted feet"
)
SCENES = [
    pytest.param(kind, seed, marks=OPEN if (kind, seed) == ("tilted", 3) else ())
    for kind in KINDS
    for seed in range(6)
]


@pytest.mark.long
@pytest.mark.parametrize(("kind", "seed"), SCENES)
def test_a_hundred_orders_of_redundant_feet_leave_the_motion(kind, seed):
    assert Scene.random(kind, seed).spread(100) <= 1e-9
