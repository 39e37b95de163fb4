"""The law of Table 1 of [WL19], its parameters as fits name them, and forces of laws."""

import numpy as np
from asperity import FrictionLaw, Superellipse

TABLE_1 = FrictionLaw(Superellipse(4.99 / 9.3, 4.25 / 9.3, 2.94), Superellipse(1.84, 1.19, 2.51))
TRUTH = {
    "reservoir.a": 4.99 / 9.3,
    "reservoir.b": 4.25 / 9.3,
    "reservoir.exponent": 2.94,
    "reservoir.angle": 0.0,
    "direction.ratio": 1.84 / 1.19,
    "direction.exponent": 2.51,
    "direction.angle": 0.0,
}


def sampled(law, samples=4000, turns=5, noise=0.0, seed=0):
    phi = np.linspace(0.0, turns * 2.0 * np.pi, samples, endpoint=False)
    force = -law.force(np.stack([np.cos(phi), np.sin(phi)], axis=-1))
    return phi, force + noise * np.random.default_rng(seed).normal(size=force.shape)


def turned_law(c_angle=0.1, d_angle=-0.05):
    return FrictionLaw(
        TABLE_1.reservoir.rotated(c_angle), Superellipse(1.84, 1.19, 2.51, angle=d_angle)
    )
