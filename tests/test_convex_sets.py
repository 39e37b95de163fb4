"""Properties of every convex set: support function, polarity, projection, rule (9)."""

import asperity as asp
import numpy as np
import pytest
from samples import CONVEX, EGG, identify, random_directions, random_matrix
from scipy.optimize import minimize

CASES = 1000


def is_iterative(convex):
    """Whether each projection takes a search in space."""
    return convex.dimension == 3 and isinstance(convex, asp.sets.Intersection)


convex_sets = pytest.mark.parametrize("convex", CONVEX, ids=identify)


@pytest.fixture
def rng():
    return np.random.default_rng(20190102)


@convex_sets
def test_support_is_the_maximum_over_the_boundary(convex, rng):
    y = 10 * random_directions(rng, 20, convex.dimension)
    boundary = convex.boundary(100_000)
    sampled = (y @ boundary.T).max(axis=1)
    support = convex.support(y)
    assert (support >= sampled - 1e-12 * np.abs(support)).all()
    coarse = 1e-4 if convex.dimension < 3 else 2e-2
    np.testing.assert_allclose(support, sampled, rtol=coarse)
    point = convex.support_point(y)
    np.testing.assert_allclose((point * y).sum(1), support, rtol=1e-12)
    assert convex.contains(point, tolerance=1e-9).all()


@convex_sets
def test_gauge_and_support_are_polar(convex, rng):
    """xᵀy ≤ k(x) Ψ*(y), with equality for some x given y and for some y given x."""
    x, y = (random_directions(rng, CASES, convex.dimension) for _ in range(2))
    product = convex.gauge(x) * convex.support(y)
    assert ((x * y).sum(1) <= product * (1 + 1e-11)).all()
    np.testing.assert_allclose(convex.gauge(convex.support_point(y)), 1.0, rtol=1e-7)
    boundary = x / convex.gauge(x)[:, None]
    np.testing.assert_allclose(convex.support(convex.gauge_gradient(boundary)), 1.0, rtol=1e-8)


@convex_sets
def test_support_hessian_is_the_derivative_of_the_support_point(convex, rng):
    y = random_directions(rng, 200, convex.dimension)
    hessian = convex.support_hessian(y)
    p = convex.dimension
    assert hessian.shape == (200, p, p)
    ahead, behind = (convex.support_hessian(y * factor) for factor in (0.5, 2.0))
    np.testing.assert_allclose(ahead, 4 * behind, rtol=1e-8, atol=1e-9)
    step = 1e-6
    columns = [
        (convex.support_point(y + step * e) - convex.support_point(y - step * e)) / (2 * step)
        for e in np.eye(p)
    ]
    difference = np.stack(columns, axis=-1)
    scale = 1.0 + np.abs(hessian).max(axis=(1, 2))
    # Next to corners and flats the difference quotient spans two pieces of the boundary.
    with np.errstate(invalid="ignore"):
        error = np.abs(hessian - difference).max(axis=(1, 2)) / scale
    rounding = 1e-2 if is_iterative(convex) else 1e-4
    assert (error < rounding).mean() > 0.97
    finite = np.isfinite(hessian).all(axis=(1, 2))
    along = np.einsum("nij,nj->ni", hessian[finite], y[finite])
    np.testing.assert_allclose(
        along / scale[finite, None], 0.0, atol=2e-3 if is_iterative(convex) else 1e-9
    )


@convex_sets
def test_projection_satisfies_the_variational_inequality(convex, rng):
    cases = 40 if is_iterative(convex) else CASES
    reach = 10.0 ** rng.uniform(-2, 2, size=(cases, 1))
    z = random_directions(rng, cases, convex.dimension) * reach
    x = convex.project(z)
    assert convex.contains(x, tolerance=1e-7 if convex.dimension == 3 else 1e-10).all()
    inside = convex.contains(z)
    assert inside.any()
    assert not inside.all()
    np.testing.assert_allclose(x[inside], z[inside], rtol=1e-11)
    # (z − x)ᵀ(x* − x) ≤ 0 for all x* in the set, that is h(z − x) ≤ (z − x)ᵀx.
    outward = z - x
    excess = convex.support(outward) - (outward * x).sum(1)
    assert (excess / np.maximum(1.0, reach[:, 0])).max() <= 1e-8


@convex_sets
def test_normals_are_those_whose_prox_does_not_move(convex, rng):
    """y ∈ N_C(x) ⇔ x = prox_C(x + r y), [WL19] (12)."""
    p = convex.dimension
    points, others = (2, 2) if is_iterative(convex) else (20, 10)
    boundary = convex.boundary(60)
    boundary = boundary[rng.permutation(len(boundary))[:points]]
    for x in [*boundary, *convex.support_point(random_directions(rng, points, p))]:
        cone = convex.normal_cone(x, tolerance=1e-7)
        weights = rng.uniform(0, 1, size=(3, len(cone.generators)))
        for y, r in zip(weights @ cone.generators, (1e-3, 1.0, 10.0), strict=True):
            np.testing.assert_allclose(convex.project(x + r * y), x, atol=1e-6)
        for y in random_directions(rng, others, p):
            if cone.distance(y) > 1e-2:
                moved = np.linalg.norm(convex.project(x + y) - x)
                assert moved > 1e-7
    inner = 0.5 * boundary
    for x in inner:
        assert convex.normal_cone(x).generators.shape == (0, p)


@convex_sets
def test_rule_nine_for_linear_maps(convex, rng):
    """y ∈ N_C(A x) ⇔ Aᵀy ∈ N_{A⁻¹C}(x)."""
    p = convex.dimension
    matrix = random_matrix(rng, p)
    preimage = convex.preimage(matrix)
    y = random_directions(rng, CASES, p)
    point = convex.support_point(y)
    x = np.linalg.solve(matrix, point.T).T
    np.testing.assert_allclose(preimage.support(y @ matrix), convex.support(y), rtol=1e-9)
    gap = preimage.fenchel_gap(x, y @ matrix, tolerance=1e-7)
    np.testing.assert_allclose(gap, 0.0, atol=1e-9)
    other = rng.permutation(y)
    np.testing.assert_allclose(
        preimage.fenchel_gap(x, other @ matrix, tolerance=1e-7),
        convex.fenchel_gap(point, other, tolerance=1e-7),
        atol=1e-9,
    )
    for x_one, y_one in zip(x[:20], y[:20], strict=True):
        cone = preimage.normal_cone(x_one, tolerance=1e-7)
        assert cone.contains(matrix.T @ y_one, tolerance=1e-4)


SMOOTH = [
    asp.Ellipse(3.0, 1.0, angle=0.4),
    asp.Superellipse(3.0, 1.0, 2.94),
    asp.CappedRectangle(2.0, 1.0, cap=0.7),
    asp.WedgeAsperity(0.5, beta=0.6),
    EGG,
    asp.Ellipse(1.0, 0.3) + EGG,
    asp.Ellipsoid([2.0, 1.0, 1.5]),
    asp.CoulombContensou(1.5),
]


@pytest.mark.parametrize("convex", SMOOTH, ids=identify)
def test_projection_agrees_with_scipy(convex):
    for z in ([4.0, 1.0, 2.0], [0.3, -2.0, 0.5], [-3.5, 0.2, -1.0]):
        z = np.array(z[: convex.dimension])
        found = minimize(
            lambda x, z=z: ((x - z) ** 2).sum(),
            z / convex.gauge(z),
            jac=lambda x, z=z: 2 * (x - z),
            constraints={
                "type": "ineq",
                "fun": lambda x: 1 - convex.gauge(x),
                "jac": lambda x: -convex.gauge_gradient(x),
            },
            method="SLSQP",
            options={"ftol": 1e-15, "maxiter": 500},
        )
        np.testing.assert_allclose(convex.project(z), found.x, atol=1e-6)
