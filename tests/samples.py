"""Sets, laws and contact problems that several test files share."""

import inspect

import asperity as asp
import numpy as np

ANGLES = np.arange(60) * np.pi / 30
TURN = np.arange(24) * np.pi / 12

PENTAGON = asp.Polygon([[1.5, -0.4], [1.2, 0.9], [-0.3, 1.1], [-1.0, 0.1], [-0.2, -1.0]])
STAR_POLYGON = asp.Polygon([[2.0, 0.0], [0.5, 0.4], [0.0, 1.5], [-1.0, 0.1], [0.1, -1.2]])
EGG = asp.SupportCurve(TURN, 1.0 + 0.2 * np.cos(TURN) + 0.05 * np.cos(3 * TURN))
BEAN = asp.PolarCurve(ANGLES, 0.2 + 0.05 * np.cos(4 * ANGLES))
ROUND = asp.PolarCurve(ANGLES[::-1], asp.Superellipse(0.6, 0.4, 2.4).radius(ANGLES[::-1]))
EIGHTHS = np.arange(8) * np.pi / 4
CORNERED = asp.SupportCurve(
    EIGHTHS,
    asp.Rectangle(2.0, 1.0).support(np.stack([np.cos(EIGHTHS), np.sin(EIGHTHS)], axis=-1)),
)
"""A support curve with corners."""
DOTTED = asp.Polygon(asp.Rectangle(2.0, 1.0, angle=0.2).boundary(24))
"""A polygon with points on its edges."""
UNEVEN = asp.PolarCurve(
    ANGLES + 0.8 * np.sin(ANGLES), asp.Ellipse(0.5, 0.3).radius(ANGLES + 0.8 * np.sin(ANGLES))
)

# Columns of lengths whose squares are whole numbers, so that they are orthonormal to rounding.
SLANTED = np.array([[2.0, -2.0, 1.0], [1.0, 2.0, 2.0], [-2.0, -1.0, 2.0]]) / 3.0

CONVEX_PLANE = [
    asp.Disk(0.4),
    asp.Ellipse(3.0, 1.0),
    asp.Ellipse(0.5, 2.0, angle=0.7),
    asp.Ellipse.from_intercepts(2.0, 1.0, 0.6),
    asp.Ellipsoid([0.3, 0.8]),
    asp.Rectangle(2.0, 1.0),
    asp.Rectangle(0.3, 1.2, angle=-0.4),
    asp.Box([1.5, 0.5]),
    asp.CappedRectangle(0.3, 0.1, cap=0.2),
    asp.CappedRectangle(0.5, 1.2, cap=0.9, angle=2.0),
    asp.Superellipse(3.0, 1.0, 1.0),
    asp.Superellipse(4.99, 4.25, 2.94),
    asp.Superellipse(1.0, 2.0, 1.3, angle=1.1),
    asp.Superellipse(1.0, 2.0, 20.0),
    asp.WedgeAsperity(0.5, beta=0.6),
    asp.WedgeAsperity(1.0, beta=0.3, angle=0.4),
    PENTAGON,
    EGG,
    ROUND,
    CORNERED,
    DOTTED,
    UNEVEN,
    asp.sets.Mapped(asp.Superellipse(1.0, 0.5, 3.0), [[1.0, 0.4], [-0.2, 0.8]]),
    asp.sets.Mapped(EGG, [[1.0, 0.2], [0.3, 0.5]]),
    asp.Ball(1.5, dimension=2),
    asp.Disk(1.0) & asp.Rectangle(0.8, 2.0),
    asp.Ellipse(3.0, 1.0) & asp.Ellipse(1.0, 3.0, angle=0.3) & PENTAGON.scaled(1.2),
    asp.Rectangle(2.0, 1.0) + asp.Disk(0.5),
    asp.Ellipse(1.0, 0.3, angle=0.5) + PENTAGON + EGG,
]
STAR_PLANE = [
    asp.Superellipse(2.0, 1.0, 0.5),
    asp.Superellipse(1.0, 1.0, 0.8, angle=0.3),
    asp.WedgeAsperity(1.2, beta=np.deg2rad(36.0)),
    asp.WedgeAsperity(0.9, beta=0.7, angle=-1.0),
    STAR_POLYGON,
    BEAN,
    asp.sets.Mapped(BEAN, [[2.0, 0.0], [1.0, 1.0]]),
    asp.Ellipse(3.0, 1.0) | asp.Ellipse(1.0, 3.0),
    STAR_POLYGON | asp.Disk(0.7),
    STAR_POLYGON & asp.Disk(0.9),
]
LINE = [
    asp.Interval(-0.2, 0.3),
    asp.Box([0.7]),
    asp.Ball(0.4, dimension=1),
    asp.Ellipsoid([0.6]),
    asp.Interval(-0.2, 0.3) & asp.Interval(-0.4, 0.1),
    asp.Interval(-0.2, 0.3) + asp.Interval(-0.4, 0.1),
]
SPACE = [
    asp.Ball(2.0),
    asp.Box([1.0, 2.0, 0.5]),
    asp.Ellipsoid([3.0, 1.0, 2.0]),
    asp.Ellipsoid([0.5, 0.3, 0.8], axes=SLANTED),
    asp.Superellipsoid([1.0, 0.6, 0.4], exponent=3.0),
    asp.Box(lower=[-0.8, -1.2, -0.6], upper=[1.0, 1.6, 0.5]),
    asp.sets.Mapped(asp.Ball(1.0), np.diag([3.0, 1.0, 2.0])),
    asp.CoulombContensou(0.3),
    asp.CoulombContensou(1.5, pressure="uniform"),
    asp.Box([1.0, 2.0, 0.5]) & asp.Ball(1.2),
    asp.Ellipsoid([1.0, 0.4, 0.6]) + asp.CoulombContensou(0.5),
    asp.Box([1.0, 1.0, 1.0]) + asp.Ball(0.5),
]
STAR_SPACE = [
    asp.Superellipsoid([1.0, 0.8, 0.7], exponent=0.9),
    asp.Ellipsoid([3.0, 1.0, 2.0]) | asp.Box([0.5, 1.5, 0.5]),
]

CONVEX = CONVEX_PLANE + LINE + SPACE
PLANE = CONVEX_PLANE + STAR_PLANE
ALL_SETS = CONVEX + STAR_PLANE + STAR_SPACE

SUPERELLIPSES = asp.FrictionLaw(
    asp.Superellipse(0.54, 0.46, 2.94), asp.Superellipse(1.84, 1.19, 2.51)
)
TILTED_ELLIPSES = asp.FrictionLaw(asp.Ellipse(0.6, 0.2, angle=np.pi / 6), asp.Ellipse(3.0, 1.0))

FOURTH_ORDER = np.zeros((2, 2, 2, 2))
FOURTH_ORDER[0, 0, 0, 0] = FOURTH_ORDER[1, 1, 1, 1] = 0.1
FOURTH_ORDER[0, 0, 1, 1] = FOURTH_ORDER[1, 1, 0, 0] = -0.1

PLANE_LAWS = [
    asp.FrictionLaw.isotropic(0.3),
    asp.FrictionLaw.associated(asp.Ellipse(0.6, 0.2)),
    asp.FrictionLaw.collinear(asp.Superellipse(0.5, 0.3, 0.7)),
    TILTED_ELLIPSES,
    SUPERELLIPSES,
    asp.FrictionLaw.collinear(BEAN),
    asp.FrictionLaw(STAR_POLYGON.scaled(0.25), asp.Ellipse(2.0, 1.0)),
    asp.FrictionLaw.asperity(0.3, beta=0.5),
    asp.FrictionLaw.tensor(np.diag([0.3, 0.1])),
]
"""Laws with a smooth strictly convex D, with which all solvers are tested."""

CURVE_LAWS = [
    asp.FrictionLaw.asperity(1.2, beta=np.deg2rad(36.0)),
    asp.FrictionLaw.asperity(0.4, beta=(0.3, 0.6)),
    asp.FrictionLaw.tensor(0.2 * np.eye(2), fourth_order=FOURTH_ORDER),
    asp.FrictionLaw.associated(EGG.scaled(0.3)),
    asp.FrictionLaw(STAR_POLYGON, asp.Ellipse(2.0, 1.0) + EGG),
]
"""Smooth too, with very strong friction or a D that takes longer to solve for."""

SMOOTH_LAWS = PLANE_LAWS + CURVE_LAWS
SPACE_LAWS = [
    asp.FrictionLaw.isotropic(0.2, dimension=3),
    asp.FrictionLaw.associated(asp.CoulombContensou(0.3)),
    asp.FrictionLaw(asp.CoulombContensou(0.3), asp.Ellipsoid([1.0, 1.0, 0.5])),
]
LINE_LAWS = [
    asp.FrictionLaw.isotropic(0.2, dimension=1),
    asp.FrictionLaw.associated(asp.Interval(-0.2, 0.3)),
]
CORNERED_LAWS = [
    asp.FrictionLaw.associated(asp.Rectangle(0.4, 0.2)),
    asp.FrictionLaw(asp.Disk(0.5), PENTAGON),
]
LAWS = SMOOTH_LAWS + SPACE_LAWS + LINE_LAWS + CORNERED_LAWS


def identify(value):
    """Name of a parametrised case."""
    return repr(value)[:60]


def random_directions(rng, n, dimension):
    x = rng.normal(size=(n, dimension))
    return x / np.linalg.norm(x, axis=1)[:, None]


def random_matrix(rng, dimension):
    """Well conditioned."""
    return np.eye(dimension) + 0.3 * rng.normal(size=(dimension, dimension))


def assert_breaks_monotonicity(law, verdict):
    """The witness γ, λ, γ*, λ* consists of two pairs of the law with (γ − γ*)ᵀ(λ − λ*) > 0."""
    assert not verdict
    slip, force, other, other_force = verdict.witness
    assert (slip - other) @ (force - other_force) > 0.0
    for gamma, lam in ((slip, force), (other, other_force)):
        if gamma.any():
            np.testing.assert_allclose(law.force(gamma), lam, atol=1e-9)
        else:
            assert law.reservoir.contains(-lam, tolerance=1e-9)


def random_problem(rng, laws, contacts, unilateral):
    """Contact problem of a random mechanism; `unilateral` holds one truth value per contact."""
    chosen = [laws[i] for i in rng.integers(len(laws), size=contacts)]
    rows = sum(law.dimension + one for law, one in zip(chosen, unilateral, strict=True))
    jacobian = rng.normal(size=(rows, rows + 2))
    return asp.ContactProblem(
        jacobian @ jacobian.T / rows,
        free_velocity=rng.normal(size=rows),
        laws=chosen,
        normal_force=[None if one else rng.uniform(0.2, 2.0) for one in unilateral],
    )


def public_of(module):
    """Return what is public of a module by name, with the results that are in a folder only."""
    listed = getattr(module, "__all__", [n for n in vars(module) if not n.startswith("_")])
    found = {name: getattr(module, name) for name in listed}
    folders = [module]
    if module is asp:
        names = {
            one.__module__.split(".")[1] for one in found.values() if hasattr(one, "__module__")
        }
        folders = [getattr(asp, name) for name in sorted(names & vars(asp).keys())]
    for folder in folders:
        for name, one in vars(folder).items():
            own = inspect.isclass(one) and one.__module__.startswith(folder.__name__)
            if own and not name.startswith("_"):
                found.setdefault(name, one)
    return found
