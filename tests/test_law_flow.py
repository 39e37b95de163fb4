"""Laws from flow rules: asperities, tensors, samples."""

import asperity as asp
import numpy as np
import pytest
from asperity import Stribeck
from samples import FOURTH_ORDER, PLANE_LAWS, SMOOTH_LAWS, identify

PHI = 2.0 * np.pi * np.arange(720) / 720 + 0.001
THETA = 2.0 * np.pi * np.arange(1000) / 1000 + 0.0003


CUSPED = PLANE_LAWS[2].reservoir


def unit(angle):
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)


# Asperities


@pytest.mark.parametrize(("mu", "degrees"), [(1.2, 36.0), (0.3, 20.0), (0.5, 60.0), (2.0, 25.0)])
def test_asperity_law_has_the_forces_of_the_springs(mu, degrees):
    """(49) against (50), and tan θ = cos²β tan φ."""
    beta = np.deg2rad(degrees)
    law = asp.FrictionLaw.asperity(mu, beta=beta)
    length = np.hypot(np.cos(PHI), np.cos(beta) * np.sin(PHI))
    c1, c2 = np.cos(PHI) / length, np.cos(beta) * np.sin(PHI) / length
    denominator = np.cos(beta) ** 2 - (mu * c1 * np.sin(beta)) ** 2
    f = np.stack([mu * c1 / denominator, mu * c2 * np.cos(beta) / denominator], -1)
    np.testing.assert_allclose(law.reservoir.gauge(f), 1.0, rtol=1e-12)
    np.testing.assert_allclose(-law.force(unit(PHI)), f, rtol=1e-12, atol=1e-12)
    tangent = np.cos(beta) ** 2 * np.tan(PHI)
    np.testing.assert_allclose(f[:, 1] / f[:, 0], tangent, rtol=1e-9)


@pytest.mark.parametrize("beta", [0.8, (0.2, 0.8), (0.8, 0.2)])
def test_locking_springs_are_refused(beta):
    with pytest.raises(asp.ParameterError, match="beta"):
        asp.FrictionLaw.asperity(1.2, beta=beta)


# Tensors


def test_second_order_tensor_gives_ellipses_with_the_root_of_the_ratio():
    law = asp.FrictionLaw.tensor(np.diag([0.3, 0.1]))
    assert law.reservoir == asp.Ellipse(0.3, 0.1)
    assert law.direction.a / law.direction.b == pytest.approx(np.sqrt(3.0), abs=1e-8)
    np.testing.assert_allclose(law.force(unit(PHI)), -unit(PHI) * [0.3, 0.1], rtol=1e-12)


def test_skew_tensor_has_no_direction_set_and_is_refused_with_its_closure():
    with pytest.raises(asp.ParameterError, match=r"6\.13"):
        asp.FrictionLaw.tensor([[0.3, -0.05], [0.05, 0.1]])
    with pytest.raises(asp.ParameterError, match=r"0\.163"):  # the reciprocal
        asp.FrictionLaw.tensor([[0.3, 0.05], [-0.05, 0.1]])


@pytest.mark.parametrize("tensor", [np.diag([0.3, 0.0]), [[0.1, 0.2], [0.2, 0.1]]])
def test_tensors_that_do_not_dissipate_are_refused(tensor):
    with pytest.raises(asp.ParameterError, match="second_order"):
        asp.FrictionLaw.tensor(tensor)
    with pytest.raises(asp.ParameterError):
        asp.FrictionLaw.from_flow_rule(lambda phi: unit(phi) @ np.array(tensor))


def test_collinear_tensor_function_with_non_convex_reservoir():
    """Fig. 12b with own parameters: μ(φ) = 0.2 + 0.05 cos 4φ."""
    one, none = np.eye(2), np.zeros((2, 2))
    pairs = [(0.2 * one, none), *[(none, none)] * 3, (0.05 * one, none)]
    law = asp.FrictionLaw.tensor_function(pairs)
    by_function = asp.FrictionLaw.tensor_function(
        lambda phi: (0.2 + 0.05 * np.cos(4 * phi))[:, None, None] * np.eye(2)
    )
    np.testing.assert_allclose(
        law.reservoir.radius(THETA), 0.2 + 0.05 * np.cos(4 * THETA), rtol=1e-7
    )
    np.testing.assert_allclose(law.force(unit(PHI)), by_function.force(unit(PHI)), atol=1e-12)
    assert law.is_collinear
    assert not law.reservoir.is_convex
    radius = law.direction.radius(THETA)
    np.testing.assert_allclose(radius, radius.mean(), rtol=1e-9)
    flatter = [(0.2 * one, none), *[(none, none)] * 3, (0.2 / 17.5 * one, none)]
    assert asp.FrictionLaw.tensor_function(flatter).reservoir.is_convex


def test_fourth_order_tensor_with_non_convex_reservoir_and_convex_direction_set():
    """Fig. 12c with own parameters."""
    law = asp.FrictionLaw.tensor(0.2 * np.eye(2), fourth_order=FOURTH_ORDER)
    c, s = np.cos(PHI), np.sin(PHI)
    f1 = 0.2 * c + 0.1 * c**3 - 0.1 * c * s**2
    f2 = 0.2 * s + 0.1 * s**3 - 0.1 * s * c**2
    np.testing.assert_allclose(-law.force(unit(PHI)), np.stack([f1, f2], -1), atol=1e-7)
    assert not law.reservoir.is_convex
    assert law.direction.is_convex
    assert not law.is_collinear


def test_flow_rule_whose_force_turns_back_is_refused_with_the_direction():
    """A fourth-order tensor so strong that θ(φ) falls: no convex D."""
    with pytest.raises(asp.ParameterError) as caught:
        asp.FrictionLaw.tensor(0.2 * np.eye(2), fourth_order=-1.5 * FOURTH_ORDER)
    assert caught.value.argument == "fourth_order"
    assert "convex" in caught.value.message


# Samples


def errors(found, law, theta):
    """Largest relative differences of r_C at some angles and of r_D everywhere."""
    reservoir = found.reservoir.radius(theta) / law.reservoir.radius(theta) - 1
    direction = found.direction.radius(THETA) / law.direction.radius(THETA) - 1
    return np.array([np.abs(reservoir).max(), np.abs(direction).max()])


@pytest.mark.parametrize("law", SMOOTH_LAWS, ids=identify)
def test_exact_samples_return_the_law(law):
    phi = 2.0 * np.pi * np.arange(360) / 360
    found = asp.FrictionLaw.from_samples(phi, -law.force(unit(phi)))
    # Where C has corners or cusps, samples tell nothing about the boundary between them.
    corners = isinstance(law.reservoir, asp.Polygon) or law.reservoir == CUSPED
    theta = phi + law.deflection(phi) if corners else THETA
    assert errors(found, law, theta).max() < 1e-4
    assert found.report.closure == pytest.approx(1.0, abs=1e-4)
    assert found.report.samples == 360
    shuffled = np.random.default_rng(1).permutation(360)
    again = asp.FrictionLaw.from_samples(
        phi[shuffled] - 2 * np.pi * (shuffled % 3), -law.force(unit(phi))[shuffled]
    )
    np.testing.assert_allclose(again.force(unit(PHI)), found.force(unit(PHI)), atol=1e-9)


@pytest.mark.parametrize("law", SMOOTH_LAWS, ids=identify)
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_noisy_samples_return_the_law_within_the_noise(law, seed):
    """Also between the samples, beyond what 36 exact ones leave open there."""
    rng = np.random.default_rng(seed)
    phi = 2.0 * np.pi * np.arange(36) / 36
    exact, noise = -law.force(unit(phi)), 0.01
    force = exact * (1 + noise * rng.normal(size=(36, 2)))
    found = asp.FrictionLaw.from_samples(phi, force)
    resolution = errors(asp.FrictionLaw.from_samples(phi, exact, smoothing=None), law, THETA)
    assert (errors(found, law, THETA) < 6 * noise + 2 * resolution).all()
    if found.report.order is not None:
        size = np.abs(force).max()
        assert 0.2 * noise * size < found.report.noise < 2.0 * noise * size
    assert abs(found.report.closure - 1.0) < 0.1
    assert found.direction.is_convex


@pytest.mark.parametrize("n", [12, 36, 90, 5000])
def test_the_order_of_noisy_samples_has_the_least_cross_validation_error(n, monkeypatch):
    rng = np.random.default_rng(n)
    phi = np.sort(rng.uniform(0.0, 2.0 * np.pi, n)) if n > 40 else 2.0 * np.pi * np.arange(n) / n
    law = asp.FrictionLaw(asp.Superellipse(0.5, 0.4, 2.9), asp.Ellipse(1.8, 1.2))
    force = -law.force(np.stack([np.cos(phi), np.sin(phi)], axis=-1))
    force += 0.01 * rng.normal(size=force.shape)
    # ψ = θ − φ and ln r over φ + ψ/2, by one least-squares fit for each order.
    angle = np.arctan2(force[:, 1], force[:, 0]) - phi
    deflection = np.mod(angle + np.pi, 2.0 * np.pi) - np.pi
    walk = phi + 0.5 * deflection
    values = np.stack([deflection, np.log(np.hypot(*force.T))], axis=-1)
    errors = []
    for order in range(1, max(2, min(60, (n - 1) // 3) + 1)):
        angles = np.multiply.outer(walk, np.arange(1, order + 1))
        waves = np.hstack([np.ones((n, 1)), np.cos(angles), np.sin(angles)])
        rest = values - waves @ np.linalg.lstsq(waves, values, rcond=None)[0]
        errors.append((rest**2).sum() / (n - 1.4 * (2 * order + 1)) ** 2)
    fits, fit = [], np.linalg.lstsq
    monkeypatch.setattr(np.linalg, "lstsq", lambda *a, **k: fits.append(1) or fit(*a, **k))
    report = asp.FrictionLaw.from_samples(phi, force).report
    assert report.order == 1 + int(np.argmin(errors))
    assert len(fits) == 1


def test_defects_beyond_the_tolerance_are_refused():
    phi = 2.0 * np.pi * np.arange(36) / 36
    skew = unit(phi) @ np.array([[0.3, -0.01], [0.01, 0.3]])
    closure = np.exp(2 * np.pi * 0.01 / 0.3)
    loose = asp.FrictionLaw.from_samples(phi, skew, closure_tolerance=0.3)
    found = loose.report.closure
    assert max(found, 1 / found) == pytest.approx(closure, rel=1e-6)
    assert loose.report.repair > 0.0
    with pytest.raises(asp.ParameterError, match=r"force: .*\d\.\d"):
        asp.FrictionLaw.from_samples(phi, skew)


def test_flow_rules_that_cannot_be_resolved_or_called_are_refused_by_name():
    for f in (lambda phi: unit(phi) * [1.0, 1e-8], 3):
        with pytest.raises(asp.ParameterError) as caught:
            asp.FrictionLaw.from_flow_rule(f)
        assert caught.value.argument == "f"


CORNERED = [
    asp.FrictionLaw.associated(asp.Rectangle(0.5, 0.3)),
    asp.FrictionLaw.associated(asp.Rectangle(0.6, 0.2, angle=0.3)),
    asp.FrictionLaw(asp.Ellipse(0.5, 0.3), asp.Rectangle(0.5, 0.3, angle=0.3)),
    asp.FrictionLaw(asp.Ellipse(0.5, 0.3), asp.Rectangle(1.0, 0.03, angle=0.1)),
    asp.FrictionLaw(
        asp.Ellipse(0.5, 0.3), asp.Polygon([[0.7, -0.3], [0.5, 0.4], [-0.2, 0.6], [-0.5, -0.4]])
    ),
    asp.FrictionLaw(asp.Ellipse(0.5, 0.3), asp.Ellipse(0.5, 0.3) + asp.Rectangle(0.5, 0.3)),
    asp.FrictionLaw(asp.Disk(2.7), asp.Polygon([[-0.93, 0.1], [0.76, -0.16], [1.05, -0.02]])),
]
"""Laws whose force jumps."""


@pytest.mark.parametrize("law", CORNERED[:-1], ids=identify)
@pytest.mark.parametrize("shift", [0.0, 0.0123])
def test_exact_samples_of_forces_that_jump_are_met(law, shift):
    phi = 2.0 * np.pi * np.arange(360) / 360 + shift
    force = -law.force(unit(phi))
    found = asp.FrictionLaw.from_samples(phi, force)
    # Beside a jump either force is right.
    near = [-found.force(unit(phi + beside)) for beside in (-2e-5, 0.0, 2e-5)]
    error = np.linalg.norm(near - force, axis=-1).min(axis=0)
    assert error.max() < 0.02 * np.linalg.norm(force, axis=1).max()
    assert found.report.closure == pytest.approx(1.0, abs=2e-3)
    theta = phi + law.deflection(phi)
    np.testing.assert_allclose(
        found.reservoir.radius(theta), law.reservoir.radius(theta), rtol=1e-6
    )


def test_report_is_dropped_with_other_sets_and_kept_by_turning():
    law = asp.FrictionLaw.from_flow_rule(lambda phi: unit(phi) * [0.3, 0.1])
    assert law.report is not None
    assert law.replace(direction=asp.Disk(1.0)).report is None
    assert law.replace(reservoir=asp.Disk(1.0)).report is None
    assert law.rotated(0.3).report == law.report
    assert law.replace(rate=Stribeck(0.1)).report == law.report
