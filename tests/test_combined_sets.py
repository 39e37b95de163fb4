"""Intersection, union and Minkowski sum; the sets of sliding and drilling in R³."""

import asperity as asp
import numpy as np
import pytest
from samples import BEAN, PENTAGON, STAR_POLYGON, random_directions
from scipy.integrate import dblquad

A, B = asp.Ellipse(3.0, 1.0), asp.Rectangle(0.8, 2.0, angle=0.3)


@pytest.fixture
def rng():
    return np.random.default_rng(20190105)


def test_gauges_of_combined_sets_are_largest_and_smallest(rng):
    x = rng.normal(size=(500, 2))
    for one in (A, BEAN, STAR_POLYGON):
        np.testing.assert_array_equal((one & B).gauge(x), np.maximum(one.gauge(x), B.gauge(x)))
        np.testing.assert_array_equal((one | B).gauge(x), np.minimum(one.gauge(x), B.gauge(x)))
    inside = (A & B).contains(x)
    np.testing.assert_array_equal(inside, A.contains(x) & B.contains(x))
    np.testing.assert_array_equal((A | B).contains(x), A.contains(x) | B.contains(x))


def test_support_of_a_sum_is_the_sum_and_of_an_intersection_is_less(rng):
    y = rng.normal(size=(500, 2))
    np.testing.assert_allclose((A + B).support(y), A.support(y) + B.support(y), rtol=1e-13)
    bound = np.minimum(A.support(y), B.support(y))
    assert ((A & B).support(y) <= bound * (1 + 1e-12)).all()
    assert ((A & B).support(y) < 0.99 * bound).any()


def test_sum_holds_exactly_the_sums(rng):
    a, b = (one.boundary(300)[rng.integers(300, size=400)] for one in (A, PENTAGON))
    total = A + PENTAGON
    assert total.contains(a + b, tolerance=1e-11).all()
    y = random_directions(rng, 100, 2)
    farthest = A.support_point(y) + PENTAGON.support_point(y)
    assert not total.contains(farthest * 1.001).any()


def test_projection_onto_an_intersection_is_that_of_alternating_projections(rng):
    """Dykstra's algorithm, which needs the projections onto the parts only."""
    both = A & B & PENTAGON
    parts = (A, B, PENTAGON)
    for z in 3.0 * random_directions(rng, 10, 2):
        x, moved = z, [np.zeros(2)] * 3
        for _ in range(3000):
            for i, part in enumerate(parts):
                start = x + moved[i]
                x = part.project(start)
                moved[i] = start - x
        np.testing.assert_allclose(both.project(z), x, atol=1e-5)


def test_nested_combinations_are_flattened():
    c = asp.Disk(1.0)
    assert (A & B) & c == A & (B & c) == asp.sets.Intersection([A, B, c])
    assert (A | B) | c == asp.sets.Union((A, B, c))
    assert (A + B) + c == asp.sets.MinkowskiSum([A, B, c])
    assert ((A & B) | c).sets == (asp.sets.Intersection([A, B]), c)
    assert repr(c & A) == "Intersection((Disk(1.0), Ellipse(3.0, 1.0)))"


@pytest.mark.parametrize("combine", [asp.sets.Intersection, asp.sets.Union, asp.sets.MinkowskiSum])
def test_bad_parts_are_refused(combine):
    with pytest.raises(asp.DimensionError, match="sets"):
        combine([asp.Disk(1.0), asp.Ball(1.0)])
    with pytest.raises(asp.DimensionError, match="sets"):
        combine([])
    with pytest.raises(asp.ParameterError, match="sets"):
        combine([asp.Disk(1.0), 0.5])


def test_operators_refuse_what_is_no_set_and_what_does_not_fit():
    for operation in (lambda x, y: x & y, lambda x, y: x | y, lambda x, y: x + y):
        with pytest.raises(TypeError):
            operation(A, 1.0)
        with pytest.raises(asp.DimensionError, match="sets"):
            operation(A, asp.Interval(-1.0, 1.0))
    with pytest.raises(asp.ParameterError, match="sets: must be convex"):
        _ = A + BEAN
    with pytest.raises(asp.ParameterError, match="sets: must be convex"):
        _ = (A | B) + A


def test_union_that_happens_to_be_convex_has_no_support_function():
    """Two halves of a rectangle that overlap."""
    left = asp.Polygon([[-2.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-2.0, 1.0]])
    right = asp.Polygon([[-1.0, -1.0], [2.0, -1.0], [2.0, 1.0], [-1.0, 1.0]])
    whole = left | right
    assert whole.is_convex
    assert not whole.is_convex.exact
    with pytest.raises(asp.ParameterError, match=r"set: must be convex .*by sampling only"):
        whole.support([1.0, 0.0])
    with pytest.raises(asp.ParameterError, match="direction: must be convex"):
        asp.FrictionLaw(asp.Disk(1.0), whole)
    asp.FrictionLaw.collinear(whole)


# Coulomb–Contensou, theory of combined sliding and drilling


@pytest.mark.parametrize("u", [1e-6, 0.2, 0.9, 0.999999, 1.000001, 1.5, 30.0, 1e6])
def test_hertz_contact_has_the_closed_form_on_both_sides_of_one(u):
    if u <= 1.0:
        slide = 3 * np.pi / 8 * u * (1 - u**2 / 4)
        drill = 3 * np.pi / 16 * (1 - u**2 + 3 * u**4 / 8)
    else:
        root = np.sqrt(u**2 - 1) * (u**2 + 2) / (4 * u)
        slide = 0.75 * ((u - u**3 / 4) * np.arcsin(1 / u) + root)
        drill = None
    x = asp.CoulombContensou(1.0).support_point([u, 0.0, 1.0])
    # For large u the two terms of the closed form nearly cancel.
    assert x[0] == pytest.approx(slide, abs=1e-9 if u < 100 else 1e-3)
    if drill is not None:
        assert x[2] == pytest.approx(drill, abs=1e-9)


def by_quadrature(slip, drill, pressure):
    """∫ p ‖v + ω × r‖ dA over the unit disk at λ_N = 1, μ = 1."""

    def integrand(angle, r):
        speed = np.hypot(slip - drill * r * np.sin(angle), drill * r * np.cos(angle))
        return pressure(r) * r * speed

    return 2 * dblquad(integrand, 0, 1, -np.pi / 2, np.pi / 2, epsabs=1e-10, epsrel=1e-10)[0]


@pytest.mark.parametrize("u", [0.0, 0.3, 0.95, 1.3])
@pytest.mark.parametrize("pressure", ["hertz", "uniform"])
def test_support_function_is_the_integral_over_the_contact_area(u, pressure):
    density = {
        "hertz": lambda r: 1.5 / np.pi * np.sqrt(max(1 - r * r, 0.0)),
        "uniform": lambda r: 1 / np.pi,
    }[pressure]
    expected = by_quadrature(u, 1.0, density)
    found = asp.CoulombContensou(0.7, pressure=pressure).support([u, 0.0, 1.0])
    assert found == pytest.approx(0.7 * expected, rel=1e-7)
