"""Verdicts on sets against brute force over boundary points, with their witnesses."""

import asperity as asp
import numpy as np
import pytest
from samples import (
    ALL_SETS,
    BEAN,
    CONVEX,
    CORNERED,
    PENTAGON,
    STAR_POLYGON,
    identify,
    random_directions,
)

all_sets = pytest.mark.parametrize("star", ALL_SETS, ids=identify)
STRAIGHT = (asp.Rectangle, asp.Box, asp.CappedRectangle, asp.Polygon)


@all_sets
def test_convexity_is_that_of_all_midpoints(star):
    boundary = star.boundary(400 if star.dimension < 3 else 150)
    middle = 0.5 * (boundary[:, None] + boundary[None])
    excess = star.gauge(middle).max() - 1.0
    verdict = star.is_convex
    assert bool(verdict) == (excess <= 1e-9)
    if verdict:
        assert verdict.witness is None
        assert verdict.defect <= verdict.tolerance
    else:
        a, b = verdict.witness
        assert star.contains([a, b], tolerance=1e-9).all()
        assert star.gauge(0.5 * (a + b)) > 1.0
        assert verdict.defect > verdict.tolerance


@all_sets
def test_strict_convexity(star):
    verdict = star.is_strictly_convex
    if not star.is_convex:
        assert not verdict
    if not verdict:
        a, b = verdict.witness
        np.testing.assert_allclose(star.gauge([a, b]), 1.0, rtol=1e-7)
        assert np.linalg.norm(a - b) > 1e-3 * np.linalg.norm(a)
        assert star.gauge(0.5 * (a + b)) > 1.0 - 1e-9
    else:
        assert star.is_convex
        boundary = star.boundary(60)
        distance = np.linalg.norm(boundary[:, None] - boundary[None], axis=-1)
        middle = star.gauge(0.5 * (boundary[:, None] + boundary[None]))
        assert (middle[distance > 0.3 * distance.max()] < 1.0).all()


def has_straight_parts(star):
    """Of the samples, by construction."""
    match star:
        case asp.sets.Mapped():
            return has_straight_parts(star.set)
        case asp.Superellipse():
            return star.exponent == 1.0
        case asp.SupportCurve():
            return star == CORNERED
        case asp.sets.Intersection() | asp.sets.MinkowskiSum():
            return any(has_straight_parts(part) for part in star.sets)
        case _:
            return star.dimension > 1 and isinstance(star, STRAIGHT)


@pytest.mark.parametrize("star", CONVEX, ids=identify)
def test_straight_parts_are_found(star):
    assert bool(star.is_strictly_convex) != has_straight_parts(star)


@all_sets
def test_symmetry(star):
    x = random_directions(np.random.default_rng(3), 500, star.dimension)
    difference = np.abs(star.gauge(-x) / star.gauge(x) - 1.0).max()
    verdict = star.is_symmetric
    assert bool(verdict) == (difference < 1e-9)
    if not verdict:
        (point,) = verdict.witness
        assert star.gauge(point) == pytest.approx(1.0, rel=1e-9)
        assert abs(star.gauge(-point) - 1.0) > 1e-9
    assert star.is_star_shaped


EXACT = [
    (asp.Ellipse(3.0, 1.0), True, True),
    (asp.Rectangle(3.0, 1.0), True, False),
    (asp.Superellipse(3.0, 1.0, 1.0), True, False),
    (asp.Superellipse(3.0, 1.0, 1.01), True, True),
    (asp.Superellipse(3.0, 1.0, 0.99), False, False),
    (asp.CoulombContensou(0.4), True, True),
    (asp.WedgeAsperity(1.2, beta=np.deg2rad(30.0)), True, True),
    (asp.WedgeAsperity(1.2, beta=np.deg2rad(31.0)), False, False),
    (PENTAGON, True, False),
    (STAR_POLYGON, False, False),
    (BEAN, False, False),
]


@pytest.mark.parametrize(("star", "convex", "strictly"), EXACT, ids=identify)
def test_closed_forms_decide_exactly(star, convex, strictly):
    assert star.is_convex.exact
    assert star.is_convex.tolerance == 0.0
    assert bool(star.is_convex) is convex
    assert bool(star.is_strictly_convex) is strictly


def test_convexity_of_a_modulated_disk_switches_where_the_closed_form_says():
    """r = m₀ + m₁ cos kφ is convex iff m₀ ≥ (1 + k²)|m₁|."""
    theta = np.arange(720) * np.pi / 360
    for k in (2, 3, 4):
        critical = 1.0 / (1 + k * k)
        assert asp.PolarCurve(theta, 1.0 + 0.99 * critical * np.cos(k * theta)).is_convex
        assert not asp.PolarCurve(theta, 1.0 + 1.01 * critical * np.cos(k * theta)).is_convex


def test_interval_that_is_nearly_symmetric_is_not():
    verdict = asp.Interval(-1.0, 1.0 + 1e-12).is_symmetric
    assert not verdict
    assert verdict.exact
    assert asp.Interval(-1.0, 1.0).is_symmetric.exact
