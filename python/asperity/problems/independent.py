"""Independent sliders: as many one-contact problems as wanted in one."""

from __future__ import annotations

import numpy as np
from scipy.sparse import bsr_array, csr_array, eye_array

from asperity._base import arrays
from asperity.contact import ContactProblem
from asperity.problems.scene import Laws, plane_laws


def sliders(
    n: int,
    *,
    law: Laws = None,
    coupled: bool = False,
    speed: float = 1.0,
    dt: float = 0.01,
    gravity: float = 9.81,
    seed: int = 0,
) -> ContactProblem:
    """Return n masses of 1 kg on a plane, each with a random velocity along it.

    G has 3 × 3 blocks on its diagonal only and is regular: the solution of an associated law is the
    one of n separate problems. Uncoupled, G = I.

    Args:
        n: number of sliders and contacts.
        law: of dimension 2, one for all or one each; default isotropic with μ = 0.5.
        coupled: whether the inverse masses are random positive definite blocks A Aᵀ + 0.3 I, which
            couple normal and tangential rows.
        speed: standard deviation of each tangential velocity in m/s.
        dt: Δt in s.
        gravity: in m/s²; the normal rows of b are −g Δt.
        seed: of the random numbers; the same seed gives the same problem.

    >>> from asperity import problems
    >>> problems.sliders(1000).free_velocity.shape
    (3000,)
    """
    count = arrays.count(n, "n")
    random = np.random.default_rng(arrays.count(seed, "seed", 0))
    free = arrays.non_negative(speed, "speed") * random.normal(size=(count, 3))
    free[:, 0] = -arrays.positive(dt, "dt") * arrays.number(gravity, "gravity")
    directions = csr_array(eye_array(3 * count))
    mass = directions
    if coupled:
        factors = random.normal(size=(count, 3, 3))
        inverse = factors @ np.swapaxes(factors, 1, 2) + 0.3 * np.eye(3)
        blocks = np.linalg.inv(inverse)
        blocks = 0.5 * (blocks + np.swapaxes(blocks, 1, 2))
        places = np.arange(count)
        mass = csr_array(bsr_array((blocks, places, np.arange(count + 1))))
    return ContactProblem.from_bodies(
        mass, directions=directions, free_velocity=free.ravel(), laws=plane_laws(law, count)
    )
