"""Properties of every star-shaped set: gauge, boundary, linear images."""

import inspect

import asperity as asp
import numpy as np
import pytest
from samples import (
    ALL_SETS,
    CONVEX,
    PLANE,
    STAR_PLANE,
    STAR_SPACE,
    identify,
    public_of,
    random_directions,
)

CASES = 1000
all_sets = pytest.mark.parametrize("star", ALL_SETS, ids=identify)
planar_sets = pytest.mark.parametrize("star", PLANE, ids=identify)


@pytest.fixture
def rng():
    return np.random.default_rng(20190101)


def test_every_public_set_is_among_the_samples():
    """A class without a sample would escape all properties tested here."""
    public = public_of(asp).values()
    kinds = {kind for kind in public if inspect.isclass(kind) and issubclass(kind, asp.StarSet)}
    assert kinds - {asp.StarSet} == {type(star) for star in ALL_SETS}


@pytest.mark.parametrize(
    "kind", [asp.sets.Intersection, asp.sets.MinkowskiSum], ids=lambda kind: kind.__name__
)
def test_combined_sets_are_sampled_in_every_dimension(kind):
    assert {star.dimension for star in ALL_SETS if isinstance(star, kind)} == {1, 2, 3}


@all_sets
def test_gauge_is_positively_homogeneous_and_one_on_the_boundary(star, rng):
    x = random_directions(rng, CASES, star.dimension)
    factors = 10.0 ** rng.uniform(-12, 12, size=CASES)
    np.testing.assert_allclose(
        star.gauge(x * factors[:, None]), factors * star.gauge(x), rtol=1e-12
    )
    boundary = star.boundary(64)
    np.testing.assert_allclose(star.gauge(boundary), 1.0, rtol=1e-12)
    assert star.contains(boundary).all()
    assert not star.contains(1.001 * boundary).any()
    assert star.gauge(np.zeros(star.dimension)) == 0.0


@all_sets
def test_gradient_satisfies_euler_and_differences(star, rng):
    x = random_directions(rng, CASES, star.dimension)
    gradient = star.gauge_gradient(x)
    np.testing.assert_allclose((gradient * x).sum(1), star.gauge(x), rtol=1e-9)
    step = 1e-6 * random_directions(rng, CASES, star.dimension)
    forward, backward = star.gauge_gradient(x + step), star.gauge_gradient(x - step)
    smooth = np.linalg.norm(forward - backward, axis=1) < 1e-3
    assert smooth.mean() > 0.98
    difference = star.gauge(x + step) - star.gauge(x - step)
    slope = 0.5 * ((forward + backward) * step).sum(1)
    np.testing.assert_allclose(difference[smooth], 2 * slope[smooth], atol=5e-13)
    np.testing.assert_allclose(gradient[smooth], forward[smooth], atol=1e-3)


@planar_sets
def test_radius_and_boundary_of_planar_sets(star):
    theta = np.linspace(-4.0, 4.0, 12).reshape(3, 4)
    radius = star.radius(theta)
    assert radius.shape == (3, 4)
    points = radius[..., None] * np.stack([np.cos(theta), np.sin(theta)], -1)
    np.testing.assert_allclose(star.gauge(points), 1.0, rtol=1e-12)
    angles = np.unwrap(np.arctan2(*star.boundary(8).T[::-1]))
    np.testing.assert_allclose(angles, np.arange(8) * np.pi / 4, atol=1e-12)


def test_sets_of_space_are_those_of_their_formulas(rng):
    x = rng.normal(size=(200, 3))
    a = np.array([0.5, 0.3, 0.8])
    axes = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turned = asp.Ellipsoid(a, axes=axes)
    np.testing.assert_allclose(turned.gauge(x), np.linalg.norm(x @ axes / a, axis=1), rtol=1e-13)
    np.testing.assert_allclose(turned.support(x), np.linalg.norm(x @ axes * a, axis=1), rtol=1e-13)
    assert turned == asp.Ellipsoid(a, axes=axes) != asp.Ellipsoid(a)
    assert asp.Ellipsoid(a, axes=np.eye(3)).gauge(x).tolist() == asp.Ellipsoid(a).gauge(x).tolist()
    for s in (0.5, 1.0, 3.0):
        star = asp.Superellipsoid(a, exponent=s)
        expected = (np.abs(x / a) ** s).sum(axis=1) ** (1.0 / s)
        np.testing.assert_allclose(star.gauge(x), expected, rtol=1e-12)
        plane = asp.Superellipsoid(a[:2], exponent=s)
        same = asp.Superellipse(*a[:2], s)
        np.testing.assert_array_equal(plane.gauge(x[:, :2]), same.gauge(x[:, :2]))
    lower, upper = -a, a[::-1]
    box = asp.Box(lower=lower, upper=upper)
    expected = np.maximum(x / upper, x / lower).max(axis=1)
    np.testing.assert_allclose(box.gauge(x), expected, rtol=1e-14)
    np.testing.assert_array_equal(box.project(x), np.clip(x, lower, upper))
    # Friction of a table whose axis resists one sense of sliding more.
    law = asp.FrictionLaw.associated(box)
    np.testing.assert_allclose(law.force([1.0, 0.0, 0.0])[0], -upper[0])
    np.testing.assert_allclose(law.force([-1.0, 0.0, 0.0])[0], -lower[0])
    assert asp.Box(a).lower.tolist() == (-a).tolist()
    assert asp.Box(a).upper.tolist() == a.tolist()


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


@pytest.mark.parametrize("star", STAR_PLANE + STAR_SPACE, ids=identify)
@pytest.mark.parametrize(
    "method", ["support", "support_point", "support_hessian", "project", "normal_cone"]
)
def test_convex_methods_refuse_star_shaped_sets(star, method):
    assert not star.is_convex
    with pytest.raises(asp.ParameterError, match="set: must be convex"):
        getattr(star, method)(np.ones(star.dimension))


def test_convex_samples_are_convex():
    assert all(star.is_convex for star in CONVEX)
