"""What linearisation must refuse: Painlevé's paradox of several contacts, systems with a clock."""

import itertools
import math

import asperity as asp
import numpy as np
import pytest
from asperity.steady_sliding.linearised.painleve import not_keeping_apart

LINE = asp.FrictionLaw.isotropic(1.0, dimension=1)


def coupled(A):
    """A block with the mass matrix A⁻¹ on contacts along all axes but e₁, along which it slides."""
    n = len(A)
    contacts = [
        asp.Contact(LINE, direction=np.eye(n)[0], normal=np.eye(n)[i], velocity=[1.0])
        for i in range(1, n)
    ]
    load = np.append(0.0, -np.ones(n - 1))
    return asp.LinearSystem(np.linalg.inv(A), stiffness=1.0, force=load, contacts=contacts)


def test_painleve_of_two_contacts_together():
    """Each keeps itself from closing, 0.4 > 0, but not both: the determinant is −0.2."""
    A = np.array([[1.0, 0.6, 0.6], [0.6, 1.0, 0.0], [0.6, 0.0, 1.0]])
    with pytest.raises(
        asp.ParameterError, match=r"contacts 0 and 1 together .* Painlevé"
    ) as caught:
        asp.stability(coupled(A))
    assert caught.value.argument == "system"
    A[1:, 0] = A[0, 1:] = 0.2
    assert asp.stability(coupled(A)).kind == "neutral"


def complementary(P, c):
    """Number of sets S with λ ≥ 0 on S, P λ + c ≥ 0 elsewhere, by trying all."""
    m, count = len(P), 0
    for closed in itertools.product([False, True], repeat=m):
        S = np.flatnonzero(closed)
        force = np.zeros(m)
        force[S] = np.linalg.solve(P[np.ix_(S, S)], -c[S])
        count += bool(
            (force[S] >= 0.0).all() and (P @ force + c)[~np.array(closed)].min(initial=1) >= 0
        )
    return count


def test_p_matrices_are_those_with_one_solution():
    """Existence and uniqueness for all c; sets that are named have a minor that is not positive."""
    rng = np.random.default_rng(21)
    answers = {True: 0, False: 0}
    for _ in range(150):
        m = int(rng.integers(1, 5))
        P = np.eye(m) + rng.uniform(0.2, 1.2) * rng.normal(size=(m, m))
        wrong = not_keeping_apart(P)
        counts = {complementary(P, c) for c in rng.normal(size=(200, m))}
        if wrong is None:
            assert counts == {1}
        else:
            assert np.linalg.det(P[np.ix_(wrong, wrong)]) <= 0.0
        answers[wrong is None] += 1
    assert min(answers.values()) > 20


class Clocked(asp.System):
    """A block on a belt; one part depends on time."""

    dof = 1
    contacts = (asp.ContactLaw(LINE, normal_force=0.5),)

    def __init__(self, part):
        self.part = part

    def mass(self, q):
        return np.eye(1)

    def forces(self, t, q, u):
        stiffness = 1.0 + (0.2 * math.sin(3.0 * t) if self.part == "stiffness" else 0.0)
        return -stiffness * q - 0.1 * u + (math.cos(t) if self.part == "forces" else 0.0)

    def direction(self, t, q, contact):
        return np.array([[1.0 + (0.1 * math.sin(t) if self.part == "direction" else 0.0)]])

    def velocity(self, t, q, contact):
        return np.array([-1.0 + (0.5 * math.cos(t) if self.part == "velocity" else 0.0)])


@pytest.mark.parametrize(
    ("part", "said"),
    [
        ("forces", "forces"),
        ("stiffness", "forces"),
        ("direction", "directions W"),
        ("velocity", "velocity χ"),
    ],
)
def test_systems_with_a_clock_are_refused(part, said):
    """Judged at t = 0 alone they would seem to have an equilibrium."""
    steady = asp.equilibrium(Clocked(None))
    assert asp.stability(Clocked(None)).kind == "asymptotically stable"
    for judge in (asp.equilibrium, lambda system: asp.stability(system, equilibrium=steady)):
        with pytest.raises(asp.ParameterError, match=f"depends on time, as its {said}") as caught:
            judge(Clocked(part))
        assert caught.value.argument == "system"


def test_even_friction_is_not_said_to_make_b_nonsymmetric():
    """Isotropic friction damps across γ only: with a circulatory K that can destabilise."""
    law, K = asp.FrictionLaw.isotropic(0.5), [[1.0, 0.3], [-0.05, 1.5]]
    contact = asp.Contact(
        law, direction=np.eye(2), normal_force=1.0, velocity=[math.cos(3.0), math.sin(3.0)]
    )
    found = asp.stability(asp.LinearSystem(np.eye(2), stiffness=K, contacts=[contact]))
    np.testing.assert_allclose(found.skew, 0.0, atol=1e-15)
    assert found.kind == "unstable"
    assert "direction of friction" in found.mechanisms
    assert "makes B nonsymmetric" not in found.reason
    assert "destabilisation by damping" in found.reason
