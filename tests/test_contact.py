"""Contact problems against hand calculations and an oracle of another kind."""

import asperity as asp
import numpy as np
import pytest
from asperity import Phase, Status

ISOTROPIC = asp.FrictionLaw.isotropic(0.5)
LINE = asp.FrictionLaw.isotropic(0.5, dimension=1)


def test_rows_come_contact_by_contact():
    problem = asp.ContactProblem(
        np.eye(7), np.zeros(7), [ISOTROPIC, LINE, ISOTROPIC], normal_force=[None, None, 1.0]
    )
    assert problem.row_slices == (slice(0, 3), slice(3, 5), slice(5, 7))
    assert asp.ContactProblem(np.eye(6), np.zeros(6), ISOTROPIC).row_slices == (
        slice(0, 3),
        slice(3, 6),
    )


@pytest.mark.parametrize(
    ("free", "phase", "percussion"),
    [
        ([1.0, 0.2, 0.0], Phase.OPEN, [0.0, 0.0, 0.0]),
        ([-1.0, 0.3, 0.0], Phase.STICK, [1.0, -0.3, 0.0]),
        ([-1.0, 3.0, 4.0], Phase.SLIP, [1.0, -0.3, -0.4]),
    ],
)
def test_unit_delassus(free, phase, percussion):
    problem = asp.ContactProblem(np.eye(3), free, ISOTROPIC)
    solution = problem.solve()
    assert solution.phase.tolist() == [phase]
    np.testing.assert_allclose(solution.percussion, percussion, atol=1e-14)
    np.testing.assert_allclose(solution.velocity, np.array(free) + percussion, atol=1e-14)
    assert solution.converged
    assert not solution.ambiguous
    assert problem.residual(solution.percussion) <= 1e-12 < problem.residual([1.0, 1.0, 1.0])


def test_restitution():
    problem = asp.ContactProblem(
        np.eye(2), [-2.0, 0.0], LINE, normal_restitution=0.5, initial_velocity=[-2.0, 0.0]
    )
    assert problem.solve().velocity[0] == pytest.approx(1.0)
    sliding = asp.ContactProblem(
        np.eye(2),
        [-2.0, 0.1],
        LINE,
        tangential_restitution=1.0,
        initial_velocity=[-2.0, 0.1],
    )
    assert sliding.solve().velocity[1] == pytest.approx(-0.1)


def random_ellipses(rng):
    """Law of two turned ellipses and their matrices Q_C, Q_D with k² = xᵀQx."""
    sets, matrices = [], []
    for _ in range(2):
        a, b, angle = 1.0, rng.uniform(0.1, 0.5), rng.uniform(0.0, np.pi)
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        sets.append(asp.Ellipse(a, b, angle))
        matrices.append(turn @ np.diag([a**-2, b**-2]) @ turn.T)
    return asp.FrictionLaw(*sets), *matrices


def oracle(delassus, free, normal, q_c, q_d):
    """All percussions for ellipses, from the isotropic problem with unsymmetric Delassus matrix.

    In slip |(sI + N Ĝ)⁻¹ b̂| = 1 with s = |γ̂|, a quartic in s.
    """
    root = np.linalg.cholesky(q_c).T
    to_slip = root @ np.linalg.inv(q_d)
    g, b = to_slip @ delassus @ np.linalg.inv(root), to_slip @ free
    found = []
    stick = -np.linalg.solve(delassus, free)
    if stick @ q_c @ stick <= normal**2:
        found.append(stick)
    ng = normal * g
    adjugate = np.array([[ng[1, 1], -ng[0, 1]], [-ng[1, 0], ng[0, 0]]])
    determinant = np.polynomial.Polynomial([np.linalg.det(ng), np.trace(ng), 1.0])
    components = [np.polynomial.Polynomial([(adjugate @ b)[i], b[i]]) for i in range(2)]
    quartic = components[0] ** 2 + components[1] ** 2 - determinant**2
    for s in quartic.roots():
        if abs(s.imag) < 1e-9 and s.real > 1e-9:
            slip = s.real * np.linalg.solve(s.real * np.eye(2) + ng, b)
            found.append(-normal * np.linalg.solve(root, slip / np.linalg.norm(slip)))
    return np.array(sorted(map(tuple, found)))


def test_solutions_are_those_of_the_oracle():
    rng = np.random.default_rng(48)
    several = 0
    for _ in range(2000):
        law, q_c, q_d = random_ellipses(rng)
        jacobian = rng.normal(size=(2, 4))
        delassus, normal = jacobian @ jacobian.T, rng.uniform(0.5, 2.0)
        free = delassus @ rng.normal(size=2) * normal
        problem = asp.ContactProblem(delassus, free, law, normal_force=normal)
        expected = oracle(delassus, free, normal, q_c, q_d)
        ours = np.array(sorted(tuple(one.percussion) for one in problem.solutions(0)))
        assert len(ours) == len(expected)
        np.testing.assert_allclose(ours, expected, atol=1e-6)
        solution = problem.solve()
        assert np.abs(expected - solution.percussion).sum(axis=1).min() < 1e-6
        assert solution.ambiguous == (len(expected) > 1)
        several += len(expected) > 1
    assert several > 5


@pytest.fixture
def ambiguous():
    """A load inside C under an unstable law: stick and two slip solutions are admissible."""
    law = asp.FrictionLaw(asp.Ellipse(30.0, 10.0, angle=np.pi / 6), asp.Ellipse(3.0, 1.0))
    slip = 0.05 * np.array([np.cos(np.deg2rad(60.0)), np.sin(np.deg2rad(60.0))])
    return asp.ContactProblem(np.eye(2), slip - law.force(slip), law, normal_force=1.0)


def test_non_uniqueness_is_found_and_reported(ambiguous):
    solutions = ambiguous.solutions(0)
    assert [one.phase for one in solutions] == [Phase.STICK, Phase.SLIP, Phase.SLIP]
    for one in solutions:
        assert ambiguous.residual(one.percussion) < 1e-11
    assert ambiguous.solve().ambiguous


def test_selection_continues_the_previous_state(ambiguous):
    stick, *slips = ambiguous.solutions(0)
    first = ambiguous.solve()
    for previous in (stick, *slips):
        start = first.replace(
            percussion=previous.percussion, velocity=previous.velocity, phase=[previous.phase]
        )
        solution = ambiguous.solve(start=start)
        assert solution.phase.tolist() == [previous.phase]
        np.testing.assert_allclose(solution.percussion, previous.percussion, atol=1e-9)


def test_painleve_has_a_status_of_its_own():
    # P_N = −b_N/(g_NN − μ g_NT) < 0 for forward slip, and no other state is admissible.
    problem = asp.ContactProblem(
        [[1.0, 2.0], [2.0, 3.0]], [-1.0, 5.0], asp.FrictionLaw.isotropic(1.0, dimension=1)
    )
    assert problem.solutions(0) == []
    with pytest.raises(asp.NoSolutionError) as caught:
        problem.solve()
    assert caught.value.contact == 0
    assert problem.solve(on_failure="record").status is Status.NO_SOLUTION
    assert Status.NO_SOLUTION.advice in str(caught.value)


def test_solutions_hold_the_other_contacts():
    delassus = np.eye(4) + 0.5 * np.eye(4)[[2, 3, 0, 1]]
    problem = asp.ContactProblem(delassus, [2.0, 0.0, 0.0, 0.0], ISOTROPIC, normal_force=[1.0, 1.0])
    alone = problem.solutions(0)[0]
    np.testing.assert_allclose(alone.velocity, [1.5, 0.0], atol=1e-12)
    pushed = problem.solutions(0, percussion=[0.0, 0.0, 0.4, 0.0])[0]
    np.testing.assert_allclose(pushed.velocity, [1.7, 0.0], atol=1e-12)


def test_prescribed_normal_percussion_bounds_the_friction():
    problem = asp.ContactProblem(np.eye(2), [10.0, 0.0], ISOTROPIC, normal_force=2.0)
    np.testing.assert_allclose(problem.solve().percussion, [-1.0, 0.0])
    assert not problem.replace(normal_force=0.0).solve().percussion.any()
