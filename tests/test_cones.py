"""Tangent cones against their definition, and cones as such against SciPy."""

import asperity as asp
import numpy as np
import pytest
from samples import (
    BEAN,
    CONVEX,
    STAR_PLANE,
    STAR_POLYGON,
    identify,
    random_directions,
)
from scipy.optimize import lsq_linear


@pytest.fixture
def rng():
    return np.random.default_rng(20190103)


@pytest.mark.parametrize("dimension", [1, 2, 3])
@pytest.mark.parametrize("count", [0, 1, 2, 3, 5])
def test_projection_onto_a_cone_is_that_of_nonnegative_least_squares(dimension, count, rng):
    generators = rng.normal(size=(count, dimension))
    cone = asp.sets.Cone([generators], dimension=dimension)
    y = rng.normal(size=(50, dimension))
    expected = np.zeros_like(y)
    if count:
        # SciPy's own function for this does not always end before 1.15.
        options = {"bounds": (0.0, np.inf), "method": "bvls", "tol": 1e-15}
        shares = [lsq_linear(generators.T, one, **options).x for one in y]
        expected = np.array(shares) @ generators
    np.testing.assert_allclose(cone.project(y), expected, atol=1e-9)
    np.testing.assert_allclose(cone.distance(y), np.linalg.norm(y - expected, axis=1), atol=1e-9)
    assert cone.contains(expected, tolerance=1e-7).all()


@pytest.mark.parametrize("dimension", [1, 2, 3])
@pytest.mark.parametrize("count", [0, 1, 2, 3, 5])
def test_moreau_decomposition_into_a_cone_and_its_polar(dimension, count, rng):
    cone = asp.sets.Cone([rng.normal(size=(count, dimension))], dimension=dimension)
    polar = cone.polar()
    y = rng.normal(size=(200, dimension))
    part, rest = cone.project(y), polar.project(y)
    np.testing.assert_allclose(part + rest, y, atol=1e-8)
    np.testing.assert_allclose((part * rest).sum(1), 0.0, atol=1e-8)
    assert (cone.generators @ polar.generators.T <= 1e-9).all()
    np.testing.assert_allclose(polar.polar().distance(part), 0.0, atol=1e-8)


def test_empty_and_trivial_cones():
    empty = asp.sets.Cone([], dimension=2)
    assert empty.is_empty
    assert not empty.contains([0.0, 0.0])
    assert empty.distance([1.0, 0.0]) == np.inf
    assert empty.generators.shape == (0, 2)
    origin = asp.sets.Cone([[]], dimension=2)
    assert not origin.is_empty
    assert origin.contains([[0.0, 0.0], [1e-3, 0.0]]).tolist() == [True, False]
    assert origin.polar().contains(np.random.default_rng(1).normal(size=(20, 2))).all()
    assert asp.sets.Cone([np.eye(2)]) != asp.sets.Cone([np.eye(2)[::-1]])


def points_of(convex, rng):
    """Smooth points, corners, points on flats; with them points inside and outside."""
    p = convex.dimension
    edge = convex.support_point(random_directions(rng, 12, p))
    return [*edge, *convex.boundary(8), *(0.5 * edge[:2])]


@pytest.mark.parametrize("star", [*CONVEX, *STAR_PLANE], ids=identify)
def test_tangent_cone_holds_the_directions_into_the_set(star, rng):
    """A short way from x leads inside for directions deep in the cone, out for those far off it."""
    p = star.dimension
    y = random_directions(rng, 60, p)
    around = y[:, None] + 0.1 * np.vstack([np.eye(p), -np.eye(p)])
    corners = list(star.vertices) if isinstance(star, asp.Polygon) else []
    edge = points_of(star, rng)[:12] if star.is_convex else []
    for x in [*star.boundary(17), *corners, *edge]:
        cone = star.tangent_cone(x, tolerance=1e-7)
        assert cone.contains(-x)
        deep = cone.contains(around, tolerance=1e-12).all(axis=1)
        off = cone.distance(y) > 0.1
        gauge = star.gauge(x + 1e-6 * np.linalg.norm(x) * y) - star.gauge(x)
        assert (gauge[deep] < 0.0).all()
        assert (gauge[off] > 0.0).all()


def test_corners_flats_and_smooth_points():
    rectangle = asp.Rectangle(2.0, 1.0)
    corner = rectangle.normal_cone([2.0, 1.0])
    assert sorted(corner.generators.tolist()) == [[0.0, 1.0], [1.0, 0.0]]
    assert rectangle.normal_cone([2.0, 0.3]).generators.tolist() == [[1.0, 0.0]]
    assert rectangle.normal_cone([0.0, 0.0]).generators.shape == (0, 2)
    assert rectangle.normal_cone([2.1, 0.0]).is_empty
    quarter = rectangle.tangent_cone([2.0, 1.0])
    assert quarter.contains([[-1.0, -1.0], [-1.0, 0.0], [0.0, -1.0]]).all()
    assert not quarter.contains([[1.0, -1.0], [-1.0, 0.1]]).any()
    ellipse = asp.Ellipse(3.0, 1.0)
    (normal,) = ellipse.normal_cone(ellipse.support_point([1.0, 2.0])).generators
    np.testing.assert_allclose(normal, np.array([1.0, 2.0]) / np.sqrt(5.0), rtol=1e-12)
    half = ellipse.tangent_cone([0.0, 1.0])
    assert half.contains([[1.0, 0.0], [-1.0, 0.0], [3.0, -1.0]]).all()
    assert half.distance([0.0, 2.0]) == pytest.approx(2.0)


def test_reentrant_corners_have_tangent_cones_of_more_than_a_half_turn():
    notch = STAR_POLYGON.vertices[1]
    cone = STAR_POLYGON.tangent_cone(notch)
    assert not cone.is_convex
    ahead, behind = STAR_POLYGON.vertices[2] - notch, STAR_POLYGON.vertices[0] - notch
    assert cone.contains([ahead, behind, -notch], tolerance=1e-6).all()
    assert not cone.contains(notch + 0.2 * ahead)
    with pytest.raises(asp.ParameterError, match="cone"):
        cone.polar()
    # In a smooth dent the tangent cone is a half-space, as anywhere on a smooth boundary.
    dent = BEAN.radius(np.pi / 4) * np.array([np.sqrt(0.5), np.sqrt(0.5)])
    smooth = BEAN.tangent_cone(dent, tolerance=1e-9)
    assert smooth.is_convex
    assert smooth.contains([[1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]], tolerance=1e-2).all()
