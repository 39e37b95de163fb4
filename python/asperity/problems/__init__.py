"""Contact problems to try solvers on, from 10 to 10⁵ contacts, and the scenes behind them.

Every function returns the `ContactProblem` of one time step. Its sizes are those of the scene of
the same name; for other sizes, forces or velocities make the scene first:

>>> from asperity import problems
>>> problem = problems.stack(20, push=3.0)
>>> small = problems.scenes.stack(20, half_sizes=(0.05, 0.05, 0.02)).problem(dt=1e-3)
>>> problem.directions.shape == small.directions.shape == (120, 240)
True
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity.contact import ContactProblem
from asperity.problems import scenes
from asperity.problems.independent import sliders
from asperity.problems.scene import GROUND, Laws, Scene

__all__ = [
    "GROUND",
    "Scene",
    "arch",
    "columns",
    "pile",
    "scenes",
    "sliders",
    "stack",
    "table",
    "wall",
]


def stack(
    boxes: int, *, push: float = 0.0, law: Laws = None, dt: float = 0.01, gravity: float = 9.81
) -> ContactProblem:
    """Return a stack of unit cubes of 1 kg on four contacts each, the topmost pushed.

    With μ = 0.5 the box on top slides beyond 4.905 N. G has 12 n rows and rank 6 n: the percussions
    of an interface are not unique, their resultant is.

    Args:
        boxes: their number n, see `scenes.stack`.
        push: force on the topmost box along x in N.
        law: of dimension 2, one for all or one each; default isotropic with μ = 0.5.
        dt: Δt in s.
        gravity: in m/s².

    >>> from asperity import problems
    >>> len(problems.stack(20).laws)
    80
    """
    scene = scenes.stack(boxes)
    return scene.problem(law, force=scene.pushed(-1, push=push), dt=dt, gravity=gravity)


def wall(
    rows: int,
    *,
    columns: int,
    push: float = 0.0,
    law: Laws = None,
    dt: float = 0.01,
    gravity: float = 9.81,
) -> ContactProblem:
    """Return a wall of bricks 2 m × 1 m × 1 m of 1 kg, the one in the middle pushed.

    G has 12 columns (2 rows − 1) rows; its rank is six times the number of bricks.

    Args:
        rows: number of rows.
        columns: bricks in every other row, see `scenes.wall`.
        push: force along x in N on the brick that is half way in the list of bricks.
        law: of dimension 2, one for all or one each; default isotropic with μ = 0.5.
        dt: Δt in s.
        gravity: in m/s².

    >>> from asperity import problems
    >>> len(problems.wall(4, columns=3, push=1.0).laws)
    84
    """
    scene = scenes.wall(rows, columns=columns)
    force = scene.pushed(len(scene.mass) // 2, push=push)
    return scene.problem(law, force=force, dt=dt, gravity=gravity)


def table(
    feet: int | ArrayLike,
    *,
    push: float = 0.0,
    law: Laws = None,
    dt: float = 0.01,
    gravity: float = 9.81,
) -> ContactProblem:
    """Return a disk of 1 kg on many feet, 1 m above the ground, pushed at its centre.

    The rank of G is 3 with one foot, 5 with feet on a line and 6 with all others. All feet share
    one body: G is full, 9 n² numbers, too many for more than some thousand feet.

    Args:
        feet: their number on a circle of 1 m radius, or their places in m, shape ``(n, 2)``.
        push: force along x in N.
        law: of dimension 2, one for all or one each; default isotropic with μ = 0.5.
        dt: Δt in s.
        gravity: in m/s².

    >>> from asperity import problems
    >>> problems.table(4).directions.shape
    (6, 12)
    """
    scene = scenes.table(feet)
    return scene.problem(law, force=scene.pushed(0, push=push), dt=dt, gravity=gravity)


def arch(
    blocks: int, *, push: float = 0.0, law: Laws = None, dt: float = 0.01, gravity: float = 9.81
) -> ContactProblem:
    """Return a semicircular arch of 1 kg voussoirs, 0.15 m thick, pushed near its crown.

    G has 12 (n + 1) rows and rank 6 n.

    Args:
        blocks: number n of voussoirs, see `scenes.arch`.
        push: force along x in N on voussoir n // 2.
        law: of dimension 2, one for all or one each; default isotropic with μ = 0.5.
        dt: Δt in s.
        gravity: in m/s².

    >>> from asperity import problems
    >>> len(problems.arch(9).laws)
    40
    """
    scene = scenes.arch(blocks)
    force = scene.pushed(len(scene.mass) // 2, push=push)
    return scene.problem(law, force=force, dt=dt, gravity=gravity)


def columns(
    n_columns: int,
    *,
    height: int,
    touching: bool = True,
    speed: float = 0.1,
    normal_restitution: ArrayLike = 0.0,
    law: Laws = None,
    dt: float = 0.01,
    gravity: float = 9.81,
    seed: int = 0,
) -> ContactProblem:
    """Return columns of spheres of 1 kg and 1 m diameter that move at random before the step.

    Args:
        n_columns: number of columns, see `scenes.columns`.
        height: spheres in each.
        touching: whether neighbouring columns touch.
        speed: standard deviation of the velocities before the step in m/s, and rad/s.
        normal_restitution: e_N in [0, 1], a number or one per contact.
        law: of dimension 2, one for all or one each; default isotropic with μ = 0.5.
        dt: Δt in s.
        gravity: in m/s².
        seed: of the random numbers; the same seed gives the same problem.

    >>> from asperity import problems
    >>> len(problems.columns(9, height=10).laws)
    210
    """
    scene = scenes.columns(n_columns, height=height, touching=touching)
    velocity = _random(scene, speed, seed)
    return scene.problem(
        law, velocity=velocity, dt=dt, gravity=gravity, normal_restitution=normal_restitution
    )


def pile(
    layers: int,
    *,
    speed: float = 0.0,
    law: Laws = None,
    dt: float = 0.01,
    gravity: float = 9.81,
    seed: int = 0,
) -> ContactProblem:
    """Return a square pyramid of spheres of 1 kg and 1 m diameter.

    Args:
        layers: number of layers, see `scenes.pile`.
        speed: standard deviation of the velocities before the step in m/s, and rad/s.
        law: of dimension 2, one for all or one each; default isotropic with μ = 0.5.
        dt: Δt in s.
        gravity: in m/s².
        seed: of the random numbers; the same seed gives the same problem.

    >>> from asperity import problems
    >>> len(problems.pile(3).laws)
    45
    """
    scene = scenes.pile(layers)
    return scene.problem(law, velocity=_random(scene, speed, seed), dt=dt, gravity=gravity)


def _random(scene: Scene, speed: float, seed: int) -> arrays.Array:
    random = np.random.default_rng(arrays.count(seed, "seed", 0))
    return arrays.non_negative(speed, "speed") * random.normal(size=(len(scene.mass), 6))
