"""The disk on three pads: loads of the pads, agreement with the point mass, spin."""

import asperity as asp
import numpy as np
import pytest
from asperity.demo import table1

WEIGHT = 0.018 * 9.81
EXTENDED = table1.LAWS["extended, superellipses C, D"]
LAWS = {**table1.LAWS, "isotropic": asp.FrictionLaw.isotropic(0.5)}
VELOCITY = 1.52 * np.array([np.cos(np.deg2rad(32.0)), np.sin(np.deg2rad(32.0))])


def slide(disk, dt=2e-4, **options):
    return asp.simulate(disk, dt=dt, t_end=1.0, until_rest=True, tolerance=1e-13, **options)


@pytest.mark.parametrize("spin", [0.0, 25.0])
def test_pads_carry_the_weight(spin):
    disk = asp.SlidingDisk(EXTENDED, velocity=VELOCITY, spin=spin, angle=0.3)
    run = slide(disk, dt=1e-4)
    assert run.status == "at_rest"
    assert run.normal_force[1:, :3].min() > 0.01
    assert not run.normal_force[1:, 3:].any()
    assert run.normal_force[1:].sum(axis=1) == pytest.approx(WEIGHT, rel=1e-10)
    assert disk.positions(run)[:, 0, 2] == pytest.approx(0.0065, abs=1e-12)


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("angle", [0.0, 1.1])
def test_without_spin_the_disk_moves_as_the_point(name, angle):
    disk = asp.SlidingDisk(LAWS[name], velocity=VELOCITY, angle=angle)
    run = slide(disk)
    point = slide(asp.SlidingPoint(0.018, law=LAWS[name]), u0=VELOCITY)
    common = min(len(run), len(point))
    assert disk.path(run)[:common] == pytest.approx(point.q[:common], abs=1e-10)
    assert disk.turn(run) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("name", LAWS)
def test_loads_of_the_pads_follow_from_the_moments(name):
    """Σ λ_N r = −h Σ λ_T about the centre of mass, and Σ r rᵀ = (3/2) r² I on the circle."""
    disk = asp.SlidingDisk(LAWS[name], velocity=VELOCITY, angle=0.4)
    run = slide(disk)
    pads = 0.0105 * np.stack([np.cos(a := 0.4 + 2.0 * np.pi * np.arange(3) / 3), np.sin(a)], 1)
    friction = LAWS[name].force(run.slip[1:-9, 0], normal_force=WEIGHT)
    loads = WEIGHT / 3.0 - 0.0065 / (1.5 * 0.0105**2) * friction @ pads.T
    assert run.normal_force[1:-9, :3] == pytest.approx(loads, rel=1e-6)


def test_spin_follows_the_euler_equations_of_pads_with_given_loads():
    """Against an explicit integration of the plane motion with loads from both moments."""
    law = asp.FrictionLaw.isotropic(0.5)
    disk = asp.SlidingDisk(law, velocity=(1.0, 0.2), spin=30.0, angle=0.2)
    run = asp.simulate(disk, dt=1e-4, t_end=0.1, tolerance=1e-13)
    reference = _planar_motion(law, (1.0, 0.2), 30.0, 0.2, 0.1)
    assert disk.path(run)[-1] == pytest.approx(reference[:2], abs=2e-6)
    assert disk.turn(run)[-1] == pytest.approx(reference[2] - 0.2, abs=1e-4)


def _planar_motion(law, velocity, spin, angle, t_end):
    from scipy.integrate import solve_ivp

    inertia, height, radius = 0.5 * 0.018 * 0.014**2, 0.0065, 0.0105

    def rate(_, state):
        v, omega, turned = state[3:5], state[5], state[2]
        a = turned + 2.0 * np.pi * np.arange(3) / 3
        pads = radius * np.stack([np.cos(a), np.sin(a)], axis=1)
        slip = v + omega * np.stack([-pads[:, 1], pads[:, 0]], axis=1)
        unit = law.force(slip)
        # Σ λ = m g and Σ λ (r + h f) = 0 are three linear equations of the three loads.
        loads = np.linalg.solve(np.vstack([np.ones(3), (pads + height * unit).T]), [WEIGHT, 0, 0])
        force = loads[:, None] * unit
        torque = np.sum(pads[:, 0] * force[:, 1] - pads[:, 1] * force[:, 0])
        return [*v, omega, *(force.sum(axis=0) / 0.018), torque / inertia]

    start = [0.0, 0.0, angle, *velocity, spin]
    return solve_ivp(rate, (0.0, t_end), start, rtol=1e-9, atol=1e-12).y[:, -1]


def test_spin_shortens_no_disk_and_bends_the_path():
    straight, spinning = (
        asp.SlidingDisk(EXTENDED, velocity=VELOCITY, spin=spin) for spin in (0.0, 60.0)
    )
    ends = [disk.path(slide(disk))[-1] for disk in (straight, spinning)]
    assert np.hypot(*ends[1]) > np.hypot(*ends[0])
    assert np.hypot(*(ends[1] - ends[0])) > 5e-3


def on_three_pads(mu, speed=-1.0, **options):
    """A disk that slides with one pad behind, which lifts off if µ is above r/h."""
    disk = asp.SlidingDisk(asp.FrictionLaw.isotropic(mu), velocity=(speed, 0.0), **options)
    return disk, slide(disk, dt=1e-4)


def test_a_pad_lifts_off_above_the_limit_and_the_edge_stops_the_tilt():
    """µ of the limit: Σ λ_N r = −h Σ λ_T unloads the pad behind at µ = r/(2 h)."""
    (disk, below), (_, above) = on_three_pads(0.79), on_three_pads(0.82)
    assert below.normal_force[1:-9, 0].min() > 1e-3
    assert above.normal_force[1:-9, 0].min() == 0.0
    assert above.normal_force[1:-9, 3:15].max() > 0.0
    for run in (below, above):
        assert run.status == "at_rest"
        assert disk.rotations(run)[-1, 0, 2, 2] == pytest.approx(1.0, abs=1e-6)
    assert disk.rotations(below)[:, 0, 2, 2] == pytest.approx(1.0, abs=1e-12)
    # Until the lowest point of the edge, at the angle atan(1 mm / (R - r/2)), and little farther.
    tilt = np.arccos(disk.rotations(above)[:, 0, 2, 2].min())
    assert 0.99 * np.arctan(1.0 / 8.75) < tilt < 1.15 * np.arctan(1.0 / 8.75)
    assert disk.path(above)[-1] == pytest.approx([-1.0 / (2.0 * 0.82 * 9.81), 0.0], rel=0.03)


@pytest.mark.parametrize("mu", [0.82, 1.2, 2.0, 3.0])
@pytest.mark.parametrize("speed", [-1.0, 1.0])
def test_a_disk_that_tips_does_not_sink_into_the_plane(mu, speed):
    disk, run = on_three_pads(mu, speed)
    axis = disk.rotations(run)[:, 0, :, 2]
    across = 0.014 * np.hypot(axis[:, 0], axis[:, 1])
    middle = disk.positions(run)[:, 0, 2]
    lowest = middle + np.minimum(0.0065 * axis[:, 2], -0.0055 * axis[:, 2]) - across
    # Between two of the twelve points of the edge the rim lies R (1 - cos 15°) deeper.
    assert lowest.min() > -0.014 * (1.0 - np.cos(np.pi / 12)) - 1e-4
    assert run.status == "at_rest"


@pytest.mark.parametrize(
    ("changes", "argument"),
    [
        ({"law": asp.FrictionLaw.isotropic(0.3, dimension=1)}, "law"),
        ({"law": 0.3}, "law"),
        ({"velocity": [1.0, 0.0, 0.0]}, "velocity"),
        ({"spin": np.nan}, "spin"),
        ({"mass": 0.0}, "mass"),
        ({"pad_circle": 0.03}, "pad_circle"),
        ({"pad_height": 0.0}, "pad_height"),
        ({"pad_height": 0.013}, "pad_height"),
        ({"gravity": (0.0, 0.0, 9.81)}, "gravity"),
    ],
)
def test_what_is_no_disk_is_refused(changes, argument):
    with pytest.raises(asp.ParameterError) as caught:
        asp.SlidingDisk(**{"law": EXTENDED, **changes})
    assert caught.value.argument == argument
