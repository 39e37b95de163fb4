"""Contact problems against hand calculations and an oracle of another kind."""

import asperity as asp
import numpy as np
import pytest
from asperity import Phase, Status
from profiles import counts

ISOTROPIC = asp.FrictionLaw.isotropic(0.5)
LINE = asp.FrictionLaw.isotropic(0.5, dimension=1)


def test_rows_come_contact_by_contact():
    problem = asp.ContactProblem(
        np.eye(7),
        free_velocity=np.zeros(7),
        laws=[ISOTROPIC, LINE, ISOTROPIC],
        normal_force=[None, None, 1.0],
    )
    assert problem.row_slices == (slice(0, 3), slice(3, 5), slice(5, 7))
    assert asp.ContactProblem(np.eye(6), free_velocity=np.zeros(6), laws=ISOTROPIC).row_slices == (
        slice(0, 3),
        slice(3, 6),
    )


def test_restitution():
    problem = asp.ContactProblem(
        np.eye(2),
        free_velocity=[-2.0, 0.0],
        laws=LINE,
        normal_restitution=0.5,
        initial_velocity=[-2.0, 0.0],
    )
    assert problem.solve().velocity[0] == pytest.approx(1.0)
    sliding = asp.ContactProblem(
        np.eye(2),
        free_velocity=[-2.0, 0.1],
        laws=LINE,
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
        sets.append(asp.Ellipse(a, b, angle=angle))
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


@counts(500, 2000)
def test_solutions_are_those_of_the_oracle(count):
    rng = np.random.default_rng(48)
    several = 0
    for _ in range(count):
        law, q_c, q_d = random_ellipses(rng)
        jacobian = rng.normal(size=(2, 4))
        delassus, normal = jacobian @ jacobian.T, rng.uniform(0.5, 2.0)
        free = delassus @ rng.normal(size=2) * normal
        problem = asp.ContactProblem(delassus, free_velocity=free, laws=law, normal_force=normal)
        expected = oracle(delassus, free, normal, q_c, q_d)
        ours = np.array(sorted(tuple(one.percussion) for one in problem.solutions(0)))
        assert len(ours) == len(expected)
        np.testing.assert_allclose(ours, expected, atol=1e-6)
        solution = problem.solve()
        assert np.abs(expected - solution.percussion).sum(axis=1).min() < 1e-6
        assert solution.ambiguous == (len(expected) > 1)
        several += len(expected) > 1
    assert several > 2e-3 * count


@pytest.fixture
def ambiguous():
    """A load inside C under an unstable law: stick and two slip solutions are admissible."""
    law = asp.FrictionLaw(asp.Ellipse(30.0, 10.0, angle=np.pi / 6), asp.Ellipse(3.0, 1.0))
    slip = 0.05 * np.array([np.cos(np.deg2rad(60.0)), np.sin(np.deg2rad(60.0))])
    return asp.ContactProblem(
        np.eye(2), free_velocity=slip - law.force(slip), laws=law, normal_force=1.0
    )


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
        [[1.0, 2.0], [2.0, 3.0]],
        free_velocity=[-1.0, 5.0],
        laws=asp.FrictionLaw.isotropic(1.0, dimension=1),
    )
    assert problem.solutions(0) == []
    with pytest.raises(asp.NoSolutionError) as caught:
        problem.solve()
    assert caught.value.contact == 0
    assert problem.solve(on_failure="record").status is Status.NO_SOLUTION
    assert Status.NO_SOLUTION.advice in str(caught.value)


def test_solutions_hold_the_other_contacts():
    delassus = np.eye(4) + 0.5 * np.eye(4)[[2, 3, 0, 1]]
    problem = asp.ContactProblem(
        delassus, free_velocity=[2.0, 0.0, 0.0, 0.0], laws=ISOTROPIC, normal_force=[1.0, 1.0]
    )
    alone = problem.solutions(0)[0]
    np.testing.assert_allclose(alone.velocity, [1.5, 0.0], atol=1e-12)
    pushed = problem.solutions(0, percussion=[0.0, 0.0, 0.4, 0.0])[0]
    np.testing.assert_allclose(pushed.velocity, [1.7, 0.0], atol=1e-12)


def test_prescribed_normal_percussion_bounds_the_friction():
    problem = asp.ContactProblem(
        np.eye(2), free_velocity=[10.0, 0.0], laws=ISOTROPIC, normal_force=2.0
    )
    np.testing.assert_allclose(problem.solve().percussion, [-1.0, 0.0])
    assert not problem.replace(normal_force=0.0).solve().percussion.any()


# Blocks of any rank and condition.


# Contacts without a solution: a checker that knows nothing of the solvers.


def boundary(phi, semi_axes):
    """Point of an ellipse with outward normal at angle φ, the largest |dx/dφ|, and the normals."""
    normals = np.stack([np.cos(phi), np.sin(phi)], -1)
    stretched = normals * semi_axes**2
    points = stretched / np.sqrt((stretched * normals).sum(-1, keepdims=True))
    # dx/dφ is the radius of curvature, at most a²/b.
    return points, semi_axes.max() ** 2 / semi_axes.min(), normals


def slip_is_impossible(delassus, free, semi_axes, margin):
    """Whether no direction of slip fits, by bounds of Lipschitz over intervals that are halved.

    An interval is ruled out where γ_T is not along the normal n, is against it, or P_N would pull.
    """
    g_nn, g_nt, g_tn, g_tt = delassus[0, 0], delassus[0, 1:], delassus[1:, 0], delassus[1:, 1:]
    width = 2 * np.pi / 720
    centres = width * np.arange(720)
    offset = free[1:] * g_nn - g_tn * free[0]
    matrix = np.outer(free[1:], g_nt) - g_tt * free[0]
    size = np.linalg.norm(offset) + np.linalg.norm(matrix) * semi_axes.max()
    for _ in range(40):
        points, slope, normals = boundary(centres, semi_axes)
        velocity = offset - points @ matrix.T
        across = normals[:, 0] * velocity[:, 1] - normals[:, 1] * velocity[:, 0]
        along = (normals * velocity).sum(-1)
        resistance = g_nn - points @ g_nt
        reach = 0.5 * width * (size + np.linalg.norm(matrix) * slope) + margin * size
        lift = 0.5 * width * np.linalg.norm(g_nt) * slope + margin * g_nn
        left = (np.abs(across) <= reach) & (along >= -reach) & (resistance >= -lift)
        if not left.any():
            return True
        width /= 2
        centres = np.concatenate([centres[left] - width / 2, centres[left] + width / 2])
        if centres.size > 4000:
            return False
    return False


def has_no_solution(delassus, free, semi_axes, margin):
    """Whether open, stick and slip are impossible, each with a margin.

    `semi_axes` are those of an ellipse or, with p = 1, the coefficient.
    """
    if not free[0] < -margin * np.abs(free).max():
        return False
    stick = -np.linalg.solve(delassus, free)
    outside = np.linalg.norm(stick[1:] / semi_axes) > stick[0] * (1 + margin)
    if not (stick[0] < -margin * np.abs(stick).max() or (stick[0] > 0 and outside)):
        return False
    if free.size == 3:
        return slip_is_impossible(delassus, free, semi_axes, margin)
    for sign in (-1.0, 1.0):
        x = sign * semi_axes[0]
        resistance = delassus[0, 0] - delassus[0, 1] * x
        moved = free[1] * resistance - free[0] * (delassus[1, 0] - delassus[1, 1] * x)
        size = abs(free[1] * delassus[0, 0]) + abs(free[0]) * np.abs(delassus[1]).sum()
        if not (resistance < -margin * delassus[0, 0] or sign * moved < -margin * size):
            return False
    return True


PAINLEVE_LAWS = {
    "line": (asp.FrictionLaw.isotropic(1.5, dimension=1), np.array([1.5])),
    "disk": (asp.FrictionLaw.isotropic(1.2), np.array([1.2, 1.2])),
    "ellipse": (asp.FrictionLaw.associated(asp.Ellipse(2.0, 0.7)), np.array([2.0, 0.7])),
}


def check_painleve(name, count):
    law, semi_axes = PAINLEVE_LAWS[name]
    rng = np.random.default_rng(17)
    said, proven = 0, 0
    for _ in range(count):
        rows = law.dimension + 1
        half = rng.normal(size=(rows, rows))
        delassus = half @ half.T + 1e-3 * rng.normal(size=(rows, rows))
        if not np.all(np.diag(delassus) > 0):
            continue
        free = rng.normal(size=rows)
        free[0] = -rng.random()
        problem = asp.ContactProblem(delassus, free_velocity=free, laws=law)
        status = problem.solve(on_failure="record").status
        if status is Status.NO_SOLUTION:
            said += 1
            assert has_no_solution(delassus, free, semi_axes, 1e-11), (delassus, free)
        if has_no_solution(delassus, free, semi_axes, 1e-6):
            proven += 1
            assert status is not Status.CONVERGED
            # Blocks that are too ill-conditioned prove nothing to the solver.
            if np.linalg.cond(delassus) < 100:
                assert status is Status.NO_SOLUTION
    assert min(said, proven) > count // 500


@pytest.mark.parametrize("name", PAINLEVE_LAWS)
def test_no_solution_is_said_where_a_checker_proves_it(name):
    check_painleve(name, 1500)


@pytest.mark.long
@pytest.mark.parametrize("name", PAINLEVE_LAWS)
def test_no_solution_is_said_where_a_checker_proves_it_in_many_problems(name):
    check_painleve(name, 100_000)


# Loads beside corners, roots beside cusps, numbers beyond reason.


@pytest.mark.parametrize("size", [1e90, 1e120, 1e154, 1e200, 1e300])
def test_velocities_beyond_reason_are_refused_by_name(size):
    law = asp.FrictionLaw(asp.Ellipse(0.5, 0.4), asp.Ellipse(0.6, 0.3) & asp.Disk(0.4))
    if size < 1e100:
        problem = asp.ContactProblem(
            np.eye(2), free_velocity=[size, size], laws=law, normal_force=size
        )
        assert problem.solve().converged
        return
    for normal in (size, 1.0, None):
        free = [-size] * (2 + (normal is None))
        with pytest.raises(asp.ParameterError, match="free_velocity"):
            asp.ContactProblem(np.eye(len(free)), free_velocity=free, laws=law, normal_force=normal)
    with pytest.raises(asp.ParameterError, match="normal_force"):
        asp.ContactProblem(np.eye(2), free_velocity=[1.0, 1.0], laws=law, normal_force=size)


# Drilling contacts.


ISO = asp.FrictionLaw.isotropic(0.3)


def test_continuum_of_stick_is_ambiguous():
    problem = asp.ContactProblem(
        np.ones((2, 2)), free_velocity=[-0.1, -0.1], laws=ISO, normal_force=1.0
    )
    assert problem.solve().ambiguous
    assert [one.degenerate for one in problem.solutions(0)] == [True]


"""Exponents of superellipsoids as reservoir and as direction set, a box where there is none."""
