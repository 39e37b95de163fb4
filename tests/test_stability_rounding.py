"""Eigenvalues near the imaginary axis: real growth is seen, rounding is not taken for growth."""

import itertools
from fractions import Fraction

import asperity as asp
import numpy as np
import pytest
import scipy.linalg
from asperity.steady_sliding.linearised.pencil import Pencil
from asperity.steady_sliding.linearised.resolvent import Resolvent

ISOTROPIC = asp.FrictionLaw.isotropic(0.5)


@pytest.mark.parametrize(("v", "v_s"), [(1e-6, 100.0), (1e-8, 1.0), (1e-5, 100.0), (1e-3, 1.0)])
@pytest.mark.parametrize("phi", [0.0, 0.7])
def test_slow_belts_with_falling_friction(v, v_s, phi):
    """Lateral damping μλ_N/v is huge; along the slip it is that of one coordinate, f′(v) μλ_N."""
    law = ISOTROPIC.replace(rate=asp.Stribeck(v_s, ratio=0.5))
    belt = asp.MassOnBelt(
        1.0,
        stiffness=1.0,
        law=law,
        normal_force=1.0,
        belt_velocity=[v * np.cos(phi), v * np.sin(phi)],
    )
    drop = 0.25 / v_s * np.exp(-v / v_s)
    found = asp.stability(belt)
    assert found.kind == "unstable"
    np.testing.assert_allclose(found.growth_rate, 0.5 * drop, rtol=1e-6)
    np.testing.assert_allclose(asp.growth_chart(belt, phi=phi), 0.5 * drop, rtol=1e-6)
    assert found.mechanisms["Stribeck slope"] == 0.0
    # The slow eigenvalue of the lateral motion is not lost beside the fast one.
    slow = found.eigenvalues[2].real
    np.testing.assert_allclose(slow, -v / (0.5 * law.rate(v)), rtol=1e-4 if v > 1e-4 else 1e-7)


@pytest.mark.parametrize(
    ("stiffness", "damping", "growth"),
    [
        (np.eye(2), [-1e-3, 1e6], 5e-4),
        (np.diag([1.0, 1e10]), [-1e-5, 0.0], 5e-6),
        (np.diag([1.0, 1e16]), [-1e-5, 0.0], 5e-6),
        (np.diag([1.0, 1e10]), [0.0, 1e-3], 0.0),
    ],
)
def test_soft_directions_beside_stiff_ones(stiffness, damping, growth):
    found = asp.stability(asp.LinearSystem(np.eye(2), stiffness=stiffness, damping=damping))
    np.testing.assert_allclose(found.growth_rate, growth, rtol=1e-6)
    assert found.kind == ("unstable" if growth else "neutral")


def test_what_errors_hide_is_called_undecided():
    """Turned by an angle, the stiff spring of 1e14 N/m has rounding errors of 0.01 N/m."""
    c, s = np.cos(0.3), np.sin(0.3)
    Q = np.array([[c, -s], [s, c]])
    B = Q @ np.diag([1e12, -1e-6]) @ Q.T
    found = asp.stability(asp.LinearSystem(np.eye(2), stiffness=1.0, damping=0.5 * (B + B.T)))
    assert found.kind == "neutral"
    assert found.reason.startswith("Undecided")
    assert not found.is_defective
    assert "Undecided" not in asp.stability(asp.LinearSystem(np.eye(2), stiffness=1.0)).reason


@pytest.mark.parametrize("size", [2, 3, 4, 5])
def test_jordan_blocks_on_the_axis(size):
    """Rounding scatters their eigenvalues by ε^(1/k), to both sides of the axis."""
    rng = np.random.default_rng(size)
    J = np.eye(size) + np.diag(np.ones(size - 1), 1)
    for _ in range(20):
        Q = np.linalg.qr(rng.normal(size=(size, size)))[0]
        found = asp.stability(asp.LinearSystem(np.eye(size), stiffness=Q @ J @ Q.T))
        assert found.kind == "neutral"
        assert found.growth_rate == 0.0
        assert found.is_defective
        assert "grow like t" in found.reason
        # All modes, and two blocks of one eigenvalue.
        assert not asp.stability(asp.LinearSystem(np.eye(size), stiffness=Q @ Q.T)).is_defective
        shifted = asp.stability(asp.LinearSystem(np.eye(size), stiffness=Q @ J @ Q.T, damping=-0.2))
        assert shifted.kind == "unstable"


def right_half_plane(M, B, K):
    """Number of eigenvalues with a positive real part of two equations, exactly, by Routh."""
    entries = [
        [[Fraction(float(part[i, j])) for part in (K, B, M)] for j in (0, 1)] for i in (0, 1)
    ]
    a = [Fraction(0)] * 5
    for i, b in enumerate(entries[0][0]):
        for j, c in enumerate(entries[1][1]):
            a[i + j] += b * c
    for i, b in enumerate(entries[0][1]):
        for j, c in enumerate(entries[1][0]):
            a[i + j] -= b * c
    third = (a[3] * a[2] - a[4] * a[1]) / a[3]
    column = [a[4], a[3], third, a[1] - a[3] * a[0] / third, a[0]]
    return sum(x * y < 0 for x, y in itertools.pairwise(column))


def test_signs_of_growth_against_exact_ones():
    """Random systems whose entries span many orders: what is called certain is right."""
    rng = np.random.default_rng(31)
    counts = {"certain": 0, "growing": 0, "open": 0}
    for _ in range(500):
        D = np.diag(10.0 ** rng.uniform(-4.0, 4.0, 2))
        roots = rng.normal(size=(2, 2, 2))
        M = np.eye(2) + 0.2 * roots[0] @ roots[0].T
        K = D @ (np.eye(2) + 0.1 * roots[1] @ roots[1].T) @ D
        M, K = 0.5 * (M + M.T), 0.5 * (K + K.T)
        B = D @ rng.normal(size=(2, 2)) * 10.0 ** rng.uniform(-16.0, 0.0)
        found = asp.stability(asp.LinearSystem(M, stiffness=K, damping=B))
        on_axis, real = found.spectrum.on_axis, found.eigenvalues.real
        growing = int((real[~on_axis] > 0.0).sum())
        assert growing <= right_half_plane(M, B, K) <= growing + on_axis.sum()
        counts["growing"] += found.kind == "unstable"
        counts["certain"] += not on_axis.any()
        counts["open"] += bool(on_axis.any())
    assert min(counts.values()) > 20


def test_regular_means_regular_for_all_matrices_within_the_errors():
    """Signs of determinants of real matrices P + F at all corners |F| = E do not differ."""
    rng = np.random.default_rng(32)
    answers = set()
    for _ in range(300):
        P, E = rng.normal(size=(2, 2, 2))
        E = np.abs(E) * 10.0 ** rng.uniform(-2.0, 0.5)
        zero = np.zeros((2, 2))
        at = np.zeros(1, dtype=complex)
        may = Pencil(zero, zero, P).may_be_singular(Pencil(zero, zero, E), at)[0]
        corners = np.array(np.meshgrid(*[[-1.0, 1.0]] * 4)).reshape(4, -1).T.reshape(-1, 2, 2)
        signs = set(np.sign(np.linalg.det(P + corners * E)).tolist())
        assert may or len(signs) == 1
        answers.add((bool(may), len(signs)))
    assert {(False, 1), (True, 2)} <= answers


@pytest.mark.parametrize("rates", [[1.0, 2.0], [1.0, 2.0, 3.0], np.arange(1.0, 9.0)])
def test_equidistant_rates_are_no_multiple_one(rates):
    """Half-way between two eigenvalues another one may be, which does not make them one."""
    found = asp.stability(asp.LinearSystem(np.eye(len(rates)), stiffness=np.square(rates)))
    assert not found.is_defective
    assert found.kind == "neutral"


@pytest.mark.parametrize("seed", range(6))
def test_eigenvectors_decide_as_inverses_do(seed):
    """What may be an eigenvalue: the bounds agree with the inverse wherever they decide."""
    rng = np.random.default_rng(seed)
    n = 7
    K, B = rng.normal(size=(2, n, n))
    if seed % 2:
        # Soft and stiff directions, undamped: eigenvalues on the axis, some of them together.
        scale = np.diag(10.0 ** rng.uniform(-4.0, 4.0, n))
        K, B = scale @ (K @ K.T + np.eye(n)) @ scale, 0.0 * B
    pencil = Pencil(np.eye(n), B, K)
    errors = Pencil(*(1e-9 * np.abs(part) for part in pencil))
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-K, -B]])
    values, left, right = scipy.linalg.eig(A, left=True)
    near = Resolvent(pencil, errors, values, right[:n], left[n:])
    for distance in (0.0, 1e-14, 1e-11, 1e-9, 1e-7, 1e-3, 0.3):
        z = near.values * (1.0 + distance * np.exp(2j * np.pi * rng.uniform(size=2 * n)))
        np.testing.assert_array_equal(near.may_be_singular(z), pencil.may_be_singular(errors, z))
