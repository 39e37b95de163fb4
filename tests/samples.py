"""Sets, laws and contact problems that several test files share."""

import asperity as asp
import numpy as np

CONVEX_PLANE = [
    asp.Disk(0.4),
    asp.Ellipse(3.0, 1.0),
    asp.Ellipse(0.5, 2.0, angle=0.7),
    asp.Ellipse.from_intercepts(2.0, 1.0, 0.6),
    asp.Rectangle(2.0, 1.0),
    asp.Rectangle(0.3, 1.2, angle=-0.4),
    asp.Box([1.5, 0.5]),
    asp.Superellipse(3.0, 1.0, 1.0),
    asp.Superellipse(4.99, 4.25, 2.94),
    asp.Superellipse(1.0, 2.0, 1.3, angle=1.1),
    asp.Superellipse(1.0, 2.0, 20.0),
    asp.Mapped(asp.Superellipse(1.0, 0.5, 3.0), [[1.0, 0.4], [-0.2, 0.8]]),
    asp.Ball(1.5, dimension=2),
]
STAR_PLANE = [asp.Superellipse(2.0, 1.0, 0.5), asp.Superellipse(1.0, 1.0, 0.8, angle=0.3)]
LINE = [asp.Interval(-0.2, 0.3), asp.Box([0.7]), asp.Ball(0.4, dimension=1)]
SPACE = [
    asp.Ball(2.0),
    asp.Box([1.0, 2.0, 0.5]),
    asp.Mapped(asp.Ball(1.0), np.diag([3.0, 1.0, 2.0])),
]

CONVEX = CONVEX_PLANE + LINE + SPACE
ALL_SETS = CONVEX + STAR_PLANE

SUPERELLIPSES = asp.FrictionLaw(
    asp.Superellipse(0.54, 0.46, 2.94), asp.Superellipse(1.84, 1.19, 2.51)
)
TILTED_ELLIPSES = asp.FrictionLaw(asp.Ellipse(0.6, 0.2, angle=np.pi / 6), asp.Ellipse(3.0, 1.0))

PLANE_LAWS = [
    asp.FrictionLaw.isotropic(0.3),
    asp.FrictionLaw.associated(asp.Ellipse(0.6, 0.2)),
    asp.FrictionLaw.collinear(asp.Superellipse(0.5, 0.3, 0.7)),
    TILTED_ELLIPSES,
    SUPERELLIPSES,
]
"""Laws with a smooth strictly convex D."""


def identify(value):
    """Name of a parametrised case."""
    return repr(value)[:60]


def random_directions(rng, n, dimension):
    x = rng.normal(size=(n, dimension))
    return x / np.linalg.norm(x, axis=1)[:, None]


def random_problem(rng, laws, contacts, unilateral):
    """Contact problem of a random mechanism; `unilateral` holds one truth value per contact."""
    chosen = [laws[i] for i in rng.integers(len(laws), size=contacts)]
    rows = sum(law.dimension + one for law, one in zip(chosen, unilateral, strict=True))
    jacobian = rng.normal(size=(rows, rows + 2))
    return asp.ContactProblem(
        jacobian @ jacobian.T / rows,
        rng.normal(size=rows),
        chosen,
        normal_force=[None if one else rng.uniform(0.2, 2.0) for one in unilateral],
    )
