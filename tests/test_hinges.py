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
