"""Sets against closed forms, definitions and SciPy's constrained minimisation."""

import asperity as asp
import numpy as np
import pytest
from samples import ALL_SETS, CONVEX, CONVEX_PLANE, STAR_PLANE, identify, random_directions
from scipy.optimize import minimize

PLANE = CONVEX_PLANE + STAR_PLANE
all_sets = pytest.mark.parametrize("star", ALL_SETS, ids=identify)
convex_sets = pytest.mark.parametrize("convex", CONVEX, ids=identify)


@pytest.fixture
def rng():
    return np.random.default_rng(20190101)


def test_gauges_are_those_of_the_closed_forms(rng):
    x = rng.normal(size=(50, 2))
    turn = np.array([[np.cos(0.7), -np.sin(0.7)], [np.sin(0.7), np.cos(0.7)]])
    local = x @ turn
    np.testing.assert_allclose(asp.Disk(0.4).gauge(x), np.hypot(*x.T) / 0.4, rtol=1e-14)
    np.testing.assert_allclose(
        asp.Ellipse(3.0, 1.0, angle=0.7).gauge(x),
        np.hypot(local[:, 0] / 3, local[:, 1]),
        rtol=1e-13,
    )
    np.testing.assert_allclose(
        asp.Rectangle(3.0, 1.0, angle=0.7).gauge(x), np.abs(local / [3.0, 1.0]).max(1), rtol=1e-13
    )
    for s in (0.5, 1.0, 2.94, 17.0):
        expected = (np.abs(x / [3.0, 2.0]) ** s).sum(1) ** (1 / s)
        np.testing.assert_allclose(asp.Superellipse(3.0, 2.0, s).gauge(x), expected, rtol=1e-12)
    line = rng.normal(size=(50, 1))
    expected = np.where(line > 0, line / 0.3, -line / 0.2)[:, 0]
    np.testing.assert_allclose(asp.Interval(-0.2, 0.3).gauge(line), expected, rtol=1e-14)


def test_from_intercepts_has_the_gauge_of_the_paper(rng):
    x = rng.normal(size=(50, 2))
    ellipse = asp.Ellipse.from_intercepts(2.0, 0.7, -0.9)
    expected = np.sqrt((x[:, 0] / 2) ** 2 + (x[:, 1] / 0.7) ** 2 - 0.9 * x[:, 0] * x[:, 1])
    np.testing.assert_allclose(ellipse.gauge(x), expected, rtol=1e-12)


@all_sets
def test_gauge_is_positively_homogeneous_and_one_on_the_boundary(star, rng):
    x = random_directions(rng, 30, star.dimension)
    factors = 10.0 ** rng.uniform(-12, 12, size=30)
    np.testing.assert_allclose(
        star.gauge(x * factors[:, None]), factors * star.gauge(x), rtol=1e-12
    )
    boundary = star.boundary(64)
    np.testing.assert_allclose(star.gauge(boundary), 1.0, rtol=1e-13)
    assert star.contains(boundary).all()
    assert not star.contains(1.001 * boundary).any()
    assert star.gauge(np.zeros(star.dimension)) == 0.0


@all_sets
def test_gradient_satisfies_euler_and_differences(star, rng):
    x = random_directions(rng, 30, star.dimension)
    gradient = star.gauge_gradient(x)
    np.testing.assert_allclose((gradient * x).sum(1), star.gauge(x), rtol=1e-9)
    step = 1e-6 * random_directions(rng, 30, star.dimension)
    difference = star.gauge(x + step) - star.gauge(x - step)
    np.testing.assert_allclose(difference, 2 * (gradient * step).sum(1), atol=2e-11)


@pytest.mark.parametrize("star", PLANE, ids=identify)
def test_radius_and_boundary_of_planar_sets(star):
    theta = np.linspace(-4.0, 4.0, 12).reshape(3, 4)
    radius = star.radius(theta)
    assert radius.shape == (3, 4)
    points = radius[..., None] * np.stack([np.cos(theta), np.sin(theta)], -1)
    np.testing.assert_allclose(star.gauge(points), 1.0, rtol=1e-13)
    angles = np.unwrap(np.arctan2(*star.boundary(8).T[::-1]))
    np.testing.assert_allclose(angles, np.arange(8) * np.pi / 4, atol=1e-12)


@convex_sets
def test_support_is_the_maximum_over_the_boundary(convex, rng):
    y = 10 * random_directions(rng, 20, convex.dimension)
    boundary = convex.boundary(200_000)
    sampled = (y @ boundary.T).max(axis=1)
    support = convex.support(y)
    assert (support >= sampled - 1e-12 * np.abs(support)).all()
    coarse = 1e-4 if convex.dimension < 3 else 2e-2
    np.testing.assert_allclose(support, sampled, rtol=coarse)
    point = convex.support_point(y)
    np.testing.assert_allclose((point * y).sum(1), support, rtol=1e-13)
    assert convex.contains(point, tolerance=1e-9).all()


@pytest.mark.parametrize(
    "convex", [asp.Disk(0.4), asp.Ellipse(0.5, 2.0, angle=0.7), asp.Superellipse(4.99, 4.25, 2.94)]
)
def test_support_hessian_is_the_derivative_of_the_support_point(convex, rng):
    y = random_directions(rng, 20, 2)
    hessian = convex.support_hessian(y)
    assert hessian.shape == (20, 2, 2)
    np.testing.assert_allclose(np.einsum("nij,nj->ni", hessian, y), 0.0, atol=1e-10)
    for j in range(2):
        step = 1e-6 * np.eye(2)[j]
        column = (convex.support_point(y + step) - convex.support_point(y - step)) / 2e-6
        np.testing.assert_allclose(hessian[:, :, j], column, rtol=1e-5, atol=1e-6)


@convex_sets
def test_projection_satisfies_the_variational_inequality(convex, rng):
    z = 5 * random_directions(rng, 40, convex.dimension) * rng.uniform(0, 2, size=(40, 1))
    x = convex.project(z)
    assert convex.contains(x, tolerance=1e-11).all()
    inside = convex.contains(z)
    np.testing.assert_allclose(x[inside], z[inside], rtol=1e-14, atol=1e-15)
    # (z − x)ᵀ(x* − x) ≤ 0 for all x* in the set, that is h(z − x) ≤ (z − x)ᵀx.
    outward = z - x
    excess = convex.support(outward) - (outward * x).sum(1)
    assert excess.max() <= 1e-11 * max(1.0, np.abs(z).max() ** 2)


@pytest.mark.parametrize("convex", [asp.Ellipse(3.0, 1.0, 0.4), asp.Superellipse(3.0, 1.0, 2.94)])
def test_projection_agrees_with_scipy(convex):
    for z in ([4.0, 1.0], [0.3, -2.0], [-3.5, 0.2]):
        found = minimize(
            lambda x, z=z: ((x - z) ** 2).sum(),
            np.array(z) / convex.gauge(z),
            jac=lambda x, z=z: 2 * (x - z),
            constraints={"type": "ineq", "fun": lambda x: 1 - convex.gauge(x)},
            method="SLSQP",
            options={"ftol": 1e-15, "maxiter": 500},
        )
        np.testing.assert_allclose(convex.project(z), found.x, atol=1e-6)


@pytest.mark.parametrize("ratio", [1e4, 1e8])
def test_extreme_shapes_and_distances(ratio):
    thin = asp.Ellipse(ratio, 1.0)
    for z in ([1e12, 1e12], [0.0, 1e12], [1e12, 0.0], [ratio, 1e-3], [0.5 * ratio, 5.0]):
        x = thin.project(z)
        assert abs(thin.gauge(x) - 1.0) < 1e-11
        outward = np.array(z) - x
        cosine = (
            outward
            @ thin.gauge_gradient(x)
            / (np.linalg.norm(outward) * np.linalg.norm(thin.gauge_gradient(x)))
        )
        assert cosine == pytest.approx(1.0, abs=1e-6)
    steep = asp.Superellipse(2.0, 1.0, 1e3)
    np.testing.assert_allclose(steep.gauge([4.0, 0.5]), 2.0, rtol=1e-12)
    np.testing.assert_allclose(steep.project([1e6, 0.0]), [2.0, 0.0], atol=1e-9)


def test_normal_cones():
    rectangle = asp.Rectangle(2.0, 1.0)
    corner = rectangle.normal_cone([2.0, 1.0])
    assert sorted(corner.tolist()) == [[0.0, 1.0], [1.0, 0.0]]
    assert rectangle.normal_cone([2.0, 0.3]).tolist() == [[1.0, 0.0]]
    assert rectangle.normal_cone([0.0, 0.0]).shape == (0, 2)
    assert rectangle.normal_cone([2.1, 0.0]) is None
    ellipse = asp.Ellipse(3.0, 1.0)
    (normal,) = ellipse.normal_cone(ellipse.support_point([1.0, 2.0]))
    np.testing.assert_allclose(normal, np.array([1.0, 2.0]) / np.sqrt(5.0), rtol=1e-12)


@all_sets
def test_scaled_and_mapped_sets(star, rng):
    x = random_directions(rng, 20, star.dimension)
    np.testing.assert_allclose(star.scaled(2.5).gauge(x), star.gauge(x) / 2.5, rtol=1e-12)
    matrix = np.eye(star.dimension) + 0.3 * rng.normal(size=(star.dimension, star.dimension))
    np.testing.assert_allclose(star.mapped(matrix).gauge(x @ matrix.T), star.gauge(x), rtol=1e-10)


@pytest.mark.parametrize("star", PLANE, ids=identify)
def test_rotated_sets(star):
    theta = np.linspace(0.1, 6.0, 25)
    np.testing.assert_allclose(
        star.rotated(0.8).radius(theta + 0.8), star.radius(theta), rtol=1e-11
    )


def test_classes_are_kept_where_the_shape_allows():
    assert asp.Ellipse(3.0, 1.0).rotated(0.2).scaled(2.0) == asp.Ellipse(6.0, 2.0, angle=0.2)
    assert asp.Disk(1.0).rotated(0.2) == asp.Disk(1.0)
    assert isinstance(asp.Box([1.0, 2.0]).rotated(0.2), asp.Mapped)
    twice = asp.Box([1.0, 2.0]).mapped([[2.0, 0.0], [0.0, 1.0]]).mapped([[1.0, 0.0], [0.0, 3.0]])
    assert twice == asp.Mapped(asp.Box([1.0, 2.0]), [[2.0, 0.0], [0.0, 3.0]])


@all_sets
def test_methods_broadcast(star):
    p = star.dimension
    x = np.linspace(0.1, 1.0, 6 * p).reshape(2, 3, p)
    assert star.gauge(x).shape == (2, 3)
    assert star.gauge_gradient(x).shape == (2, 3, p)
    assert star.contains(x).shape == (2, 3)
    assert star.gauge(np.empty((0, p))).shape == (0,)
    assert np.ndim(star.gauge(x[0, 0])) == 0
    np.testing.assert_array_equal(star.gauge(x)[1, 2], star.gauge(x[1, 2]))


@pytest.mark.parametrize("star", STAR_PLANE, ids=identify)
@pytest.mark.parametrize("method", ["support", "support_point", "support_hessian", "project"])
def test_convex_methods_refuse_star_shaped_sets(star, method):
    assert not star.is_convex
    with pytest.raises(asp.ParameterError, match="set: must be convex"):
        getattr(star, method)([1.0, 1.0])
