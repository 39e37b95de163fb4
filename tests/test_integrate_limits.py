"""Rest at the limit of friction and contacts without load, against closed forms.

The load of a body on several feet equals what friction can hold, up to rounding of either side: it
rests or slides as the limit says, at once. A contact that is touched without load is in no way.
"""

import asperity as asp
import numpy as np
import pytest
from asperity.runs.event import EventKind
from profiles import counts, every
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

GRAVITY = 9.81
EXCESSES = (0.0, 1e-15, -1e-15, 1e-12, -1e-12, 1e-10, 1e-8, -1e-8, 1e-6, -1e-6)


class Stand:
    """A body on three to six feet under a law, associated and isotropic or elliptic."""

    def __init__(self, rng, *, isotropic=False):
        self.feet, self.mass = int(rng.integers(3, 7)), rng.uniform(0.1, 10.0)
        self.height = rng.uniform(0.005, 0.03)
        places = np.arange(self.feet) + rng.uniform(-0.12, 0.12, self.feet)
        self.angles = rng.uniform(0.0, 2 * np.pi) + 2 * np.pi * places / self.feet
        self.friction = rng.uniform(0.2, 0.7)
        self.ratio = 1.0 if isotropic or rng.random() < 0.5 else rng.uniform(0.5, 1.0)
        ellipse = asp.Ellipse(self.friction, self.ratio * self.friction)
        self.law = asp.FrictionLaw(ellipse, ellipse)
        angle = rng.uniform(0.0, 2 * np.pi)
        self.direction = np.array([np.cos(angle), np.sin(angle)])
        limit = 1.0 / self.law.reservoir.gauge(-self.direction)
        self.limit = float(limit) * self.mass * GRAVITY

    def system(self, *, force=(0.0, 0.0, 0.0), turned=None, speed=0.0):
        """The body under a force at its centre, or on a slope up which it goes."""
        turned = Rotation.identity() if turned is None else turned
        up = turned.apply([*self.direction, 0.0])
        body = asp.Body(
            self.mass,
            inertia=self.mass * np.diag([0.01, 0.01, 0.02]),
            position=turned.apply([0.0, 0.0, self.height]),
            orientation=turned,
            velocity=speed * up,
            force=force,
        )
        plane = asp.Plane.oriented(turned)
        places = [(0.1 * np.cos(a), 0.1 * np.sin(a), -self.height) for a in self.angles]
        feet = [asp.PointPlane(0, point=p, plane=plane, law=self.law) for p in places]
        return asp.RigidBodies([body], pairs=feet)


@pytest.mark.parametrize("seed", every(7, range(100)))
def test_a_body_on_feet_rests_or_slides_as_the_limit_says(seed):
    stand = Stand(np.random.default_rng([1, seed]))
    excess = EXCESSES[seed % len(EXCESSES)]
    push = stand.limit * (1.0 + excess) * stand.direction
    motion = asp.integrate(stand.system(force=(*push, 0.0)), t_end=1.0)
    way = motion.q[-1, :2] - motion.q[0, :2]
    if excess <= 0.0:
        np.testing.assert_allclose(way, 0.0, atol=1e-12)
    elif excess > 1e-9:
        # Slip is along the normal of the ellipse, as is the push that is left.
        slip = push / np.array([stand.friction, stand.ratio * stand.friction]) ** 2
        slip /= np.linalg.norm(slip)
        along = 0.5 * excess * (push @ slip) / stand.mass
        assert way @ slip == pytest.approx(along, rel=1e-3, abs=1e-9)


@pytest.mark.parametrize("seed", every(12, range(100)))
def test_slip_under_a_ramp_begins_as_the_load_reaches_the_limit(seed):
    stand = Stand(np.random.default_rng([2, seed]))
    most = 2.0 * stand.limit * np.array([*stand.direction, 0.0])
    ramp = asp.Signal([0.0, 2.0], [np.zeros(3), most], interpolation="linear")
    motion = asp.integrate(stand.system(force=ramp), t_end=1.1)
    first = next(event for event in motion.events if event.kind == EventKind.SLIP)
    assert first.time == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("speed", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("seed", every(15, range(45)))
def test_a_body_launched_up_a_critical_slope_stops_and_stays(seed, speed):
    stand = Stand(np.random.default_rng([3, seed]), isotropic=True)
    angle = np.arctan(stand.friction)
    across = np.array([-stand.direction[1], stand.direction[0], 0.0])
    turned = Rotation.from_rotvec(-angle * across)
    motion = asp.integrate(stand.system(turned=turned, speed=speed), t_end=1.0)
    way = np.linalg.norm(motion.q[-1, :3] - motion.q[0, :3])
    assert way == pytest.approx(speed**2 / (4.0 * GRAVITY * np.sin(angle)), abs=1e-9)


@pytest.mark.parametrize("friction", [0.3, 0.5, 0.7])
def test_a_box_at_the_limit_rests(friction):
    half = (0.1, 0.1, 0.02)
    push = (friction * GRAVITY, 0.0, 0.0)
    box = asp.Body.box(1.0, half_sizes=half, position=(0.0, 0.0, 0.02), force=push)
    law = asp.FrictionLaw.isotropic(friction)
    floor = asp.BoxPlane(0, half_sizes=half, plane=asp.Plane(), law=law)
    motion = asp.integrate(asp.RigidBodies([box], pairs=[floor]), t_end=1.0)
    np.testing.assert_allclose(motion.q, np.tile(motion.q[0], (len(motion), 1)), atol=1e-14)


@counts(10, 150)
@pytest.mark.parametrize("mass", [1e-4, 3.5e-4, 0.01, 0.1, 0.3, 1.0, 10.0])
def test_a_mass_falls_along_a_wall_that_it_touches_without_load(mass, count):
    # A guide with dry friction holds a side force away from the wall.
    rng = np.random.default_rng(0)
    guide, wall = (asp.FrictionLaw.isotropic(mu, dimension=1) for mu in (0.5, 0.3))
    for _ in range(count):
        weight = mass * GRAVITY
        side = rng.uniform(0.05, 5.0) * weight
        load = side / (0.5 * rng.uniform(0.1, 0.9))
        system = asp.LinearSystem(
            mass * np.eye(2),
            force=[-side, -weight],
            contacts=[
                asp.Contact(guide, direction=[[1.0], [0.0]], normal_force=load),
                asp.Contact(wall, direction=[[0.0], [1.0]], normal=[-1.0, 0.0], gap=0.0),
            ],
        )
        motion = asp.integrate(system, t_end=1.0)
        np.testing.assert_allclose(motion.q[-1], [0.0, -0.5 * GRAVITY], rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize(
    ("friction", "half", "position", "angles"),
    [
        (0.4, (0.19, 0.07), -0.28, [0.0, -0.11, -0.14, 0.01, 0.01, 0.17]),
        (0.5286629657070951, (0.1, 0.16), -0.11, [0.0, -0.09, 0.05, -0.15, 0.14, 0.12]),
        (
            0.5286629657070951,
            (0.10005957, 0.15999851),
            -0.108,
            [0.0, -0.09, 0.05, -0.15, 0.14, 0.12],
        ),
    ],
)
def test_a_box_on_a_table_that_turns_moves_as_under_simulate(friction, half, position, angles):
    tilt = asp.Signal(0.25 * np.arange(6), angles, interpolation="cubic")
    box = asp.PlanarBody.box(1.0, half_sizes=half, position=(position, half[1]))
    corners = asp.BoxPlane(
        0,
        half_sizes=half,
        plane=asp.Line(motion=asp.PlaneMotion(rotation=tilt)),
        law=asp.FrictionLaw.isotropic(friction, dimension=1),
    )
    system = asp.RigidBodies([box], pairs=[corners], gravity=(0.0, -GRAVITY))
    motion = asp.integrate(system, t_end=1.2)
    path = asp.simulate(system, dt=2e-5, t_end=1.2, sample_every=1.2)
    np.testing.assert_allclose(motion.q[-1], path.q[-1], atol=1e-4)


@pytest.mark.parametrize(
    ("half", "position", "rise", "law"),
    [
        (
            (0.18547577, 0.06015174, 0.15090962),
            0.03548556,
            0.028863,
            asp.FrictionLaw(asp.Ellipse(0.7, 0.5), asp.Ellipse(1.0, 0.5)),
        ),
        ((0.15891891, 0.05253542, 0.19712016), 0.00884243, 0.0388, asp.FrictionLaw.isotropic(0.6)),
    ],
)
def test_a_box_rocks_on_edges_that_lie_nearly_along_a_row(half, position, rise, law):
    """Its corners share the force along the edge, however small the angle to the row."""
    ramp = asp.Signal([0.0, 1.0], [[0, 0, 0], [rise, rise / 2, rise]], interpolation="linear")
    plane = asp.Plane(motion=asp.PlaneMotion(displacement=ramp))
    box = asp.Body.box(1.0, half_sizes=half, position=(position, 0.0, half[2]))
    pair = asp.BoxPlane(0, half_sizes=half, plane=plane, law=law)
    system = asp.RigidBodies([box], pairs=[pair], gravity=(0, 0, -GRAVITY))
    motion = asp.integrate(system, t_end=0.2, tolerance=1e-8)
    path = asp.simulate(system, dt=2e-5, t_end=0.2, sample_every=0.2)
    np.testing.assert_allclose(motion.q[-1], path.q[-1], atol=5e-6)


def time_of_rocking(half, start):
    """The time in which a block on stiff ground rocks to rest, of [Housner1963] (1) and (8)."""
    alpha, radius = np.arctan2(*half), np.hypot(*half)
    rate = 0.75 * GRAVITY / radius
    loss = (1.0 - 1.5 * np.sin(alpha) ** 2) ** 2

    def quarter(top):
        """From the angle `top`, at rest, to the ground, with θ = (1 − s²) top."""

        def time(s):
            turned = 0.5 * top * s**2
            moment = np.sin(alpha - top + turned) * np.sinc(turned / np.pi)
            return 2.0 * top / np.sqrt(2.0 * rate * top * moment)

        return quad(time, 0.0, 1.0, epsabs=0.0)[0]

    def raised(angle):
        """cos(α − θ) − cos α without a difference of cosines."""
        return 2.0 * np.sin(alpha - 0.5 * angle) * np.sin(0.5 * angle)

    total, top = quarter(start), start
    while top > 1e-13:
        left = loss * raised(top)
        top = brentq(lambda angle, left=left: raised(angle) - left, 0.0, top, xtol=1e-25)
        total += 2.0 * quarter(top)
    return total


@pytest.mark.parametrize("tolerance", [1e-6, 1e-10])
@pytest.mark.parametrize("half", [(0.05, 0.2), (0.02, 0.2)])
def test_a_block_rocks_to_rest(half, tolerance):
    alpha = np.arctan2(*half)
    turn = np.array(
        [[np.cos(0.3 * alpha), np.sin(0.3 * alpha)], [-np.sin(0.3 * alpha), np.cos(0.3 * alpha)]]
    )
    position = tuple(turn @ (-half[0], half[1]))
    block = asp.PlanarBody.box(1.0, half_sizes=half, position=position, angle=-0.3 * alpha)
    law = asp.FrictionLaw.isotropic(2.0, dimension=1)
    pair = asp.BoxPlane(0, half_sizes=half, plane=asp.Line(), law=law)
    system = asp.RigidBodies([block], pairs=[pair], gravity=(0.0, -GRAVITY))
    motion = asp.integrate(system, t_end=20.0, tolerance=tolerance)
    expected = time_of_rocking(half, 0.3 * alpha)
    # What rocks lower than 1e-13 of the block is at rest: it would go on for up to 3e-5 s.
    assert motion.events[-1].time == pytest.approx(expected, abs=1e-4)
