"""Bodies that nothing connects are integrated one by one: samples are those of the whole."""

import asperity as asp
import numpy as np
import pytest

LAW = asp.FrictionLaw.isotropic(0.4)


def step_of_load(time):
    """Return a force along x that jumps from 0 to 1 N."""
    rest, push = [0.0, 0.0, 0.0], [1.0, 0.0, 0.0]
    return asp.Signal([0.0, time, time, 20.0], [rest, rest, push, push], interpolation="linear")


def ball(speed, force=(0.0, 0.0, 0.0)):
    return asp.Body.ball(1.0, radius=0.1, velocity=(speed, 0.0, 0.0), force=force)


@pytest.mark.parametrize("step", [1, 2, 3])
def test_kinks_within_the_steps_of_others_leave_their_motion_as_it_is(step):
    weightless = {"gravity": (0.0, 0.0, 0.0), "pairs": []}
    alone = asp.integrate(asp.RigidBodies([ball(1.0)], **weightless), t_end=10.0)
    first, then = alone.t[step], 0.5 * (alone.t[step] + alone.t[step + 1])
    # One body has a kink where another ends a step, a third one within the next step of that.
    bodies = [ball(1.0, step_of_load(first)), ball(1.0), ball(1.0, step_of_load(then))]
    bodies += [ball(1e-3) for _ in range(3)]
    motion = asp.integrate(asp.RigidBodies(bodies, **weightless), t_end=10.0)
    x = motion.q.reshape(len(motion), 6, 7)[:, :, 0]
    np.testing.assert_allclose(x[:, 1], motion.t, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(x[:, 3], 1e-3 * motion.t, rtol=1e-12, atol=1e-12)
    for body, begin in ((0, first), (2, then)):
        pushed = motion.t + 0.5 * np.maximum(motion.t - begin, 0.0) ** 2
        np.testing.assert_allclose(x[:, body], pushed, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("others", [0, 1, 2])
def test_a_jump_of_a_load_has_a_sample_on_either_side(others):
    box = asp.Body.box(
        1.0, half_sizes=(0.2, 0.2, 0.1), position=(0.0, 0.0, 0.1), force=step_of_load(1.0)
    )
    plane = asp.BoxPlane(0, half_sizes=(0.2, 0.2, 0.1), plane=asp.Plane(), law=LAW)
    far = [asp.Body.ball(1.0, radius=0.1, position=(0.0, 5.0, 100.0))] * others
    motion = asp.integrate(asp.RigidBodies([box, *far], pairs=[plane]), t_end=1.5)
    friction = motion.force[motion.t == 1.0, :, 0].sum(axis=1)
    np.testing.assert_allclose(friction, [0.0, -1.0], atol=1e-12)


@pytest.mark.parametrize("sample_every", [None, 0.5])
def test_an_interrupted_run_keeps_the_motion_until_then(sample_every):
    law = asp.FrictionLaw.isotropic(0.4, dimension=1)
    belt = asp.Contact(law, direction=[[1.0], [0.0]], normal_force=2.0, velocity=[-0.5])
    system = asp.LinearSystem(np.eye(2), stiffness=np.diag([9.0, 0.0]), contacts=[belt])

    def stop(t, t_end):
        if t > 50.0:
            raise KeyboardInterrupt

    with pytest.raises(asp.errors.SimulationInterrupted) as caught:
        asp.integrate(
            system,
            t_end=1e4,
            q0=[0.1, 0.0],
            u0=[0.0, 1.0],
            sample_every=sample_every,
            progress=stop,
            max_events=10**6,
        )
    motion = caught.value.trajectory
    assert motion.t[-1] >= 50.0
    np.testing.assert_allclose(motion.q[:, 1], motion.t, rtol=1e-10)
    if sample_every:
        assert len(motion) >= motion.t[-1] / sample_every
