"""Sets of any size, asked about points of any size: right, or refused by name."""

import asperity as asp
import numpy as np
import pytest
from samples import ALL_SETS, CONVEX, PENTAGON, identify, random_directions

# Powers of two, with which nothing is rounded.
MAGNITUDES = [2.0**e for e in (-1074, -1060, -1022, -1000, -665, -500, 500, 665, 1000, 1023)]
SIZES = [2.0**e for e in (-150, -40, 40, 150)]


@pytest.fixture
def rng():
    return np.random.default_rng(12)


def whole(directions, magnitude):
    """Directions whose components no magnitude rounds: whole numbers times the smallest one."""
    grid = np.round(directions * 16.0)
    grid[~grid.any(axis=1), 0] = 16.0
    return grid if magnitude < 1.0 else grid / 16.0


def answer(call, argument):
    """What a method returns; None if it refuses by name, as too large or too small a number."""
    try:
        return np.asarray(call())
    except asp.ParameterError as error:
        if error.argument != argument or "range of numbers" not in str(error):
            raise
        return None


@pytest.mark.parametrize("star", ALL_SETS, ids=identify)
@pytest.mark.parametrize("magnitude", MAGNITUDES)
def test_points_of_any_magnitude(star, magnitude, rng):
    unit = whole(random_directions(rng, 12, star.dimension), magnitude)
    x = unit * magnitude
    with np.errstate(over="ignore"):
        wanted = star.gauge(unit) * magnitude
    found = answer(lambda: star.gauge(x), "x")
    if found is None:
        assert np.isinf(wanted).any()
    else:
        np.testing.assert_allclose(found, wanted, rtol=1e-12, atol=1e-323)
    np.testing.assert_allclose(star.gauge_gradient(x), star.gauge_gradient(unit), rtol=1e-12)
    inside = answer(lambda: star.contains(x), "x")
    assert inside is None or (inside == (magnitude < 1.0)).all()
    cone = star.tangent_cone(x[0])
    assert cone.is_empty == (magnitude > 1.0)
    assert cone.contains(x).all() or magnitude > 1.0


@pytest.mark.parametrize("convex", CONVEX, ids=identify)
@pytest.mark.parametrize("magnitude", MAGNITUDES)
def test_projections_of_any_magnitude(convex, magnitude, rng):
    z = random_directions(rng, 12, convex.dimension) * magnitude
    if magnitude < 1.0:
        np.testing.assert_array_equal(convex.project(z), z)
        assert not convex.normal_cone(z[0]).generators.size
        return
    with pytest.raises(asp.ParameterError, match=r"^z: must be at most 1e80"):
        convex.project(z)
    assert convex.normal_cone(z[0]).is_empty


@pytest.mark.parametrize("star", ALL_SETS, ids=identify)
@pytest.mark.parametrize("size", SIZES)
def test_a_scaled_set_is_the_set_in_other_units(star, size, rng):
    """No tolerance has a unit: what holds for a set holds for it in every unit."""
    twin = star.scaled(size)
    x = random_directions(rng, 12, star.dimension) * star.gauge(np.eye(star.dimension)[0]) ** -1
    np.testing.assert_allclose(twin.gauge(size * x), star.gauge(x), rtol=1e-12)
    # On wide curves a support point is known to half the digits.
    near = {"rtol": 1e-7, "atol": 1e-7 * size * np.abs(x).max()}
    np.testing.assert_allclose(
        twin.gauge_gradient(size * x) * size, star.gauge_gradient(x), rtol=1e-7, atol=1e-7
    )
    for question in ("is_convex", "is_strictly_convex", "is_symmetric", "is_star_shaped"):
        ours, theirs = getattr(twin, question), getattr(star, question)
        assert (bool(ours), ours.exact) == (bool(theirs), theirs.exact), question
    assert len(twin.tangent_cone(size * star.boundary(1)[0]).parts) == len(
        star.tangent_cone(star.boundary(1)[0]).parts
    )
    if not star.is_convex or not star._core.is_convex:
        return
    np.testing.assert_allclose(twin.support(x), size * star.support(x), rtol=1e-12)
    np.testing.assert_allclose(twin.support_point(x), size * star.support_point(x), **near)
    for z in (1.5 * x, 40.0 * x):
        np.testing.assert_allclose(twin.project(size * z), size * star.project(z), **near)


@pytest.mark.parametrize("size", [1e-300, 1e-61, 1e61, 1e300])
@pytest.mark.parametrize(
    ("argument", "make"),
    [
        ("radius", lambda s: asp.Disk(s)),
        ("radius", lambda s: asp.Ball(s)),
        ("a", lambda s: asp.Ellipse(s, 1.0)),
        ("semi_axes", lambda s: asp.Ellipsoid([1.0, s, 1.0])),
        ("b", lambda s: asp.Superellipse(1.0, s, 2.5)),
        ("semi_axes", lambda s: asp.Superellipsoid([1.0, s, 1.0], exponent=2.5)),
        ("lower", lambda s: asp.Interval(-s, 1.0)),
        ("upper", lambda s: asp.Interval(-1.0, s)),
        ("half_widths", lambda s: asp.Box([1.0, s])),
        ("a", lambda s: asp.Rectangle(s, 1.0)),
        ("cap", lambda s: asp.CappedRectangle(1.0, 1.0, cap=s)),
        ("mu", lambda s: asp.CoulombContensou(s)),
        ("vertices", lambda s: asp.Polygon(s * asp.Disk(1.0).boundary(5))),
        ("radius", lambda s: asp.PolarCurve(np.arange(8.0) / 8 * 2 * np.pi, np.full(8, s))),
        ("support", lambda s: asp.SupportCurve(np.arange(8.0) / 8 * 2 * np.pi, np.full(8, s))),
        ("matrix", lambda s: PENTAGON.mapped(np.diag([s, 1.0]))),
    ],
)
def test_sizes_that_no_set_can_have_are_refused_by_name(argument, make, size):
    with pytest.raises(asp.ParameterError) as caught:
        make(size)
    assert caught.value.argument == argument
    assert "1e-60" in str(caught.value)
