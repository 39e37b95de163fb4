"""Contacts whose rows all see one direction of the motion: forces that cancel are none.

The block of such a contact has rank one, so that percussions without effect may be added to those
it needs, as large as one likes; residuals, which are relative to percussions, become small by that.
"""

import asperity as asp
import numpy as np
import pytest
from asperity import Phase
from profiles import counts

STEPS = 400


def system_on_hinge(seed):
    """Bodies on springs, at rest on a hinge that they load by their forces."""
    rng = np.random.default_rng(seed)
    n, p = int(rng.integers(2, 5)), int(rng.integers(1, 3))
    seen = rng.normal(size=n)
    law = asp.FrictionLaw.isotropic(rng.uniform(0.3, 1.5), dimension=p)
    hinge = asp.Contact(
        law,
        direction=np.outer(seen, rng.normal(size=p)),
        normal=seen * rng.choice([-1.0, 1.0]),
        normal_restitution=rng.choice([0.0, 0.3, 0.8]),
    )
    root, spring = rng.normal(size=(n, n)), rng.normal(size=(n, n))
    return asp.LinearSystem(
        root @ root.T + 0.5 * np.eye(n),
        stiffness=5.0 * spring @ spring.T,
        damping=0.1 * spring @ spring.T,
        force=3.0 * rng.normal(size=n),
        contacts=[hinge],
    )


@counts(30, 300)
@pytest.mark.parametrize("dt", [1e-3, 1e-4, 1e-5])
def test_hinges_at_rest_carry_what_they_are_asked_to(count, dt):
    """Of 300 systems 51 carried up to 10¹⁰ times the usual load in some of the steps."""
    stuck = 0
    for seed in range(count):
        system = system_on_hinge(seed)
        rest = np.zeros(system.dof)
        steps = asp.simulate(system, dt=dt, t_end=STEPS * dt, q0=rest, u0=rest, on_failure="record")
        if (steps.phase[1:, 0] == Phase.STICK).all():
            load = steps.normal_force[1:, 0]
            assert load.max() <= 10.0 * np.median(load), seed
            stuck += 1
    assert stuck >= 0.3 * count


def rank_one(seen, load, law, **options):
    """A hinge with the rows `seen`, and velocities `load` without percussions."""
    seen = np.asarray(seen)
    return asp.ContactProblem(np.outer(seen, seen), free_velocity=load, laws=law, **options)


def test_slip_where_friction_nearly_cancels_the_normal_force():
    """`P_N = s/(m_N + m_T·f)` with `s` from the normal row and the friction `f` along the slip.

    All slip velocities times the denominator vanish with it: percussions of 3·10¹¹ N s, of whose
    velocities rounding leaves nothing, looked like a second slip, and were taken.
    """
    law = asp.FrictionLaw(
        asp.Ellipse(0.6731679915125091, 0.4208870888569048, angle=0.892842568334979),
        asp.Superellipse(
            0.4486723521625214, 0.2549939514280463, 4.270341258883578, angle=1.5165809237910106
        ),
    )
    seen = np.array([1.143629685, -0.344800081, -1.838356242])
    load = np.array([-0.013210169, 0.003928508, 0.020945465])
    problem = rank_one(seen, load, law)
    push = -load[0] / seen[0]
    slip = load[1:] + seen[1:] * push
    per_normal = np.append(1.0, law.force(slip))
    percussion = per_normal * push / (seen @ per_normal)
    (found,) = problem.solutions(0)
    assert found.phase == Phase.SLIP
    np.testing.assert_allclose(found.percussion, percussion, rtol=1e-9)
    np.testing.assert_allclose(problem.solve().percussion, percussion, rtol=1e-9)


@pytest.mark.parametrize("off", [0.0, 1e-16, 1e-14, 1e-12])
def test_loads_that_rounding_leaves_are_held_by_the_shortest_percussion(off):
    """The shortest one is `−c m/m²` for the load `c m`, in the units of a block of ones."""
    rng = np.random.default_rng(3)
    for _ in range(200):
        law = asp.FrictionLaw.isotropic(1.2)
        angle = rng.uniform(0.0, 2.0 * np.pi)
        seen = np.array([1.0, np.cos(angle), np.sin(angle)])
        load = -1e-3 * seen * (1.0 + off * rng.normal(size=3))
        found = rank_one(seen, load, law).solve()
        assert found.phase[0] == Phase.STICK
        np.testing.assert_allclose(found.percussion[0], 0.5e-3, rtol=0.5)
        assert np.linalg.norm(found.percussion) <= 1e-3


@pytest.mark.parametrize("radius", [1.0, 1e-3, 1e-6])
def test_the_unit_of_length_does_not_decide_on_the_rank_with_drilling(radius):
    """Drilling velocities are in rad/s: of small contacts they are far larger than those in m/s."""
    law = asp.FrictionLaw.associated(asp.Ellipsoid([0.8, 0.8, 0.3 * radius]))
    delassus = np.diag([1.0, 1.0, 1.0, 2.5 / radius**2])
    wanted = np.array([10.0, 3.0, 1.0, 0.1 * radius])
    problem = asp.ContactProblem(delassus, free_velocity=-delassus @ wanted, laws=law)
    found = problem.solve()
    assert found.phase[0] == Phase.STICK
    np.testing.assert_allclose(found.percussion, wanted, rtol=1e-9)
