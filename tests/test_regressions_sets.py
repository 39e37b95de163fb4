"""Sets, cones and verdicts that once went wrong: each case is the smallest that shows the fault."""

import asperity as asp
import numpy as np
import pytest
from samples import CONVEX, CORNERED, DOTTED, identify, random_directions

EVEN = np.arange(8) * np.pi / 4
SPIKE = 2.0 * np.pi * np.arange(360) / 360
NORMALS = np.array([0.5, 1.5, 2.5, 3.6, 4.7, 5.7])
FACE_WITH_POINTS = [[-1, -1], [1, -1], [1, 1], [0.9, 1], [0.8, 1], [-1, 1]]


def unit(angle):
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)


# Projection


@pytest.mark.parametrize("convex", CONVEX, ids=identify)
def test_the_origin_is_its_own_projection(convex):
    np.testing.assert_array_equal(convex.project(np.zeros(convex.dimension)), 0.0)


@pytest.mark.parametrize("convex", CONVEX, ids=identify)
def test_inner_points_are_their_own_projections_to_the_bit(convex):
    rng = np.random.default_rng(11)
    rays = random_directions(rng, 200, convex.dimension)
    z = rays / convex.gauge(rays)[:, None] * rng.uniform(0.0, 0.999, size=(200, 1))
    np.testing.assert_array_equal(convex.project(z), z)


# Curves


@pytest.mark.parametrize(
    ("angle", "radius", "low", "high"),
    [
        (SPIKE, np.where(np.abs(SPIKE - np.pi) < 0.05, 5.0, 0.3), 0.15, 10.1),
        (EVEN, [1, 1, 1, 0.1, 3, 3, 0.1, 1], 0.0, np.inf),
        ([0.0, 1.5, 3.0, 4.5], [1, 50, 50, 1], 0.0, np.inf),
    ],
    ids=["spike", "eight", "four"],
)
def test_curves_through_wild_radii_do_not_swing(angle, radius, low, high):
    curve = asp.PolarCurve(angle, radius)
    found = curve.radius(np.linspace(0.0, 2.0 * np.pi, 10_000))
    assert np.isfinite(found).all()
    assert found.min() > low
    assert found.max() < high
    np.testing.assert_allclose(curve.radius(angle), radius, rtol=1e-9)


def test_support_curve_that_nearly_passes_the_origin_holds_it():
    # The values are those of a disk whose centre is 1.05 radii off, not one of them negative.
    curve = asp.SupportCurve(NORMALS, 1.0 - 1.05 * np.cos(NORMALS))
    gauge = curve.gauge(unit(np.linspace(0.0, 2.0 * np.pi, 10_000)))
    assert np.isfinite(gauge).all()
    assert gauge.min() > 0.0


@pytest.mark.parametrize("seed", range(3))
def test_direction_set_stays_inside_a_ragged_reservoir(seed):
    theta = 2.0 * np.pi * np.arange(720) / 720
    ragged = 1.0 + 0.2 * np.random.default_rng(seed).uniform(size=720)
    law = asp.FrictionLaw(asp.PolarCurve(theta, ragged), asp.Disk(1.0))
    assert law.reservoir.gauge(law.direction.boundary(20_001)).max() < 1.0 + 1e-6


# Polygons


@pytest.mark.parametrize("turn", np.arange(61) * 2.0 * np.pi / 61)
def test_points_on_the_edges_leave_a_polygon_convex(turn):
    for polygon in (DOTTED, asp.Polygon(FACE_WITH_POINTS)):
        assert polygon.is_convex
        assert polygon.rotated(turn).is_convex


def test_support_point_of_a_face_with_points_on_it_is_its_middle():
    np.testing.assert_array_equal(asp.Polygon(FACE_WITH_POINTS).support_point([0.0, 1.0]), [0, 1])


def test_outlines_of_fewer_than_three_points_are_refused():
    for outline in (np.empty((0, 2)), [[1.0, 0.0]]):
        with pytest.raises(asp.ParameterError) as caught:
            asp.star_shape(outline)
        assert caught.value.argument == "vertices"


def test_first_vertex_may_be_repeated_at_the_end():
    square = [[1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]]
    assert asp.star_shape([*square, square[0]])
    closed = asp.Polygon([*square, square[0]])
    theta = np.linspace(0.0, 6.0, 50)
    np.testing.assert_allclose(closed.radius(theta), asp.Polygon(square).radius(theta), rtol=1e-14)


def test_origin_on_an_edge_up_to_rounding_is_the_fault_named():
    outline = [[-0.3, -0.1], [0.6, 0.2], [0.0, 2.0]]
    verdict = asp.star_shape(outline)
    assert not verdict
    np.testing.assert_allclose(verdict.witness, 0.0, atol=1e-15)
    with pytest.raises(asp.ParameterError, match="vertices: must hold the origin in its interior"):
        asp.Polygon(outline)


# Cones


def test_cones_at_the_origin_of_wedges():
    wedges = asp.WedgeAsperity(0.5, 0.6)
    around = unit(np.arange(8) * np.pi / 4)
    normal = wedges.normal_cone([0.0, 0.0])
    assert not normal.is_empty
    assert normal.generators.shape == (0, 2)
    for cone in (wedges.tangent_cone([0.0, 0.0]), asp.WedgeAsperity(1.2, 0.5).tangent_cone([0, 0])):
        assert cone.contains(around, tolerance=0.0).all()


CORNERS = [
    (CORNERED, [2.0, 1.0]),
    (
        (asp.Rectangle(1.0, 1.0) & asp.Rectangle(1.0, 2.0)) + asp.Rectangle(1.0, 1.0),
        [2.0, 2.0],
    ),
]


@pytest.mark.parametrize(("convex", "corner"), CORNERS, ids=["curve", "sum"])
def test_normal_cone_of_a_corner_has_the_normals_of_both_sides(convex, corner):
    cone = convex.normal_cone(corner)
    assert cone.contains(np.eye(2)).all()
    assert not cone.contains(-np.eye(2)).any()


@pytest.mark.parametrize("exponent", [0.5, 0.9, 0.99])
@pytest.mark.parametrize("turn", [0.0, 0.3, 2.0])
def test_tangent_cone_of_a_cusp_is_a_ray(exponent, turn):
    star = asp.Superellipse(1.0, 1.0, exponent).rotated(turn)
    tip = unit(np.array(turn))
    cone = star.tangent_cone(tip)
    assert cone.contains(-tip)
    np.testing.assert_allclose(cone.project(unit(turn + np.pi + 0.1)), -np.cos(0.1) * tip)
    np.testing.assert_allclose(cone.project(tip), 0.0, atol=1e-12)
    assert not cone.contains(unit(turn + np.pi + np.array([-1e-3, 1e-3]))).any()


def test_narrow_cones_hold_what_is_inside():
    cone = asp.Cone([[[1.0, 0.0, 0.0], [1.0, 1e-4, 0.0], [1.0, 0.0, 1e-4]]])
    assert cone.contains([3.0, 1e-4, 1e-4])
    assert not cone.contains([3.0, -1e-4, 1e-4])


def test_cones_refuse_numbers_by_name():
    with pytest.raises(asp.DimensionError) as caught:
        asp.Cone([[[1.0, 0.0]]]).contains(1.0)
    assert caught.value.argument == "y"


# Verdicts and the rest


def test_short_straight_parts_are_found_exactly():
    star = asp.Disk(1.0) + asp.Rectangle(1e-3, 1e-3)
    verdict = star.is_strictly_convex
    assert not verdict
    assert verdict.exact
    a, b = verdict.witness
    assert np.linalg.norm(a - b) > 1e-3
    np.testing.assert_allclose(star.gauge([a, b, 0.5 * (a + b)]), 1.0, rtol=1e-12)


def test_interval_that_is_nearly_symmetric_is_not():
    verdict = asp.Interval(-1.0, 1.0 + 1e-12).is_symmetric
    assert not verdict
    assert verdict.exact
    assert asp.Interval(-1.0, 1.0).is_symmetric.exact


@pytest.mark.parametrize("matrix", [np.diag([2.0, 1.0]), [[2.0, 0.0], [0.7, 1.0]]])
def test_hessian_of_a_mapped_flat_is_infinite(matrix):
    image = asp.Rectangle(2.0, 1.0).mapped(matrix)
    # The normal of the mapped side is A⁻ᵀ e₂.
    hessian = image.support_hessian(np.linalg.solve(np.transpose(matrix), [0.0, 1.0]))
    assert np.isinf(hessian).any()
    assert not np.isnan(hessian).any()


LONG = asp.Polygon(asp.Disk(1.0).boundary(2000))
STAR = asp.Superellipse(1.0, 1.0, 0.5) | LONG
LAW = asp.FrictionLaw.isotropic(0.3)
QUOTES = {
    "support": lambda: STAR.support([1.0, 0.0]),
    "direction": lambda: asp.FrictionLaw(LONG, STAR),
    "sum": lambda: LONG + STAR,
    "dimension of D": lambda: asp.FrictionLaw(asp.Ball(1.0), LONG),
    "dimension of &": lambda: asp.Ball(1.0) & LONG,
    "dimension of outer": lambda: asp.Ball(1.0).scale_inside(LONG),
    "number": lambda: asp.Disk(LONG),
    "point": lambda: LONG.gauge(LONG),
    "f": lambda: asp.FrictionLaw.from_flow_rule(LONG),
    "rate": lambda: asp.FrictionLaw(LONG, LONG, rate=LONG),
    "report": lambda: asp.FrictionLaw(LONG, LONG, report=LONG),
    "other": lambda: LAW.dissipates_at_least(LONG),
    "contact": lambda: asp.Contact(LONG, np.eye(2), normal_force=1.0),
    "problem": lambda: asp.ContactProblem(np.eye(2), [1.0, 0.0], LONG, normal_force=1.0),
    "system": lambda: asp.simulate(LONG, dt=0.1, t_end=1.0),
    "solver": lambda: asp.simulate(
        asp.SlidingPoint(1.0, LAW), dt=0.1, t_end=1.0, u0=[1.0, 0.0], solver=LONG
    ),
}


@pytest.mark.parametrize("mistake", QUOTES.values(), ids=QUOTES.keys())
def test_messages_that_quote_a_set_are_short(mistake):
    with pytest.raises((asp.ParameterError, asp.DimensionError)) as caught:
        mistake()
    # Not in the assertion itself: pytest would quote the message.
    length = len(str(caught.value))
    assert length < 300
