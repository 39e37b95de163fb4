"""The extended law against its definition, closed forms and finite differences."""

import pickle

import asperity as asp
import numpy as np
import pytest
from samples import (
    CORNERED_LAWS,
    LAWS,
    SMOOTH_LAWS,
    SPACE_LAWS,
    TILTED_ELLIPSES,
    identify,
    random_directions,
)

plane_laws = pytest.mark.parametrize("law", SMOOTH_LAWS, ids=identify)
smooth_laws = pytest.mark.parametrize("law", SMOOTH_LAWS + SPACE_LAWS, ids=identify)


def directions(law, n=40):
    return random_directions(np.random.default_rng(55), n, law.dimension)


@smooth_laws
def test_force_satisfies_the_inclusion(law):
    slip = directions(law)
    x = -law.force(slip)
    np.testing.assert_allclose(law.reservoir.gauge(x), 1.0, rtol=1e-10)
    on_direction = x / law.direction.gauge(x)[:, None]
    normals = law.direction.gauge_gradient(on_direction)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    np.testing.assert_allclose(normals, slip, atol=1e-6)
    # The same without gradients: Fenchel's equality for γ ∈ N_D(−αλ).
    gap = law.direction.fenchel_gap(on_direction, slip, tolerance=1e-9)
    np.testing.assert_allclose(gap, 0.0, atol=1e-10)


@smooth_laws
def test_slip_direction_inverts_force(law):
    slip = directions(law)
    np.testing.assert_allclose(law.slip_direction(law.force(slip)), slip, atol=1e-6)
    assert not law.slip_direction(0.9 * law.force(slip)).any()
    with pytest.raises(asp.ParameterError, match="force"):
        law.slip_direction(1.1 * law.force(slip))


@pytest.mark.parametrize("law", CORNERED_LAWS, ids=identify)
def test_slip_direction_at_a_corner_is_an_element_of_the_normal_cone(law):
    slip = directions(law)
    force = law.force(slip)
    for x, direction in zip(-force, law.slip_direction(force), strict=True):
        cone = law.direction.normal_cone(x / law.direction.gauge(x))
        assert cone.contains(direction)


@smooth_laws
def test_force_is_dry_and_scales_with_the_normal_force(law):
    slip = directions(law)
    np.testing.assert_allclose(law.force(1e-6 * slip), law.force(slip), rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(law.force(slip, normal_force=7.0), 7.0 * law.force(slip), rtol=1e-14)
    normal = np.arange(1.0, 4.0)[:, None]
    assert law.force(slip, normal_force=normal).shape == (3, 40, law.dimension)
    np.testing.assert_array_equal(
        law.force(slip, normal_force=normal)[2], law.force(slip, normal_force=3.0)
    )


@pytest.mark.parametrize("law", LAWS, ids=identify)
def test_dissipation_is_strictly_positive(law):
    """Prop. 5: −λᵀγ = Ψ*_D(γ)/α."""
    slip = directions(law)
    dissipation = law.dissipation(slip, normal_force=2.0)
    np.testing.assert_allclose(
        dissipation, -(law.force(slip, normal_force=2.0) * slip).sum(1), rtol=1e-10
    )
    assert dissipation.min() > 0.0
    x = -law.force(slip)
    alpha = 1 / (law.direction.gauge(x) - law.reservoir.gauge(x) + 1)
    np.testing.assert_allclose(dissipation, 2.0 * law.direction.support(slip) / alpha, rtol=1e-9)


@smooth_laws
def test_jacobian_is_the_derivative_of_the_force(law):
    slip = directions(law)
    jacobian = law.jacobian(slip, normal_force=3.0)
    for j, e in enumerate(1e-6 * np.eye(law.dimension)):
        column = (
            law.force(slip + e, normal_force=3.0) - law.force(slip - e, normal_force=3.0)
        ) / 2e-6
        np.testing.assert_allclose(jacobian[..., j], column, rtol=1e-4, atol=1e-5)
    np.testing.assert_allclose(np.einsum("nij,nj->ni", jacobian, slip), 0.0, atol=1e-8)


@plane_laws
def test_direction_is_the_largest_scale_inside_the_reservoir(law):
    theta = np.linspace(0.0, 2 * np.pi, 20_001)
    ratio = law.direction.radius(theta) / law.reservoir.radius(theta)
    assert ratio.max() == pytest.approx(1.0, abs=1e-4)
    assert ratio.max() <= 1.0 + 1e-9
    assert law.alpha_min == pytest.approx(ratio.min(), rel=1e-4)
    assert law.direction.scale_inside(law.reservoir) == pytest.approx(1.0, rel=1e-9)


def test_scale_of_the_direction_set_does_not_matter():
    reservoir = asp.Ellipse(0.6, 0.2, angle=0.5)
    laws = [asp.FrictionLaw(reservoir, asp.Ellipse(3.0, 1.0).scaled(s)) for s in (1e-6, 1.0, 1e6)]
    slip = [[0.3, 1.0], [-2.0, 0.1]]
    for law in laws:
        np.testing.assert_allclose(law.force(slip), laws[0].force(slip), rtol=1e-12)
        assert asp.FrictionLaw(law.reservoir, law.direction) == law


def test_the_direction_set_is_kept_as_it_was_written(tmp_path):
    reservoir, written = asp.Ellipse(0.6, 0.3), asp.Ellipse(3.0, 1.0)
    law = asp.FrictionLaw(reservoir, written)
    assert repr(law) == "FrictionLaw(Ellipse(0.6, 0.3), Ellipse(3.0, 1.0))"
    assert (law.direction.a, law.direction.b) == pytest.approx((0.6, 0.2))
    law.save(tmp_path / "law.toml")
    copies = pickle.loads(pickle.dumps(law)), asp.FrictionLaw.load(tmp_path / "law.toml")
    for same in (*copies, law.replace(rate=None), law.rotated(0.3).rotated(-0.3)):
        assert repr(same) == repr(law)
    wider = law.replace(reservoir=asp.Ellipse(0.9, 0.3))
    assert repr(wider) == "FrictionLaw(Ellipse(0.9, 0.3), Ellipse(3.0, 1.0))"
    # Its scale makes no other law, and older files hold the largest inside C.
    again = asp.FrictionLaw(reservoir, law.direction)
    assert (again, hash(again)) == (law, hash(law))
    np.testing.assert_array_equal(again.force([1.0, 0.5]), law.force([1.0, 0.5]))
    assert law != asp.FrictionLaw(reservoir, asp.Ellipse(3.0, 1.1))


def test_collinear_law_opposes_sliding_and_associated_law_dissipates_most():
    reservoir = asp.Ellipse(0.6, 0.2)
    slip = directions(TILTED_ELLIPSES)
    force = asp.FrictionLaw.collinear(reservoir).force(slip)
    np.testing.assert_allclose(force[:, 0] * slip[:, 1], force[:, 1] * slip[:, 0], atol=1e-12)
    admissible = reservoir.boundary(5000)
    best = (admissible @ slip.T).max(axis=0)
    np.testing.assert_allclose(
        asp.FrictionLaw.associated(reservoir).dissipation(slip), best, rtol=1e-4
    )


def test_one_and_three_dimensions():
    one_way = asp.FrictionLaw.associated(asp.Interval(-0.2, 0.3))
    np.testing.assert_allclose(one_way.force([[2.0], [-1.0]], normal_force=10.0), [[-3.0], [2.0]])
    drilling = asp.FrictionLaw.isotropic(0.5, dimension=3)
    np.testing.assert_allclose(drilling.force([0.0, 3.0, 4.0]), [0.0, -0.3, -0.4])
    with pytest.raises(asp.DimensionError):
        one_way.rotated(0.1)
    with pytest.raises(asp.DimensionError, match="law: must be planar"):
        drilling.deflection(0.1)


@pytest.mark.parametrize("size", [5.0, 1e100, 1e150])
def test_forces_beyond_the_reservoir_are_refused_by_a_readable_number(size):
    with pytest.raises(asp.ParameterError, match="outside the reservoir, its gauge is") as caught:
        asp.FrictionLaw.isotropic(0.5).slip_direction([size, 0.0], normal_force=1.0)
    assert float(str(caught.value).split()[-1]) == pytest.approx(2.0 * size)
    assert len(str(caught.value)) < 80
