"""Friction that depends on the place, against closed forms.

A point that slides straight on under isotropic friction loses ½v² = g ∫ φ(x) μ dx on its way: where
it stops follows from the factor φ alone.
"""

import asperity as asp
import numpy as np
import pytest
from asperity import predict
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

GRAVITY = 9.81
MU = 0.5


def puck(factor, *, speed, angle=0.0, start=(0.0, 0.0), law=None, force=(0.0, 0.0), **plane):
    """A body that touches the floor at its centre only, so that it does not turn."""
    direction = np.array([np.cos(angle), np.sin(angle), 0.0])
    body = asp.Body.ball(
        2.0, radius=0.1, position=(*start, 0.0), velocity=speed * direction, force=(*force, 0.0)
    )
    floor = asp.PointPlane(
        0,
        point=(0.0, 0.0, 0.0),
        plane=asp.Plane(friction_factor=factor, **plane),
        law=asp.FrictionLaw.isotropic(MU) if law is None else law,
    )
    return asp.RigidBodies([body], pairs=[floor])


def beyond(border, angle, factor):
    """The half-plane beyond a line at this distance from the origin, as a large polygon."""
    corners = np.array([(border, -50.0), (border, 50.0), (100.0, 50.0), (100.0, -50.0)])
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return asp.FrictionRegions([(corners @ turn.T, factor)])


def way(motion):
    return float(np.linalg.norm(motion.q[-1, :2] - motion.q[0, :2]))


@pytest.mark.parametrize("seed", range(10))
def test_a_point_stops_beyond_a_border_where_its_energy_is_used_up(seed):
    rng = np.random.default_rng([20, seed])
    angle, tilt = rng.uniform(0.0, 2.0 * np.pi), rng.uniform(-1.0, 1.0)
    distance, left = rng.uniform(0.05, 0.4), rng.uniform(0.01, 0.5)
    speed = np.sqrt(2.0 * GRAVITY * (0.5 * distance + 0.2 * left))
    # The border is oblique to the way and meets it after the distance.
    factor = beyond(distance * np.cos(tilt), angle + tilt, 0.2 / MU)
    system = puck(factor, speed=speed, angle=angle)
    motion = asp.integrate(system, t_end=3.0)
    assert abs(way(motion) - (distance + left)) < 1e-9
    border, stick = motion.events
    assert (border.kind, border.contact, stick.kind) == ("border", 0, "stick")
    at_border = (speed - np.sqrt(2.0 * GRAVITY * 0.2 * left)) / (0.5 * GRAVITY)
    assert abs(border.time - at_border) < 1e-9
    # Time stepping takes a step at the border with one factor or the other.
    errors = [
        abs(way(asp.simulate(system, dt=dt, t_end=3.0)) - (distance + left)) for dt in (1e-3, 1e-4)
    ]
    assert errors[0] < 2e-3
    assert errors[1] < 2e-4


def test_no_strip_is_too_thin_to_be_noticed():
    """Strips that are crossed in a thousandth of the time of a step of `integrate`, and overlap."""
    rng = np.random.default_rng(21)
    starts = np.sort(rng.uniform(0.1, 1.5, 12))
    strips = [
        ([(x, -1.0), (x + 1e-4, -1.0), (x + 1e-4, 1.0), (x, 1.0)], float(rng.uniform(50.0, 99.0)))
        for x in starts
    ]
    speed = 6.0
    used = GRAVITY * MU * sum(1e-4 * (factor - 1.0) for _, factor in strips)
    motion = asp.integrate(puck(asp.FrictionRegions(strips), speed=speed), t_end=3.0)
    assert abs(way(motion) - (0.5 * speed**2 - used) / (GRAVITY * MU)) < 1e-9
    assert [event.kind for event in motion.events] == ["border"] * 24 + ["stick"]


@pytest.mark.parametrize("size", [1e3, 1e6, 1e9])
def test_a_border_is_where_it_is_however_far_its_region_extends(size):
    factor = asp.FrictionRegions(
        [([(0.1, -size), (size, -size), (size, size), (0.1, size)], 0.2 / MU)]
    )
    motion = asp.integrate(puck(factor, speed=1.5), t_end=3.0)
    left = 0.5 * 1.5**2 - GRAVITY * MU * 0.1
    # Rounding of vertices that are so far away.
    assert abs(way(motion) - 0.1 - left / (GRAVITY * 0.2)) < 1e-9 + 4e-15 * size


def test_of_regions_that_overlap_or_touch_the_later_one_counts():
    """A ring of polygons that share corners and edges, crossed along edges' ends and centres."""
    inner = [(0.2, -0.1), (0.4, -0.1), (0.4, 0.1), (0.2, 0.1)]
    outer = [(0.1, -0.2), (0.5, -0.2), (0.5, 0.2), (0.1, 0.2)]
    beside = [(0.5, -0.2), (0.6, -0.2), (0.6, 0.2), (0.5, 0.2)]
    factor = asp.FrictionRegions([(outer, 0.5), (inner, 2.0), (beside, 0.1)], elsewhere=1.0)
    speed = 3.0
    motion = asp.integrate(puck(factor, speed=speed), t_end=3.0)
    used = 0.1 * 1.0 + 0.1 * 0.5 + 0.2 * 2.0 + 0.1 * 0.5 + 0.1 * 0.1
    assert abs(way(motion) - 0.6 - (0.5 * speed**2 / (GRAVITY * MU) - used)) < 1e-9
    # Through the corners of both, and along the edge between two regions.
    for start, angle in (((0.0, -0.3), np.pi / 4), ((0.5, -0.5), np.pi / 2)):
        across = asp.integrate(puck(factor, speed=speed, angle=angle, start=start), t_end=3.0)
        assert across.status == "finished"


@pytest.mark.parametrize("kind", ["raster", "function"])
def test_a_smooth_factor_enters_the_forces(kind):
    x = np.array([-0.2, 0.1, 0.25, 0.6, 1.4])
    values = np.array([0.5, 1.3, 0.4, 2.0, 0.3])
    if kind == "raster":
        factor = asp.FrictionRaster(np.stack([values, values], axis=1), x1=x, x2=[-1.0, 2.0])

        def along(s):
            return np.interp(s, x, values)
    else:

        def factor(x1, x2):
            return 1.0 + 0.5 * np.sin(7.0 * x1) + x2**2

        def along(s):
            return factor(s, 0.0)

    def used(s):
        nodes = [node for node in x if 0.0 < node < s]
        return GRAVITY * MU * quad(along, 0.0, s, points=nodes or None, epsabs=1e-13)[0]

    for speed in (0.5, 1.5, 3.5):
        stops = brentq(lambda s, v=speed: used(s) - 0.5 * v**2, 0.0, 10.0, xtol=1e-13)
        motion = asp.integrate(puck(factor, speed=speed), t_end=5.0)
        assert abs(way(motion) - stops) < 1e-9
        assert [event.kind for event in motion.events] == ["stick"]
        rough = asp.simulate(puck(factor, speed=speed), dt=1e-4, t_end=5.0)
        assert abs(way(rough) - stops) < 1e-4


def test_a_raster_is_bilinear_between_nodes_and_constant_beyond():
    factors = np.array([[1.0, 2.0], [0.5, 4.0]])
    raster = asp.FrictionRaster(factors, x1=[0.0, 2.0], x2=[0.0, 1.0])
    rng = np.random.default_rng(22)
    for place in rng.uniform(-1.0, 3.0, (20, 2)):
        x, y = np.clip(place, 0.0, [2.0, 1.0]) / [2.0, 1.0]
        expected = np.array([1.0 - x, x]) @ factors @ np.array([1.0 - y, y])
        system = puck(raster, speed=1.0, start=place)
        step = asp.simulate(system, dt=1e-9, t_end=2e-9)
        force = np.linalg.norm(step.force[-1, 0])
        assert np.isclose(force, expected * MU * 2.0 * GRAVITY, rtol=1e-6)


def test_the_force_is_that_of_the_law_times_the_factor():
    """Anisotropic laws with drilling: what is reported is γ itself and φ times the law's force."""
    sets = asp.CoulombContensou(0.4), asp.CoulombContensou(0.4)
    law = asp.FrictionLaw(*sets)
    factor = asp.FrictionRegions([([(0.05, -1.0), (5.0, -1.0), (5.0, 1.0), (0.05, 1.0)], 0.3)])
    body = asp.Body.ball(
        1.0,
        radius=0.1,
        position=(0.0, 0.0, 0.1),
        velocity=(1.0, 0.1, 0.0),
        angular_velocity=(0.0, 0.0, 9.0),
    )
    ball = asp.SpherePlane(
        0, radius=0.1, plane=asp.Plane(friction_factor=factor), law=law, patch_radius=0.02
    )
    system = asp.RigidBodies([body], pairs=[ball])
    for run in (
        asp.simulate(system, dt=1e-3, t_end=0.1),
        asp.integrate(system, t_end=0.1, sample_every=1e-3),
    ):
        force, slip, normal = (run.force[1:, 0], run.slip[1:, 0], run.normal_force[1:, 0])
        own = law.force(slip, normal_force=normal)
        ratio = np.linalg.norm(force, axis=1) / np.linalg.norm(own, axis=1)
        assert np.allclose(force, ratio[:, None] * own, atol=1e-9)
        ends = run.q[1:, 0] > 0.05 + 1e-3, run.q[1:, 0] < 0.05 - 1e-3
        assert np.allclose(ratio[ends[0]], 0.3)
        assert np.allclose(ratio[ends[1]], 1.0)
        # The slip is that of the contact point: v and the spin about the normal.
        assert np.allclose(slip[-1, 2], 0.02 * run.u[-1, 5], atol=1e-2)


def test_both_integrators_agree_on_a_box_that_turns_over_a_border():
    half = (0.1, 0.06, 0.02)
    law = asp.FrictionLaw(asp.Ellipse(0.5, 0.3), asp.Ellipse(0.4, 0.35, angle=0.3))
    body = asp.Body.box(
        1.0,
        half_sizes=half,
        position=(0.0, 0.0, 0.02),
        velocity=(1.4, 0.2, 0.0),
        angular_velocity=(0.0, 0.0, 6.0),
    )
    plane = asp.Plane(friction_factor=beyond(0.15, 0.2, 0.4))
    feet = [
        asp.PointPlane(0, point=point, plane=plane, law=law)
        for point in ((0.1, 0.0, -0.02), (-0.07, 0.06, -0.02), (-0.07, -0.06, -0.02))
    ]
    system = asp.RigidBodies([body], pairs=feet)
    motion = asp.integrate(system, t_end=1.0)
    assert [event.kind for event in motion.events].count("border") >= 3
    errors = [
        np.abs(asp.simulate(system, dt=dt, t_end=1.0).q[-1] - motion.q[-1]).max()
        for dt in (1e-3, 1e-4)
    ]
    assert errors[1] < 2e-4
    assert errors[1] < 0.3 * errors[0]


def sledge(half, *, speed, factor, law, yaw_rate=0.0, order=1, laws=None):
    """A box on its four lower corners, with the same law or with those of front and rear feet."""
    body = asp.Body.box(
        1.0,
        half_sizes=half,
        position=(0.0, 0.0, half[2]),
        velocity=(speed, 0.0, 0.0),
        angular_velocity=(0.0, 0.0, yaw_rate),
    )
    corners = [(x, y, -1.0) * np.array(half) for x in (-1.0, 1.0) for y in (-1.0, 1.0)]
    plane = asp.Plane(friction_factor=factor)
    feet = [
        asp.PointPlane(
            0, point=corner, plane=plane, law=law if laws is None else laws[int(corner[0] > 0.0)]
        )
        for corner in corners[::order]
    ]
    return asp.RigidBodies([body], pairs=feet)


@pytest.mark.parametrize("mus", [(0.5, 0.15), (0.15, 0.5)])
def test_feet_on_both_sides_of_a_border_have_loads_of_equal_compliance(mus):
    """Rear and front feet keep to their sides: each has the law that a floor without map gives it.

    With a rounding of yaw they slip alike, but not with the same force: a load on two feet across
    from each other would turn the box.
    """
    half, law = (0.1, 0.06, 0.02), asp.FrictionLaw.isotropic(MU)
    corners = [(0.05, -9.0), (9.0, -9.0), (9.0, 9.0), (0.05, 9.0)]
    regions = asp.FrictionRegions([(corners, mus[1] / MU)], elsewhere=mus[0] / MU)
    laws = [asp.FrictionLaw.isotropic(mu) for mu in mus]
    for order in (1, -1):
        common = {"speed": 1.0, "law": law, "yaw_rate": 1e-10, "order": order}
        ends = [
            run.q[-1]
            for factor, given in ((regions, None), (None, laws))
            for system in [sledge(half, factor=factor, laws=given, **common)]
            for run in (
                asp.integrate(system, t_end=0.1),
                asp.simulate(system, dt=1e-3, t_end=0.1),
                asp.simulate(system, dt=1e-4, t_end=0.1),
            )
        ]
        # Steps are of first order where it slips, alike for both.
        assert np.abs(np.array(ends[:3]) - ends[3:]).max() < 1e-10
        assert np.abs(np.array(ends)[:, 3:] - [1.0, 0.0, 0.0, 0.0]).max() < 1e-9


def test_feet_that_reach_a_border_at_once_cross_it_together():
    """A tall box whose front edge catches on rough ground tips over its edge, and only over it."""
    factor = beyond(0.15, 0.0, 5.0)
    law = asp.FrictionLaw.isotropic(0.2)
    system = sledge((0.05, 0.05, 0.2), speed=1.5, factor=factor, law=law)
    motion = asp.integrate(system, t_end=0.15)
    crossing = [event for event in motion.events if event.kind is asp.EventKind.BORDER]
    assert len({event.time for event in crossing}) == 1
    assert {event.contact for event in crossing} == {2, 3}
    assert np.abs(motion.q[:, [1, 4, 6]]).max() < 1e-9


@pytest.mark.parametrize("share", [0.999, 1.001])
def test_rest_holds_as_long_as_friction_there_does(share):
    factor = beyond(0.1, 0.0, 0.2 / MU)
    for place, mu in ((0.0, MU), (0.2, 0.2)):
        push = share * mu * 2.0 * GRAVITY
        system = puck(factor, speed=0.0, start=(place, 0.0), force=(0.0, push))
        moved = 0.0 if share < 1.0 else 0.5 * (share - 1.0) * mu * GRAVITY
        for run in (asp.integrate(system, t_end=1.0), asp.simulate(system, dt=1e-3, t_end=1.0)):
            assert abs(way(run) - moved) < 1e-9 + 2e-3 * moved


def test_the_map_moves_with_its_plane_and_lies_in_its_axes():
    """On a tilted floor that moves along, the way relative to it is that on the floor at rest."""
    slope = Rotation.from_euler("zyx", [0.7, 0.4, -0.2])
    factor = beyond(0.15, 0.3, 0.4)
    flat = asp.integrate(puck(factor, speed=1.6, angle=0.2), t_end=2.0)
    assert [event.kind for event in flat.events] == ["border", "stick"]
    drift, origin = np.array([0.3, -0.2, 0.1]), np.array([1.0, 2.0, 3.0])
    plane = asp.Plane.oriented(
        slope,
        friction_factor=factor,
        point=origin,
        motion=asp.PlaneMotion(displacement=lambda t: (drift * t, drift)),
    )
    body = asp.Body.ball(
        2.0,
        radius=0.1,
        position=origin,
        velocity=drift + slope.apply(1.6 * np.array([np.cos(0.2), np.sin(0.2), 0.0])),
    )
    floor = asp.PointPlane(0, point=(0.0, 0.0, 0.0), plane=plane, law=asp.FrictionLaw.isotropic(MU))
    weight = slope.apply([0.0, 0.0, -GRAVITY])
    tilted = asp.integrate(asp.RigidBodies([body], pairs=[floor], gravity=weight), t_end=2.0)
    moved = tilted.q[-1, :3] - origin - 2.0 * drift
    assert np.allclose(slope.apply(moved, inverse=True)[:2], flat.q[-1, :2], atol=1e-9)


def test_a_body_that_flies_over_a_border_lands_with_the_friction_there():
    """The impact takes φ μ v_N off the speed along the floor, the way after it begins there."""
    factor = beyond(0.15, 0.0, 0.4)
    mu, along, up = 0.4 * MU, 1.5, 1.0
    body = asp.Body.ball(1.0, radius=0.1, velocity=(along, 0.0, up))
    floor = asp.PointPlane(
        0,
        point=(0.0, 0.0, 0.0),
        plane=asp.Plane(friction_factor=factor),
        law=asp.FrictionLaw.isotropic(MU),
    )
    system = asp.RigidBodies([body], pairs=[floor])
    landed = along * 2.0 * up / GRAVITY
    assert landed > 0.15
    stops = landed + (along - mu * up) ** 2 / (2.0 * GRAVITY * mu)
    motion = asp.integrate(system, t_end=3.0)
    assert [event.kind for event in motion.events] == ["impact", "stick"]
    assert abs(way(motion) - stops) < 1e-9
    assert abs(way(asp.simulate(system, dt=1e-4, t_end=3.0)) - stops) < 1e-3


def test_what_is_not_a_factor_is_refused_by_name():
    square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
    wrong = {
        "regions": lambda: asp.FrictionRegions([(square[:2], 0.5)]),
        "elsewhere": lambda: asp.FrictionRegions([(square, 0.5)], elsewhere=0.0),
        "x1": lambda: asp.FrictionRaster(np.ones((2, 2)), x1=[0.0, 0.0], x2=[0.0, 1.0]),
        "factors": lambda: asp.FrictionRaster(np.zeros((2, 2)), x1=[0.0, 1.0], x2=[0.0, 1.0]),
        "friction_factor": lambda: asp.Plane(friction_factor=0.5),
    }
    for argument, make in wrong.items():
        with pytest.raises(asp.ParameterError, match=argument):
            make()
    for regions in ([(square, -0.5)], 3, None):
        with pytest.raises(asp.ParameterError, match="regions"):
            asp.FrictionRegions(regions)
    rated = asp.FrictionLaw.isotropic(MU).replace(rate=asp.Stribeck(speed=0.1, ratio=0.7))
    with pytest.raises(asp.ParameterError, match="depends on the speed"):
        puck(asp.FrictionRegions([(square, 0.5)]), speed=1.0, law=rated)
    with pytest.raises(asp.ParameterError, match="must return a positive factor, returned -1"):
        asp.simulate(puck(lambda x1, x2: -1.0, speed=1.0), dt=1e-3, t_end=0.1)
    with pytest.raises(asp.ParameterError, match="depends on the place"):
        asp.stability(puck(asp.FrictionRegions([(square, 0.5)]), speed=1.0))


def test_a_run_that_is_interrupted_at_its_start_says_so():
    def factor(x1, x2):
        raise KeyboardInterrupt

    with pytest.raises(asp.errors.SimulationInterrupted, match="before the first sample"):
        asp.integrate(puck(factor, speed=1.0), t_end=1.0)


def test_a_scenario_has_a_floor_with_ice(tmp_path):
    corners = [(0.1, -9.0), (9.0, -9.0), (9.0, 9.0), (0.1, 9.0)]
    listed = str([list(corner) for corner in corners])
    ice = f'{{type = "FrictionRegions", regions = [[{listed}, 0.4]]}}'
    path, _ = predict.write_example("rigid bodies", tmp_path)
    plain = '{type = "Plane"}'
    text = path.read_text().replace(plain, f'{{type = "Plane", friction_factor = {ice}}}')
    path.write_text(text)
    run = predict.simulate_scenario(path)
    system, _ = run.scenario.setup()
    factors = [pair.plane.friction_factor for pair in system.pairs]
    assert factors == [None, asp.FrictionRegions([(corners, 0.4)])]
