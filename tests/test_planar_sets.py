"""Planar sets against closed forms; bad shapes are refused with a witness."""

import asperity as asp
import numpy as np
import pytest
from samples import PENTAGON, STAR_POLYGON, identify


@pytest.fixture
def rng():
    return np.random.default_rng(20190104)


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


def test_capped_rectangle_consists_of_a_rectangle_and_two_half_ellipses(rng):
    runner = asp.CappedRectangle(0.3, 0.1, cap=0.2)
    side = rng.uniform(-0.3, 0.3, size=100)
    np.testing.assert_allclose(
        runner.gauge(np.stack([side, np.full(100, 0.1)], -1)), 1.0, rtol=1e-13
    )
    t = rng.uniform(-np.pi / 2, np.pi / 2, size=100)
    cap = np.stack([0.3 + 0.2 * np.cos(t), 0.1 * np.sin(t)], -1)
    np.testing.assert_allclose(runner.gauge(cap), 1.0, rtol=1e-12)
    np.testing.assert_allclose(runner.gauge(-cap), 1.0, rtol=1e-12)
    phi = rng.uniform(0.0, 2.0 * np.pi, size=100)
    normals = np.stack([np.cos(phi), np.sin(phi)], -1)
    # It is the sum of a segment and an ellipse.
    expected = 0.3 * np.abs(np.cos(phi)) + np.hypot(0.2 * np.cos(phi), 0.1 * np.sin(phi))
    np.testing.assert_allclose(runner.support(normals), expected, rtol=1e-12)


RADII = [
    (0, 7.643276410),
    (15, 5.719896099),
    (30, 3.471719339),
    (45, 2.332058637),
    (60, 1.796360109),
    (75, 1.553757994),
    (90, 1.483281573),
]


@pytest.mark.parametrize(("degrees", "radius"), RADII)
def test_wedge_asperity_has_the_radii_of_figure_ten(degrees, radius):
    surface = asp.WedgeAsperity(1.2, beta=np.deg2rad(36.0))
    for quadrant in (degrees, 180 - degrees, 180 + degrees, -degrees):
        assert surface.radius(np.deg2rad(quadrant)) == pytest.approx(radius, abs=1e-9)


@pytest.mark.parametrize("mu", [0.2, 0.7, 1.2, 3.0])
def test_wedge_asperity_has_the_gauge_of_the_paper_and_its_limit_of_convexity(mu, rng):
    """(50); convex for μ tan β ≤ 1/√2."""
    critical = np.arctan(np.sqrt(0.5) / mu)
    below = asp.WedgeAsperity(mu, beta=critical * (1 - 1e-9))
    above = asp.WedgeAsperity(mu, beta=critical * (1 + 1e-9))
    assert below.is_convex
    assert not above.is_convex
    assert below.is_convex.exact
    beta = 0.9 * np.arctan(1 / mu)
    x = rng.normal(size=(200, 2))
    bracket = 1 - (1 + mu**2) * np.sin(beta) ** 2
    expected = (
        np.cos(beta)
        / mu
        * (x[:, 1] ** 2 + bracket * x[:, 0] ** 2)
        / np.sqrt(np.cos(beta) ** 2 * x[:, 0] ** 2 + x[:, 1] ** 2)
    )
    np.testing.assert_allclose(asp.WedgeAsperity(mu, beta=beta).gauge(x), expected, rtol=1e-11)


@pytest.mark.parametrize("polygon", [PENTAGON, STAR_POLYGON], ids=identify)
def test_polygons(polygon, rng):
    v = polygon.vertices
    np.testing.assert_allclose(polygon.gauge(v), 1.0, rtol=1e-14)
    ends = np.roll(v, -1, axis=0)
    share = rng.uniform(0, 1, size=(20, 1, 1))
    np.testing.assert_allclose(polygon.gauge(share * v + (1 - share) * ends), 1.0, rtol=1e-12)
    np.testing.assert_array_equal(asp.Polygon(v[::-1]).gauge(v), polygon.gauge(v))
    assert asp.Polygon(np.roll(v, 2, axis=0)).radius(1.0) == polygon.radius(1.0)


SMOOTH = [asp.Ellipse(3.0, 2.0, angle=0.4), asp.Disk(0.3), asp.WedgeAsperity(0.5, beta=0.5)]


@pytest.mark.parametrize("original", SMOOTH, ids=identify)
def test_curves_reproduce_smooth_sets(original, rng):
    """Through n samples, up to an error that falls with n⁻⁴."""
    angle = rng.uniform(0.0, 2.0 * np.pi, size=300)
    normals = np.stack([np.cos(angle), np.sin(angle)], -1)
    errors = {"radius": [], "support": []}
    for n in (60, 120):
        samples = 2.0 * np.pi * np.arange(n) / n - 1.0
        at = np.stack([np.cos(samples), np.sin(samples)], -1)
        polar = asp.PolarCurve(samples, original.radius(samples))
        dual = asp.SupportCurve(samples, original.support(at))
        np.testing.assert_allclose(polar.radius(samples), original.radius(samples), rtol=1e-13)
        np.testing.assert_allclose(dual.support(at), original.support(at), rtol=1e-13)
        assert polar.is_convex
        assert dual.is_convex
        errors["radius"].append(np.abs(polar.radius(angle) / original.radius(angle) - 1).max())
        h = original.support(normals)
        errors["support"].append(np.abs(dual.support(normals) / h - 1).max())
    for coarse, fine in errors.values():
        assert fine < 1e-5
        assert fine < coarse / 8 or fine < 1e-12


def test_convex_data_give_convex_curves(rng):
    """Samples of random polygons, whose corners a plain spline would overshoot."""
    for _ in range(200):
        polar = np.sort(rng.uniform(0.0, 2.0 * np.pi, size=12))
        hull = np.stack([np.cos(polar), np.sin(polar)], -1) * rng.uniform(0.5, 2.0, size=2)
        if np.diff([*polar, polar[0] + 2 * np.pi]).max() > 0.45 * np.pi:
            continue
        polygon = asp.Polygon(hull)
        theta = np.concatenate([np.arctan2(hull[:, 1], hull[:, 0]), polar + 0.013])
        if np.diff(np.sort(np.mod(theta, 2 * np.pi))).min() < 1e-3:
            continue
        curve = asp.PolarCurve(theta, polygon.radius(theta))
        assert curve.is_convex
        assert curve.is_convex.exact
        points = curve.boundary(400)
        middle = 0.5 * (points[:, None] + points[None])
        assert curve.gauge(middle).max() <= 1.0 + 1e-9
        np.testing.assert_allclose(curve.radius(theta), polygon.radius(theta), rtol=1e-9)


def test_curves_are_twice_continuously_differentiable():
    """The curvature of the support curve's boundary, (h + h″)⁻¹, does not jump at the samples."""
    phi = np.arange(9) * 2 * np.pi / 9
    curve = asp.SupportCurve(phi, 1.0 + 0.1 * np.sin(2 * phi))
    for angle in phi:
        beside = angle + np.array([-1e-7, 1e-7])
        sides = np.stack([np.cos(beside), np.sin(beside)], -1)
        left, right = curve.support_hessian(sides)
        np.testing.assert_allclose(left, right, atol=1e-5)


SQUARE = [[1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]]
BAD_OUTLINES = {
    "origin outside": [[1.0, 1.0], [3.0, 1.0], [2.0, 2.0]],
    "origin on an edge": [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0]],
    "origin at a corner": [[0.0, 0.0], [2.0, -1.0], [2.0, 1.0]],
    "hidden bay": [[2.0, -1.0], [2.0, 2.0], [1.0, 2.0], [1.5, 0.5], [-1.0, 1.0], [-1.0, -1.0]],
    "crossing": [[1.0, -1.0], [-1.0, 1.0], [1.0, 1.0], [-1.0, -1.0]],
    "wound twice": SQUARE + [[0.5 * x, 0.5 * y] for x, y in SQUARE],
}


@pytest.mark.parametrize("outline", BAD_OUTLINES.values(), ids=BAD_OUTLINES.keys())
def test_bad_polygons_are_refused_with_a_witness(outline):
    with pytest.raises(asp.ParameterError, match=r"vertices: .*\(-?[\d.e-]+, -?[\d.e-]+\)"):
        asp.Polygon(outline)
    verdict = asp.star_shape(outline)
    assert not verdict
    assert verdict.witness.shape == (1, 2)
    assert not asp.star_shape(outline[::-1])


def test_witness_of_a_hidden_bay_cannot_be_seen_from_the_origin():
    outline = np.array(BAD_OUTLINES["hidden bay"])
    (point,) = asp.star_shape(outline).witness
    following = np.roll(outline, -1, axis=0)
    # It lies on an edge that is walked backwards as seen from the origin.
    turn = outline[:, 0] * following[:, 1] - outline[:, 1] * following[:, 0]
    detour = (
        np.linalg.norm(point - outline, axis=1)
        + np.linalg.norm(point - following, axis=1)
        - np.linalg.norm(outline - following, axis=1)
    )
    assert detour[turn <= 0.0].min() == pytest.approx(0.0, abs=1e-12)


def test_support_samples_of_no_convex_set_are_refused_with_the_direction():
    phi = np.arange(12) * np.pi / 6
    support = 1.0 + 0.4 * np.cos(2 * phi)
    # h + h″ = 1 − 1.2 cos 2φ is negative around φ = 0 and π.
    with pytest.raises(asp.ParameterError, match=r"convex.* rad"):
        asp.SupportCurve(phi, support)
    asp.SupportCurve(phi, 1.0 + 0.2 * np.cos(2 * phi))
