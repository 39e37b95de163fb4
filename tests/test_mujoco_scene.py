"""Contacts of MuJoCo models against rigid bodies of the library, closed forms and MuJoCo."""

import copy
import itertools
import multiprocessing
import pickle
from concurrent.futures import ProcessPoolExecutor
from functools import partial

import asperity as asp
import mujoco
import numpy as np
import pytest
from asperity.mujoco import PairLaw, Scene
from asperity.mujoco.model import RowsModel
from profiles import counts

GRAVITY = 9.81
SURFACE = asp.Superellipse(0.54, 0.46, 2.94)
LAWS = {
    "isotropic": asp.FrictionLaw.isotropic(0.4),
    "ellipse": asp.FrictionLaw.associated(asp.Ellipse(0.6, 0.3)),
    "superellipse": asp.FrictionLaw.associated(SURFACE),
    "collinear": asp.FrictionLaw.collinear(asp.Ellipse(0.6, 0.3)),
    "extended": asp.FrictionLaw(SURFACE, asp.Superellipse(1.84, 1.19, 2.51)),
}
HALF_LOAD = asp.FrictionLaw.isotropic(0.5)
DISK = (0.02, 0.02, 0.005)


def model_of(world, *, option="", more=""):
    return mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="0.001" {option}/><worldbody>{world}</worldbody>{more}</mujoco>'
    )


def box(half_sizes=DISK, *, option="", floor="", geom="", more="", height=None):
    sizes, z = " ".join(map(str, half_sizes)), half_sizes[2] if height is None else height
    return model_of(
        f'<geom name="floor" type="plane" size="5 5 .1" {floor}/>'
        f'<body name="body" pos="0 0 {z}"><freejoint/>'
        f'<geom name="box" type="box" size="{sizes}" mass="0.018" {geom}/></body>',
        option=option,
        more=more,
    )


def gravity_of_slope(slope):
    angle = np.arctan(slope)
    return f'gravity="{GRAVITY * np.sin(angle)} 0 {-GRAVITY * np.cos(angle)}"'


@pytest.mark.parametrize("spin", [0.0, 10.0])
@pytest.mark.parametrize("name", LAWS)
def test_a_launched_box_moves_as_that_of_rigid_bodies(name, spin):
    law, model = LAWS[name], box()
    data = mujoco.MjData(model)
    angle = np.deg2rad(58.0)
    velocity = (1.52 * np.cos(angle), 1.52 * np.sin(angle), 0.0)
    data.qvel[:] = *velocity, 0.0, 0.0, spin
    run = Scene(model, {("floor", "box"): law}).simulate(data, t_end=0.5)
    body = asp.Body(
        0.018,
        inertia=model.body_inertia[1],
        position=(0.0, 0.0, 0.005),
        velocity=velocity,
        angular_velocity=(0.0, 0.0, spin),
    )
    pair = asp.BoxPlane(0, half_sizes=DISK, plane=asp.Plane(), law=law)
    bodies = asp.RigidBodies([body], pairs=[pair], gravity=(0.0, 0.0, -GRAVITY))
    expected = asp.simulate(bodies, dt=1e-3, t_end=0.5)
    np.testing.assert_allclose(run.qpos[:, :3], expected.q[:, :3], rtol=0.0, atol=1e-6)
    (x, y), (x0, y0) = run.qpos[-1, :2], expected.q[-1, :2]
    assert abs(np.rad2deg(np.arctan2(y, x) - np.arctan2(y0, x0))) < 1e-4


@counts(1, 10)
def test_half_the_critical_load_holds(count):
    model = box()
    data = mujoco.MjData(model)
    data.qfrc_applied[0] = 0.25 * 0.018 * GRAVITY
    run = Scene(model, {("floor", "box"): HALF_LOAD}).simulate(data, t_end=float(count))
    assert np.abs(run.qvel).max() < 1e-9
    assert np.abs(run.qpos[-1] - run.qpos[0]).max() < 1e-10


def test_slopes_hold_below_the_critical_angle_and_slide_beyond_it():
    for factor in (0.999, 1.001):
        model = box(option=gravity_of_slope(0.5 * factor))
        data = mujoco.MjData(model)
        run = Scene(model, {("floor", "box"): HALF_LOAD}).simulate(data, t_end=1.0)
        angle = np.arctan(0.5 * factor)
        acceleration = GRAVITY * (np.sin(angle) - 0.5 * np.cos(angle))
        expected = 0.5 * max(acceleration, 0.0)
        assert run.qpos[-1, 0] == pytest.approx(expected, rel=1e-6, abs=1e-10)


@pytest.mark.parametrize("degrees", [15, 30, 45, 60, 75])
def test_friction_of_a_slender_box_is_opposite_to_its_motion(degrees):
    model = box((0.04, 0.02, 0.005))
    data, scene = mujoco.MjData(model), Scene(model, {("floor", "box"): HALF_LOAD})
    angle = np.deg2rad(degrees)
    data.qvel[:2] = np.cos(angle), np.sin(angle)
    scene.step(data)
    force = sum(contact.force for contact in scene.contacts(data))
    np.testing.assert_allclose(force[2], 0.018 * GRAVITY, rtol=1e-8)
    assert np.rad2deg(np.arctan2(-force[1], -force[0])) == pytest.approx(degrees, abs=1e-6)
    np.testing.assert_allclose(np.hypot(*force[:2]), 0.5 * 0.018 * GRAVITY, rtol=1e-8)


FEET = [(0.02, 0.02), (-0.02, 0.02), (0.02, -0.02), (-0.02, -0.02)]


@counts(4, 24)
def test_the_order_of_geoms_has_no_effect(count):
    ends = []
    orders = list(itertools.permutations(range(4)))
    for order in orders[:: len(orders) // count]:
        feet = "".join(
            f'<geom name="foot{k}" type="sphere" size="0.005" mass="0.005" friction="0.4"'
            f' pos="{FEET[k][0]} {FEET[k][1]} 0"/>'
            for k in order
        )
        floor = '<geom name="floor" type="plane" size="1 1 .1" friction="0.3"/>'
        body = f'<body pos="0 0 0.005"><freejoint/>{feet}</body>'
        model = model_of(floor + body if order[0] % 2 else body + floor)
        data = mujoco.MjData(model)
        data.qvel[:] = 0.8, 1.2, 0.0, 0.0, 0.0, 10.0
        Scene(model).simulate(data, t_end=0.2)
        ends.append(data.qpos.copy())
    assert np.ptp(ends, axis=0).max() < 1e-9
    assert np.hypot(*ends[0][:2]) > 0.1


def test_the_order_of_boxes_that_fall_on_each_other_has_no_effect():
    """Percussions of two bodies that turn on each other are not unique where these hit."""
    rng = np.random.default_rng(4)
    boxes = []
    for k in range(3):
        turn, place = 0.2 * rng.normal(size=3), rng.uniform(-0.02, 0.02, 2)
        boxes.append(
            f'<body pos="{place[0]:g} {place[1]:g} {0.15 + 0.2 * k:g}"'
            f' quat="1 {turn[0]:g} {turn[1]:g} {turn[2]:g}"><joint name="{k}" type="free"/>'
            f'<geom type="box" size=".08 .08 .05" mass="{rng.uniform(0.5, 2.0):g}"/></body>'
        )
    ends = []
    for order in [(0, 1, 2), (2, 1, 0), (1, 0, 2), (2, 0, 1)]:
        inside = '<geom type="plane" size="5 5 .1"/>' + "".join(boxes[k] for k in order)
        model = model_of(inside)
        data = mujoco.MjData(model)
        Scene(model, starts="project").simulate(data, t_end=0.3)
        ends.append(np.concatenate([data.joint(str(k)).qpos for k in range(3)]))
    assert np.ptp(ends, axis=0).max() < 1e-9
    assert ends[0][9] < 0.25  # the second one lies on the first


@pytest.mark.parametrize("foot", ["<geom {}/>", "<body {}><geom {}/></body>"])
def test_forces_of_feet_without_names_do_not_depend_on_their_order(foot):
    """Of feet that hold, whose forces are not unique."""
    found = []
    for order in [(0, 1, 2, 3), (2, 0, 3, 1), (3, 2, 1, 0)]:
        places = [f'pos="{FEET[k][0]} {FEET[k][1]} 0"' for k in order]
        one = foot.replace("<geom {}", '<geom size=".005" {}')
        feet = "".join(one.format(place, "") for place in places)
        model = model_of(
            f'<geom type="plane" size="1 1 .1"/><body pos="0 0 .005"><freejoint/>{feet}</body>'
        )
        data, scene = mujoco.MjData(model), Scene(model)
        weight = model.body_subtreemass[0] * GRAVITY
        data.qfrc_applied[:] = 0.5 * weight, 0.2 * weight, 0.0, 0.0, 0.0, 0.002 * weight
        scene.simulate(data, t_end=0.005)
        forces = {tuple(c.position[:2].round(3)): c.force / weight for c in scene.contacts(data)}
        found.append([forces[place] for place in FEET])
    assert np.ptp(found, axis=0).max() < 1e-9


def test_a_tower_of_turned_boxes_keeps_its_points_and_stands():
    world = "".join(
        f'<body pos="0 0 {0.1 + 0.2 * k}" euler="0 0 {20 * k}"><freejoint/>'
        '<geom type="box" size=".1 .1 .1"/></body>'
        for k in range(3)
    )
    model = model_of('<geom type="plane" size="1 1 .1"/>' + world)
    data, scene = mujoco.MjData(model), Scene(model)
    for k in range(200):
        scene.step(data)
        assert data.ncon == 4 + 8 + 8
        if k > 1:
            assert np.abs(data.qvel).max() < 1e-8
    np.testing.assert_allclose(data.qpos[2::7], [0.1, 0.3, 0.5], atol=1e-5)


def test_laws_lie_on_what_carries_them():
    """The force is that of the law in the axes of the plate, of the body, or of the world."""
    law, turn = asp.FrictionLaw.associated(asp.Ellipse(0.6, 0.2)), np.deg2rad(30.0)
    first = (np.cos(turn), np.sin(turn))
    for key, value, axis in [
        (("floor", "box"), law, first),
        (("box", "floor"), law, (1.0, 0.0)),
        (("floor", "body"), PairLaw(law, carried_by="body", axis=(0, 1, 0)), (0.0, 1.0)),
        (("box", "floor"), PairLaw(law, carried_by="floor", axis=(0, 2, 0)), (-first[1], first[0])),
        (("floor", "box"), PairLaw(law, carried_by="world"), (1.0, 0.0)),
        ("default", law, (1.0, 0.0)),
    ]:
        model = box(floor='euler="0 0 30"')
        data = mujoco.MjData(model)
        data.qvel[:2] = 0.7, 0.4
        scene = Scene(model, {key: value})
        scene.step(data)
        force = sum(contact.force for contact in scene.contacts(data))[:2]
        axes = np.array([axis, (-axis[1], axis[0])])
        slip = axes @ data.qvel[:2]
        expected = axes.T @ law.force(slip, normal_force=0.018 * GRAVITY)
        np.testing.assert_allclose(force, expected, atol=1e-6, err_msg=str((key, value)))


def test_an_axis_along_the_normal_leaves_its_place_to_the_next():
    law = asp.FrictionLaw.associated(asp.Ellipse(0.6, 0.2))
    normal = np.full(3, 3**-0.5)
    x, y, z = 0.1 * normal
    model = model_of(
        '<geom name="wall" type="plane" size="1 1 .1" zaxis="1 1 1"/>'
        f'<body pos="{x} {y} {z}"><freejoint/><geom name="ball" size=".1" mass="1"/></body>',
        option='gravity="-5 -5 -5"',
    )
    data = mujoco.MjData(model)
    data.qvel[:3] = 1.0, -1.0, 0.0
    scene = Scene(model, {("wall", "ball"): PairLaw(law, axis=(1, 1, 1), carried_by="world")})
    scene.step(data)
    first = np.array([0.0, 1.0, 0.0]) - normal[1] * normal
    axes = np.array(
        [first / np.linalg.norm(first), np.cross(normal, first) / np.linalg.norm(first)]
    )
    force = scene.contacts(data)[0].force
    slip = axes @ (data.qvel[:3] + np.cross(data.qvel[3:], -0.1 * normal))
    expected = law.force(slip, normal_force=float(force @ normal))
    np.testing.assert_allclose(axes @ force, expected, rtol=1e-6)


def test_a_law_that_is_not_symmetric_has_the_slip_of_the_second_of_the_pair():
    """Scales slide one way and hold the other, whichever geom MuJoCo lists first."""
    scales = asp.FrictionLaw.associated(
        asp.Polygon([(-0.8, -0.3), (0.2, -0.3), (0.2, 0.3), (-0.8, 0.3)])
    )
    for key in (("floor", "box"), ("box", "floor")):
        model = box()
        for sense in (1.0, -1.0):
            data = mujoco.MjData(model)
            data.qvel[0] = sense
            Scene(model, {key: scales}).step(data)
            slip = sense if key[0] == "floor" else -sense
            expected = -scales.force([slip, 0.0], normal_force=1.0)[0] * slip
            measured = (1.0 - abs(data.qvel[0])) / (1e-3 * GRAVITY)
            assert measured == pytest.approx(expected, rel=1e-6)


def test_drilling_brakes_a_spin():
    """Of condim 4, and of a law with a patch: I dω/dt = −r N with r in m."""
    for law, floor in [
        (None, 'condim="4" friction="0.4 0.003 0"'),
        (asp.FrictionLaw.associated(asp.Ellipsoid((0.4, 0.4, 0.3))), ""),
    ]:
        model = model_of(
            f'<geom name="floor" type="plane" size="1 1 .1" {floor}/><body pos="0 0 .02">'
            '<freejoint/><geom name="ball" type="sphere" size=".02" mass=".1"'
            ' friction="0.4 0.003 0"/></body>'
        )
        laws = {("floor", "ball"): PairLaw(law, patch_radius=0.01)} if law else {}
        data, scene = mujoco.MjData(model), Scene(model, laws)
        data.qvel[5] = 3.0
        run = scene.simulate(data, t_end=0.01)
        torque = 0.003 * 0.1 * GRAVITY
        np.testing.assert_allclose(
            run.qvel[:, 5], 3.0 - torque / (0.4 * 0.1 * 0.02**2) * run.t, atol=1e-8
        )
        assert scene.contacts(data)[0].torque == pytest.approx(-torque, rel=1e-6)


def test_a_conveyor_carries_a_box():
    model = box(floor='surfacevel="1 0 0" friction="0.5"', geom='friction="0.5"')
    data = mujoco.MjData(model)
    reference = mujoco.MjData(model)
    Scene(model).simulate(data, t_end=0.1)
    while reference.time < 0.0995:
        mujoco.mj_step(model, reference)
    assert data.qvel[0] == pytest.approx(0.5 * GRAVITY * 0.1, rel=1e-6)
    assert np.sign(reference.qvel[0]) == 1.0


def test_contacts_that_come_from_afar_are_found_in_time():
    """A ball at 8 m/s with a step of 10 ms, 80 mm a step, of 20 mm radius."""
    model = model_of(
        '<geom type="plane" size="1 1 .1"/><body pos="0 0 1"><freejoint/>'
        '<geom type="sphere" size=".02"/></body>',
    )
    model.opt.timestep = 0.01
    data, scene = mujoco.MjData(model), Scene(model)
    data.qvel[2] = -8.0
    lowest = min(scene.step(data) and data.qpos[2] for _ in range(100))
    assert lowest > 0.02 - 1e-9
    assert data.qpos[2] == pytest.approx(0.02, abs=1e-8)
    assert abs(data.qvel[2]) < 1e-8


@pytest.mark.parametrize("shape", ['"box" size=".1 .07 .05"', '"cylinder" size=".07 .1"'])
def test_points_are_found_in_time_where_others_of_the_pair_touch(shape):
    """A body that tumbles on a plane never gains energy, whichever of its corners lands next."""
    world = (
        '<geom type="plane" size="9 9 .1"/><body pos="0 0 .4"><freejoint/><geom type={}/></body>'
    )
    flag = '<option><flag energy="enable"/></option>'
    model = model_of(world.format(shape), more=flag)
    for seed in range(10):
        data = mujoco.MjData(model)
        data.qvel[:] = np.random.default_rng(seed).normal(size=6) * [1, 1, 1, 8, 8, 8]
        energy = Scene(model).simulate(data, t_end=1.2, keep=("energy",)).energy.sum(axis=1)[1:]
        assert np.diff(energy).max() < 1e-5 * energy.max()


@pytest.mark.parametrize("turned", [0, 7, 11.25])
@pytest.mark.parametrize("degrees", [1, 4])
def test_a_rod_rests_on_the_rim_of_a_disk_and_not_on_a_polygon(degrees, turned):
    """Along a radius and tilted by t, its axis is ρ/cos t above the rim.

    On a polygon of 16 corners it would be up to r (1 − cos π/16) tan t lower.
    """
    model = model_of(
        f'<geom type="cylinder" size=".1 .004" euler="0 0 {turned}"/><body pos="-.1 0 .1">'
        f'<joint type="slide" axis="0 0 1"/><geom type="capsule" size=".02 .08" '
        f'euler="0 {90 - degrees} 0"/></body>'
    )
    model.opt.timestep = 0.002
    data = mujoco.MjData(model)
    Scene(model).simulate(data, t_end=0.3)
    height = 0.004 + 0.02 / np.cos(np.deg2rad(degrees))
    assert data.qpos[0] + 0.1 == pytest.approx(height, abs=10 * model.opt.ccd_tolerance)


def test_a_step_that_was_interrupted_leaves_no_trace_in_the_scene(monkeypatch):
    """Where nearest points alone are looked for, which every step after would have taken."""
    model = model_of(
        '<geom type="cylinder" size=".1 .004" euler="0 0 7"/><body pos="-.1 0 .025">'
        '<joint type="slide" axis="0 0 1"/><geom type="capsule" size=".02 .08" euler="0 86 0"/>'
        "</body>"
    )
    model.opt.timestep = 0.002
    find, nearest = mujoco.mj_collision, int(mujoco.mjtDisableBit.mjDSBL_MULTICCD)

    def interrupted(m, d):
        if int(m.opt.disableflags) & nearest:
            raise KeyboardInterrupt
        find(m, d)

    data, scene = mujoco.MjData(model), Scene(model)
    with monkeypatch.context() as patched:
        patched.setattr(mujoco, "mj_collision", interrupted)
        with pytest.raises(KeyboardInterrupt):
            scene.simulate(data, t_end=0.04)
    other = mujoco.MjData(model)
    other.qpos[:], other.qvel[:], other.time = data.qpos, data.qvel, data.time
    scene.step(data)
    Scene(model).step(other)
    assert data.ncon == other.ncon > 1
    np.testing.assert_allclose(data.qpos, other.qpos, atol=1e-9)


@pytest.mark.parametrize(
    ("floor", "body", "seed"),
    [
        ('"box" size=".5 .5 .1" pos="0 0 -.1"', '"cylinder" size=".07 .1"', 10),
        ('"box" size=".5 .5 .1" pos="0 0 -.1"', '"cylinder" size=".1 .01"', 6),
        ('"cylinder" size=".06 .5" euler="90 0 0"', '"cylinder" size=".07 .1"', 6),
        ('"cylinder" size=".06 .5" euler="90 0 0"', '"cylinder" size=".1 .01"', 9),
    ],
)
def test_what_tumbles_over_faces_and_edges_does_not_go_into_them(floor, body, seed):
    """Deeper than it rests, 1e-5 of its radius, and than distances are known."""
    model = model_of(
        f'<geom type={floor}/><body pos="0 0 .25"><freejoint/><geom type={body}/></body>'
    )
    model.opt.timestep = 0.002
    data, at, scene = mujoco.MjData(model), mujoco.MjData(model), Scene(model)
    data.qvel[:] = np.random.default_rng(seed).normal(size=6) * [0.4, 0.4, 1, 8, 8, 8]
    deepest = 0.0
    for _ in range(150):
        scene.step(data)
        at.qpos[:] = data.qpos
        mujoco.mj_kinematics(model, at)
        deepest = max(deepest, -mujoco.mj_geomDistance(model, at, 0, 1, 1.0, None))
    assert 0.0 < deepest < 1e-5 * model.geom_rbound.min() + 11 * model.opt.ccd_tolerance


@pytest.mark.parametrize("cone", ["pyramidal", "elliptic"])
def test_forces_are_where_mujoco_has_them(cone):
    sensors = (
        '<sensor><touch site="under"/><force site="under"/></sensor>'
        '<actuator><motor joint="push" gear="1"/></actuator>'
    )
    model = model_of(
        '<geom name="floor" type="plane" size="1 1 .1"/><body name="block" pos="0 0 .05">'
        '<joint name="push" type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/>'
        '<geom type="box" size=".05 .05 .05" mass="2" friction=".5"/>'
        '<site name="under" type="box" size=".06 .06 .06"/></body>',
        option=f'cone="{cone}"',
        more=sensors,
    )
    data, scene = mujoco.MjData(model), Scene(model, {("floor", "block"): HALF_LOAD})
    data.ctrl[0] = 3.0
    for _ in range(3):
        scene.step(data)
    mujoco.mj_rnePostConstraint(model, data)
    np.testing.assert_allclose(data.cfrc_ext[1, 3:], [-3.0, 0.0, 2 * GRAVITY], atol=1e-6)
    np.testing.assert_allclose(data.qfrc_constraint, [-3.0, 2 * GRAVITY], atol=1e-6)
    np.testing.assert_allclose(data.qacc, 0.0, atol=1e-6)
    assert data.sensordata[0] == pytest.approx(2 * GRAVITY, rel=1e-6)
    assert data.time == pytest.approx(0.003)


def test_accelerations_of_sensors_are_those_of_their_step():
    """A box that falls and then rests."""
    names = ("accelerometer", "force")
    model = box(
        height=0.006,
        geom='/><site name="s"',
        more="<sensor>" + "".join(f'<{name} site="s"/>' for name in names) + "</sensor>",
    )
    data, scene = mujoco.MjData(model), Scene(model)
    for rests, steps in ((False, 3), (True, 100)):
        for _ in range(steps):
            scene.step(data)
        upwards = data.sensordata.reshape(2, 3)
        np.testing.assert_allclose(upwards[0], [0.0, 0.0, GRAVITY * rests], atol=1e-6)
        np.testing.assert_allclose(upwards[1], 0.0, atol=1e-6)


def test_contacts_that_are_near_and_open_have_no_force():
    model = box(option='cone="pyramidal"', height=0.00500001)
    data, scene = mujoco.MjData(model), Scene(model)
    data.qvel[2] = 1e-3
    for _ in range(3):
        data.qfrc_applied[2] = 0.018 * GRAVITY
        scene.step(data)
        assert data.ncon == 4
        assert data.nefc == 16
        assert not data.efc_force.any()


def test_activations_and_damping_advance_as_in_mujoco():
    joint = '<body><joint name="j" axis="0 0 1" damping="2"/><geom size=".1"/></body>'
    actuator = '<actuator><general joint="j" dyntype="filterexact" dynprm="0.02"/></actuator>'
    model = model_of(joint, more=actuator)
    ours, theirs, scene = mujoco.MjData(model), mujoco.MjData(model), Scene(model)
    for data in (ours, theirs):
        data.ctrl[0], data.qvel[0] = 1.0, 3.0
    for _ in range(20):
        scene.step(ours)
        mujoco.mj_step(model, theirs)
    np.testing.assert_array_equal(ours.act, theirs.act)
    np.testing.assert_allclose(ours.qvel, theirs.qvel, rtol=1e-13)
    assert ours.time == theirs.time
    mass = np.zeros((1, 1))
    mujoco.mj_fullM(model, ours, mass)
    assert mass[0, 0] == pytest.approx(model.dof_M0[0])


def test_a_tumbling_body_keeps_its_energy():
    """Once would gain 8 % in 10 s, as MuJoCo's Euler does."""
    model = model_of(
        '<body><freejoint/><geom type="box" size=".1 .2 .3" mass="1"/></body>',
        option='gravity="0 0 0"',
        more='<option><flag energy="enable"/></option>',
    )
    data = mujoco.MjData(model)
    data.qvel[3:] = 3.0, 4.0, 5.0
    run = Scene(model).simulate(data, t_end=2.0)
    spin = run.qvel[:, 3:]
    energy = (spin**2 * model.body_inertia[1]).sum(axis=1)
    np.testing.assert_allclose(energy, energy[0], rtol=1e-5)
    assert data.energy[1] == pytest.approx(0.5 * energy[-1], rel=1e-12)


def bytes_of(model):
    buffer = np.empty(mujoco.mj_sizeModel(model), np.uint8)
    mujoco.mj_saveModel(model, None, buffer)
    return buffer.tobytes()


def test_the_model_of_the_user_stays_as_it_is():
    model = box(geom='condim="1"')
    before, data = bytes_of(model), mujoco.MjData(model)
    Scene(model, {("floor", "box"): HALF_LOAD}).step(data)
    assert bytes_of(model) == before


def pickled(scene):
    return pickle.loads(pickle.dumps(scene))


LIFT = (
    '<body name="hand" mocap="true" pos="0 0 .1"><geom name="hand" type="box" size=".1 .1 .01"/>'
    '</body><body name="load" pos="0 0 .13"><freejoint/>'
    '<geom name="load" type="box" size=".02 .02 .02"/></body>'
)


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, pickled])
def test_copies_do_what_the_original_does_with_other_data(copied):
    """They have laws and options of their own, and forget the percussions and the mocap bodies."""
    model = model_of(LIFT)
    grooved = PairLaw(LAWS["ellipse"], axis=(0.0, 1.0, 0.0), carried_by="load")
    options = {"normal_restitution": 0.3, "on_failure": "record", "tolerance": 1e-9}
    scene = Scene(model, {("hand", "load"): grooved}, solver=asp.Exact(), **options)
    data = mujoco.MjData(model)
    data.qvel[:2] = 1.0, 0.5
    scene.simulate(data, t_end=0.01)
    again, own = copied(scene), copy.copy(data)
    assert repr(again) == repr(scene)
    assert again.problem(own).laws == scene.problem(copy.copy(data)).laws
    theirs = copy.copy(data)
    for _ in range(20):
        again.step(own)
        scene.step(theirs)
        assert np.array_equal(own.qpos, theirs.qpos)
        assert np.array_equal(own.efc_force, theirs.efc_force)
    scene.simulate(data, t_end=0.02)
    data.mocap_pos[0, 2] += 1e-4
    own = copy.copy(data)
    with pytest.raises(asp.ParameterError, match=r"contact of 'hand' and 'load' by 0\.0001"):
        copied(scene).step(own)
    assert scene.step(data).solution.converged
    assert data.qvel[2] > 0.05


class Watched(Scene):
    """A scene of its own arguments, which counts its steps."""

    def __init__(self, name, model):
        self.name, self.passed = name, []
        super().__init__(model, {("floor", "box"): HALF_LOAD}, tolerance=1e-9)
        self.view = self

    def step(self, data):
        self.passed.append(data.time)
        return super().step(data)


class Counted(Watched):
    """Says itself what its copies know."""

    def __getstate__(self):
        return len(self.passed)

    def __setstate__(self, state):
        self.passed = [None] * state


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, pickled])
def test_copies_of_a_subclass_are_of_it(copied):
    model = box()
    scene, data = Watched("desk", model), mujoco.MjData(model)
    scene.note = "of the user"
    scene.step(data)
    again, own = copied(scene), copy.copy(data)
    assert type(again) is Watched
    assert (again.name, again.note, again.passed) == ("desk", "of the user", [0.0])
    assert again.view is (scene if copied is copy.copy else again)
    assert (again.passed is scene.passed) == (copied is copy.copy)
    assert set(vars(again)) == set(vars(scene))
    theirs = copy.copy(data)
    scene.step(theirs)
    again.step(own)
    assert np.array_equal(own.qpos, theirs.qpos)
    assert repr(again) == repr(scene) == "<Watched: 2 geoms, 6 velocities, dt 0.001 s>"
    counted = Counted("desk", model)
    counted.step(mujoco.MjData(model))
    assert copied(counted).passed == [None]
    assert copied(copied(scene)).name == "desk"
    assert "note" not in vars(copied(Scene(model)))


def end_of(scene, speed, model):
    data = mujoco.MjData(model)
    data.qvel[0] = speed
    return scene.simulate(data, t_end=0.02), scene.contacts(data)


def test_scenes_and_their_runs_go_to_other_processes():
    model = box()
    scene, speeds = Scene(model, {("floor", "box"): HALF_LOAD}), (0.3, 1.0)
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as pool:
        there = list(pool.map(partial(end_of, scene, model=model), speeds))
    for speed, (run, contacts) in zip(speeds, there, strict=True):
        own, here = end_of(scene, speed, model)
        assert np.array_equal(run.qpos, own.qpos)
        assert [c.geoms for c in contacts] == [c.geoms for c in here]


def test_changes_of_the_model_of_the_user_come_too_late():
    """Also where the scene looks at it later, as for the dimension of a new contact."""
    model, changed = box(height=0.03), box(height=0.03)
    scenes = [Scene(m, normal_restitution=0.2) for m in (model, changed)]
    changed.geom_condim[:], changed.geom_gap[:], changed.opt.gravity[2] = 1, 0.01, -1.0
    ours, theirs = (mujoco.MjData(m) for m in (model, changed))
    for scene, data in zip(scenes, (ours, theirs), strict=True):
        data.qvel[0] = 1.0
        scene.simulate(data, t_end=0.1)
    assert np.array_equal(ours.qpos, theirs.qpos)


GLUE = '<actuator><adhesion body="body" gain="1" ctrlrange="0 9"/></actuator>'


@pytest.mark.parametrize(("pull", "holds"), [(1.001, True), (0.999, False)])
def test_adhesion_holds_a_box_below_a_ceiling(pull, holds):
    """As long as it pulls more than the weight, which the normal force makes up for."""
    model = box(floor=f'pos="0 0 {DISK[2]}" zaxis="0 0 -1"', more=GLUE, height=0.0)
    scene, data = Scene(model, {"default": asp.FrictionLaw.isotropic(0.5)}), mujoco.MjData(model)
    weight = 0.018 * GRAVITY
    data.ctrl[:] = pull * weight
    scene.simulate(data, t_end=0.5)
    assert (abs(data.qvel[2]) < 1e-9) == holds
    pressed = sum(contact.force[2] for contact in scene.contacts(data))
    assert abs(abs(pressed) - (pull - 1.0) * weight * holds) < 1e-8 * weight


def test_adhesion_adds_to_the_friction_of_a_box():
    model = box(more=GLUE)
    scene, data = Scene(model, {"default": asp.FrictionLaw.isotropic(0.5)}), mujoco.MjData(model)
    data.ctrl[:], data.qvel[0] = 0.3, 1.0
    scene.simulate(data, t_end=0.02)
    deceleration = 0.5 * (GRAVITY + 0.3 / 0.018)
    assert abs(data.qvel[0] - (1.0 - 0.02 * deceleration)) < 1e-8


# Pulls at every contact: of geoms, which add up or have a priority, and of a pair.
STICKY = [
    ('adhesion="0.1"', 'adhesion="0.2"', "", 0.3),
    ('adhesion="0.1" priority="1"', 'adhesion="0.2"', "", 0.1),
    ("", 'adhesion="0.2"', '<pair geom1="floor" geom2="box" adhesion="0.4" condim="3"/>', 0.4),
]


@pytest.mark.parametrize(("floor", "geom", "pair", "pull"), STICKY)
def test_adhesion_of_geoms_adds_to_the_friction_of_a_box(floor, geom, pair, pull):
    more = f"<contact>{pair}</contact>"
    model = box(floor=floor, geom=geom, more=more)
    data, theirs = mujoco.MjData(model), mujoco.MjData(model)
    law = asp.FrictionLaw.isotropic(0.5)
    data.qvel[0], scene = 2.0, Scene(model, {("floor", "box"): law})
    scene.simulate(data, t_end=0.02)
    assert abs(data.qvel[0] - (2.0 - 0.02 * 0.5 * (GRAVITY + 4.0 * pull / 0.018))) < 1e-8
    mujoco.mj_forward(model, theirs)
    np.testing.assert_allclose(data.qfrc_passive, theirs.qfrc_passive, atol=1e-12)


@pytest.mark.parametrize(("pull", "holds"), [(1.001, True), (0.999, False)])
def test_adhesion_of_a_geom_holds_a_ball_below_a_ceiling(pull, holds):
    model = model_of(
        '<geom type="plane" size="1 1 .1" pos="0 0 1" zaxis="0 0 -1"/>'
        '<body pos="0 0 .9"><freejoint/>'
        f'<geom size=".1" mass="1" adhesion="{pull * GRAVITY}"/></body>'
    )
    data = mujoco.MjData(model)
    Scene(model).simulate(data, t_end=0.2)
    assert (abs(data.qvel[2]) < 1e-9) == holds


@pytest.mark.parametrize("gaps", [(0.0, 0.001), (0.001, 0.001)])
@pytest.mark.parametrize("margins", [(0.0, 0.0), (0.001, 0.002)])
def test_adhesion_reaches_as_far_as_that_of_mujoco(gaps, margins):
    for part in (0.9, 1.1):
        floor, geom = (f'gap="{g}" margin="{m}"' for g, m in zip(gaps, margins, strict=True))
        height = DISK[2] + sum(margins) + part * sum(gaps)
        model = box(floor=floor, geom=f'{geom} adhesion="0.2"', more=GLUE, height=height)
        ours, theirs = mujoco.MjData(model), mujoco.MjData(model)
        ours.ctrl[:] = theirs.ctrl[:] = 1.0
        mujoco.mj_forward(model, theirs)
        Scene(model).step(ours)
        np.testing.assert_allclose(ours.qfrc_actuator, theirs.qfrc_actuator, atol=1e-9)
        np.testing.assert_allclose(ours.qfrc_passive, theirs.qfrc_passive, atol=1e-9)
        assert theirs.qfrc_passive.any() == (part < 1.0)


def test_what_has_no_rigid_rows_is_refused_by_name():
    rolling = box(geom='condim="6"')
    with pytest.raises(asp.ParameterError, match=r"condim 6\) at geom 'box'"):
        Scene(rolling)
    assert Scene(rolling, rolling="ignore").step(mujoco.MjData(rolling)).solution.converged
    rolling.opt.timestep = 0.0
    with pytest.raises(asp.ParameterError, match="positive timestep, has 0"):
        Scene(rolling)
    cloth = model_of('<flexcomp name="f" type="grid" count="2 2 1" dim="2" spacing=".1 .1 .1"/>')
    with pytest.raises(asp.ParameterError, match="flex"):
        Scene(cloth)


def test_contacts_that_do_not_fit_into_the_memory_are_not_dropped_without_a_word():
    world = '<geom type="plane" size="5 5 .1"/>' + "".join(
        f'<body pos="{k % 9} {k // 9} .1"><freejoint/><geom type="box" size=".1 .1 .1"/></body>'
        for k in range(81)
    )
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><size memory="300K"/><worldbody>{world}</worldbody></mujoco>'
    )
    with pytest.raises(asp.ParameterError, match="memory for all contacts"):
        Scene(model).step(mujoco.MjData(model))


def test_forces_that_are_not_finite_end_by_name_and_leave_the_state():
    model = box()
    data = mujoco.MjData(model)
    data.qfrc_applied[0] = np.inf
    with pytest.raises(asp.ParameterError, match=r"finite velocities.* qfrc_applied is not finite"):
        Scene(model).step(data)
    data.qfrc_applied[0] = 1e200
    with pytest.raises(asp.ParameterError, match=r"finite velocities.* smaller timestep"):
        Scene(model).step(data)
    np.testing.assert_array_equal(data.qpos, model.qpos0)
    np.testing.assert_array_equal(data.qvel, 0.0)


FLOOR_AND_BASE = (
    '<geom name="floor" type="plane" size="1 1 .1"/><body name="base"/>'
    '<body name="ball"><freejoint/><geom name="box" size=".1"/></body>'
)


@pytest.mark.parametrize(
    ("laws", "message"),
    [
        ({("floor", "bix"): HALF_LOAD}, "'bix', which no geom or body"),
        ({"floor": HALF_LOAD}, "pairs of names"),
        ({("floor", "box"): 0.5}, "a FrictionLaw or a PairLaw"),
        ({("floor", "box"): asp.FrictionLaw.isotropic(0.5, dimension=1)}, "dimension 2 or 3"),
        (
            {("floor", "box"): asp.FrictionLaw.associated(asp.Ellipsoid((0.4, 0.4, 0.3)))},
            "patch_radius",
        ),
        ([HALF_LOAD], "must be a mapping"),
        ({("floor", "base"): HALF_LOAD}, "body 'base', which has no geoms"),
        ({("floor", "box"): HALF_LOAD, ("box", "floor"): HALF_LOAD}, "and the reverse"),
        (
            {"default": PairLaw(HALF_LOAD, friction_factor=lambda x1, x2: 1.0)},
            "name the pairs of a friction_factor",
        ),
        ({("box", "box"): HALF_LOAD}, r"\('box', 'box'\), which MuJoCo never lets touch"),
        (
            {("ball", "floor"): HALF_LOAD, ("box", "world"): HALF_LOAD},
            r"\('ball', 'floor'\) and \('box', 'world'\), both for 'box' and 'floor'",
        ),
    ],
)
def test_laws_are_checked(laws, message):
    with pytest.raises(asp.AsperityError, match=message):
        Scene(model_of(FLOOR_AND_BASE), laws)


def test_the_pair_of_geoms_decides_between_pairs_of_bodies():
    """Also between those that would leave open which of them holds, in any order."""
    others = asp.FrictionLaw.isotropic(0.1)
    laws = {("ball", "floor"): others, ("box", "floor"): HALF_LOAD, ("box", "world"): others}
    model = model_of(FLOOR_AND_BASE)
    for order in itertools.permutations(laws):
        data = mujoco.MjData(model)
        data.qpos[2], data.qvel[0] = 0.1, 1.0
        Scene(model, {key: laws[key] for key in order}).step(data)
        slowed = 0.5 * GRAVITY * model.opt.timestep
        assert 1.0 - data.qvel[0] == pytest.approx(slowed, rel=1e-6), order


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda model: None, "mujoco.MjData"),
        (lambda model: model, "mujoco.MjData"),
        (lambda model: mujoco.MjData(box((0.03, 0.02, 0.01))), "of the scene's model"),
        (lambda model: mujoco.MjData(model_of("<geom size='1'/>")), "of the scene's model"),
        (lambda model: spoilt(model, "qvel"), "finite qpos and qvel"),
        (lambda model: spoilt(model, "qpos"), "finite qpos and qvel"),
    ],
)
def test_data_are_checked(change, message):
    scene, data = Scene(model := box()), change(model)
    for call in (scene.step, scene.problem, scene.project, lambda d: scene.simulate(d, t_end=1.0)):
        with pytest.raises(asp.ParameterError, match=message):
            call(data)
    with pytest.raises(asp.ParameterError, match=r"mujoco\.MjModel, got 'a\.xml'"):
        Scene("a.xml")


def spoilt(model, name):
    data = mujoco.MjData(model)
    getattr(data, name)[1] = np.nan
    return data


@pytest.mark.parametrize(
    ("first", "more"),
    [
        ('contype="2" conaffinity="2"', ""),
        ("", '<contact><exclude body1="world" body2="body"/></contact>'),
    ],
)
def test_laws_of_geoms_that_never_touch_are_refused(first, more):
    model = box(geom=first, more=more)
    data = mujoco.MjData(model)
    data.qpos[2] -= 0.001
    mujoco.mj_forward(model, data)
    assert data.ncon == 0
    with pytest.raises(asp.ParameterError, match="never lets touch"):
        Scene(model, {("floor", "box"): HALF_LOAD})


def test_what_may_touch_is_what_mujoco_lets_touch():
    """Overlapping geoms of one body, of parent, child and grandchild, welded ones and the world."""
    rng = np.random.default_rng(0)
    for _ in range(30):
        depth = iter(range(5))

        def chain(depth=depth):
            k = next(depth, None)
            if k is None:
                return ""
            joint = "<joint/>" if rng.random() < 0.7 else ""
            mask = f'contype="{rng.integers(4)}" conaffinity="{rng.integers(4)}"'
            geoms = f'<geom name="{k}" size=".1" {mask}/><geom name="{k}+" size=".1"/>'
            return f'<body name="b{k}">{joint}{geoms}{chain(depth)}</body>'

        parent = rng.random() < 0.5
        flag = '<flag filterparent="disable"/>' if parent else ""
        model = mujoco.MjModel.from_xml_string(
            f'<mujoco><option>{flag}</option><worldbody><geom name="w" size=".1"/>{chain()}'
            '</worldbody><contact><exclude body1="b4" body2="b1"/><pair geom1="0" geom2="4"/>'
            "</contact></mujoco>"
        )
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        touching = {frozenset(pair) for pair in data.contact.geom.tolist()}
        rows = RowsModel(model, ignore_rolling=False)
        for one, other in itertools.combinations(range(model.ngeom), 2):
            assert rows.may_touch(one, other) == (frozenset((one, other)) in touching)


def test_two_pairs_of_the_same_geoms_are_refused():
    pair = '<pair geom1="floor" geom2="box"/>'
    model = box(more=f'<contact>{pair}<pair geom1="box" geom2="floor" condim="1"/></contact>')
    with pytest.raises(asp.ParameterError, match="two <pair> of the geoms 'floor' and 'box'"):
        Scene(model)


CART = (
    '<geom name="floor" type="plane" size="1 1 .1" friction=".4 .003 0" {floor}/>'
    '<body name="cart" pos="0 0 .02"><joint type="slide" axis="1 0 0"/>'
    '<joint type="slide" axis="0 0 1"/>{joint}'
    '<geom name="foot" type="box" size=".02 .02 .02" mass="1" friction=".4 .003 0"/></body>'
)


def test_a_law_with_drilling_where_nothing_can_drill_names_the_geoms():
    law = asp.FrictionLaw.associated(asp.Ellipsoid((0.4, 0.4, 0.3)))
    model = model_of(CART.format(floor="", joint='<joint type="slide" axis="0 1 0"/>'))
    scene = Scene(model, {("floor", "foot"): PairLaw(law, patch_radius=0.01)})
    with pytest.raises(asp.ParameterError, match=r"drill and slide: contact of 'floor' and 'foot'"):
        scene.step(mujoco.MjData(model))


@pytest.mark.parametrize(
    "joint", ["", '<joint axis="0 1 0"/>', '<joint type="slide" axis="0 1 0"/>']
)
def test_condim_4_is_3_where_nothing_drills(joint):
    """In planar models, and where bodies cannot turn."""
    runs = []
    for condim in (3, 4):
        model = model_of(CART.format(floor=f'condim="{condim}"', joint=joint))
        data = mujoco.MjData(model)
        data.qvel[0] = 1.0
        scene = Scene(model)
        runs.append(scene.simulate(data, t_end=0.1).qpos)
        assert scene.contacts(data)[0].torque == 0.0
    np.testing.assert_array_equal(*runs)
    assert data.qvel[0] == pytest.approx(1.0 - 0.4 * GRAVITY * 0.1, rel=1e-6)


def test_a_ball_bounces_to_the_squared_part_of_its_height():
    """Impacts are found to a step: heights have errors of first order in it."""
    errors = []
    for dt in (1e-3, 2.5e-4):
        model = mujoco.MjModel.from_xml_string(
            f'<mujoco><option timestep="{dt}"/><worldbody>'
            '<geom name="floor" type="plane" size="1 1 .1"/><body pos="0 0 .12">'
            '<freejoint/><geom name="ball" size=".02" mass=".1"/></body></worldbody></mujoco>'
        )
        law = PairLaw(HALF_LOAD, normal_restitution=0.7)
        scene = Scene(model, {("floor", "ball"): law}, normal_restitution=0.1)
        data = mujoco.MjData(model)
        run = scene.simulate(data, t_end=0.7)
        height, speed = run.qpos[:, 2] - 0.02, run.qvel[:, 2]
        # No step leaves the floor faster than 0.7 of what came.
        for k in np.flatnonzero((speed[:-1] < -0.1) & (speed[1:] > 0.0))[:3]:
            assert speed[k + 1] == pytest.approx(-0.7 * speed[k], rel=1e-9)
        tops = height[1:-1][(height[1:-1] > height[:-2]) & (height[1:-1] >= height[2:])]
        errors.append(np.abs(tops[:3] / (0.1 * 0.49 ** np.arange(1, 4)) - 1.0).max())
        assert height.min() > -1e-8
    assert errors[1] < 0.4 * errors[0] < 0.04
    # What bounces comes to rest.
    scene.simulate(data, t_end=2.0)
    assert abs(data.qvel[2]) < 1e-6
    assert abs(data.qpos[2] - 0.02) < 1e-6


@pytest.mark.parametrize(("spin", "dt", "atol"), [(0.0, 1e-3, 1e-9), (6.0, 1e-5, 1e-6)])
def test_a_box_bounces_as_that_of_rigid_bodies(spin, dt, atol):
    """MuJoCo's points are halfway between the surfaces, which are deeper in long steps."""
    model = box()
    model.opt.timestep = dt
    data = mujoco.MjData(model)
    data.qvel[:] = 0.8, 0.3, -0.5, 0.0, 0.0, spin
    law = LAWS["ellipse"]
    run = Scene(model, {("floor", "box"): law}, normal_restitution=0.6).simulate(
        data, t_end=50 * dt
    )
    body = asp.Body(
        0.018,
        inertia=model.body_inertia[1],
        position=(0.0, 0.0, 0.005),
        velocity=(0.8, 0.3, -0.5),
        angular_velocity=(0.0, 0.0, spin),
    )
    floor = asp.BoxPlane(0, half_sizes=DISK, plane=asp.Plane(), law=law, normal_restitution=0.6)
    bodies = asp.RigidBodies([body], pairs=[floor], gravity=(0.0, 0.0, -GRAVITY))
    expected = asp.simulate(bodies, dt=dt, t_end=50 * dt)
    assert run.qvel[1, 2] == pytest.approx(0.3, abs=1e-9)
    np.testing.assert_allclose(run.qvel[:, :3], expected.u[:, :3], rtol=0.0, atol=atol)
    np.testing.assert_allclose(run.qpos[:, :2], expected.q[:, :2], rtol=0.0, atol=atol)


X = np.linspace(-1.0, 1.0, 9)
FACTORS = {
    "regions": asp.FrictionRegions([([(0.05, -1.0), (1.0, -1.0), (1.0, 1.0), (0.05, 1.0)], 0.3)]),
    "raster": asp.FrictionRaster(1.2 + 0.8 * np.sin(5.0 * np.add.outer(X, 0.5 * X)), x1=X, x2=X),
    "function": lambda x1, x2: float(np.exp(-3.0 * x1 + x2)),
}


@pytest.mark.parametrize("spin", [0.0, 10.0])
@pytest.mark.parametrize("name", FACTORS)
def test_friction_by_place_is_that_of_rigid_bodies(name, spin):
    factor, law = FACTORS[name], LAWS["ellipse"]
    model = box(floor='pos=".01 -.02 0" euler="0 0 30"')
    data = mujoco.MjData(model)
    data.qvel[:] = 1.2, 0.4, 0.0, 0.0, 0.0, spin
    pair = PairLaw(law, friction_factor=factor)
    run = Scene(model, {("floor", "box"): pair}).simulate(data, t_end=0.3)
    body = asp.Body(
        0.018,
        inertia=model.body_inertia[1],
        position=(0.0, 0.0, 0.005),
        velocity=(1.2, 0.4, 0.0),
        angular_velocity=(0.0, 0.0, spin),
    )
    turned = (np.cos(np.pi / 6), np.sin(np.pi / 6), 0.0)
    plane = asp.Plane(point=(0.01, -0.02, 0.0), axis=turned, friction_factor=factor)
    floor = asp.BoxPlane(0, half_sizes=DISK, plane=plane, law=law)
    bodies = asp.RigidBodies([body], pairs=[floor], gravity=(0.0, 0.0, -GRAVITY))
    expected = asp.simulate(bodies, dt=1e-3, t_end=0.3)
    atol = 1e-9 if spin == 0.0 else 1e-6
    np.testing.assert_allclose(run.qpos[:, :2], expected.q[:, :2], rtol=0.0, atol=atol)
    plain = mujoco.MjData(model)
    plain.qvel[:] = 1.2, 0.4, 0.0, 0.0, 0.0, spin
    Scene(model, {("floor", "box"): law}).simulate(plain, t_end=0.3)
    assert np.abs(plain.qpos[:2] - data.qpos[:2]).max() > 1e-3


def test_factors_are_positive_and_go_with_planes():
    model = box()
    bad = {("floor", "box"): PairLaw(HALF_LOAD, friction_factor=lambda x1, x2: -1.0)}
    with pytest.raises(asp.ParameterError, match="friction_factor"):
        Scene(model, bad).step(mujoco.MjData(model))
    table = model_of(
        '<geom name="table" type="box" size="1 1 .1"/><body pos="0 0 .11"><freejoint/>'
        '<geom name="ball" size=".01"/></body>'
    )
    with pytest.raises(asp.ParameterError, match="friction_factor: goes with a plane"):
        Scene(table, {("table", "ball"): PairLaw(HALF_LOAD, friction_factor=lambda x1, x2: 1.0)})


def test_inadmissible_starts_are_refused_or_projected_with_a_report():
    model = box(height=0.003)
    data, scene = mujoco.MjData(model), Scene(model)
    with pytest.raises(asp.ParameterError, match=r"contact of 'floor' and 'box' by 0\.002"):
        scene.step(data)
    np.testing.assert_array_equal(data.qpos, model.qpos0)
    report = scene.project(data)
    assert report.violations == {"contact of 'floor' and 'box'": pytest.approx(0.002)}
    assert report.moved == pytest.approx(0.002)
    scene.step(data)
    other = mujoco.MjData(model)
    Scene(model, starts="project").step(other)
    np.testing.assert_allclose(other.qpos, data.qpos, atol=1e-12)


@pytest.mark.parametrize("degrees", [(-69.45, -0.51), (-76.14, 10.71), (-64.63, 2.12)])
def test_projections_take_a_part_of_a_change_that_leads_nowhere(degrees):
    """An arm that points into the floor, where gaps are far from linear."""
    link = '<joint axis="0 -1 0" range="-100 100"/><geom type="capsule" fromto="0 0 0 .5 0 0"'
    model = model_of(
        f'<geom type="plane" size="5 5 .1" pos="0 0 -.5"/><body>{link} size=".01"/>'
        f'<body pos=".5 0 0">{link} size=".01"/></body></body>'
    )
    data = mujoco.MjData(model)
    data.qpos[:] = np.deg2rad(degrees)
    assert Scene(model).project(data).moved < 2.0
    first, second = data.qpos
    assert 0.5 * min(np.sin(first), np.sin(first) + np.sin(first + second)) > -0.49 - 1e-6


def test_a_failure_leaves_the_state_as_it_was():
    model = box(option='gravity="0 0 -9.81"')
    scene = Scene(model, {("floor", "box"): LAWS["extended"]}, tolerance=1e-300)
    data = mujoco.MjData(model)
    data.qvel[:] = 0.7, 0.4, 0.0, 0.0, 0.0, 5.0
    with pytest.raises(asp.ConvergenceError, match="contact of 'floor' and 'box' at 0 s"):
        scene.step(data)
    np.testing.assert_array_equal(data.qpos, model.qpos0)
    assert data.qvel[5] == 5.0
    assert data.time == 0.0
    # Also where the start was projected.
    data.qpos[2] = deep = 0.004
    with pytest.raises(asp.ConvergenceError):
        Scene(model, {("floor", "box"): LAWS["extended"]}, starts="project", tolerance=1e-300).step(
            data
        )
    assert data.qpos[2] == deep


def test_a_step_that_ends_inside_is_refused_by_name():
    """A blade that turns by a right angle within half a step stands across a slot too narrow."""
    wall = '<geom name="{0}" type="plane" size="1 1 .1" pos="{1}.06 0 0" zaxis="{2} 0 0"/>'
    model = model_of(
        wall.format("left", "-", 1) + wall.format("right", "", -1) + "<body><joint/>"
        '<geom name="blade" type="box" size=".05 .15 .02" mass="1"/></body>'
    )
    model.opt.timestep = 0.01
    data = mujoco.MjData(model)
    data.qvel[0] = np.pi / 0.01
    with pytest.raises(asp.NoSolutionError, match=r"contact of 'left' and 'blade' by 0\.09 .*left"):
        Scene(model).step(data)
    assert data.qpos[0] == 0.0
    assert Scene(model, on_failure="record").step(data).violation == pytest.approx(0.09, abs=1e-3)


def test_a_problem_is_that_of_the_next_step():
    model = box()
    data, scene = mujoco.MjData(model), Scene(model, {("floor", "box"): LAWS["extended"]})
    data.qvel[:2] = 0.7, 0.4
    problem = scene.problem(data)
    assert problem.names == ("contact of 'floor' and 'box'",) * 4
    alone = asp.ContactStepper(problem.laws).solve(
        problem.delassus,
        free_velocity=problem.free_velocity,
        items=problem.items,
        bounds=problem.bounds,
        keys=problem.keys,
    )
    taken = scene.step(data).solution
    np.testing.assert_allclose(alone.percussion, taken.percussion, atol=1e-15)


def test_the_problem_of_a_step_in_flight_has_no_rows():
    """Whatever took part in the step before."""
    model = box()
    data, scene = mujoco.MjData(model), Scene(model)
    scene.step(data)
    assert scene.contacts(data)
    data.qpos[2], data.qvel[2] = 1.0, 3.0
    problem = scene.problem(data)
    assert problem.delassus.shape == (0, 0)
    assert problem.free_velocity.size == problem.items.size == len(problem.names) == 0


def test_sparse_jacobians_have_the_motion_of_dense_ones():
    """Of towers, which meet no others, beside an arm on a rail that is dragged over the floor."""
    boxes = "".join(
        f'<body pos="{i} 0 {0.1 + 0.2 * k}" euler="0 0 {25 * k}"><freejoint/>'
        '<geom type="box" size=".1 .1 .1"/></body>'
        for i in range(5)
        for k in range(2)
    )
    arm = """<body pos="0 2 .3"><joint type="slide" axis="1 0 0" damping=".3"/>
        <geom type="sphere" size=".05" contype="0" conaffinity="0"/>
        <body><joint axis="0 1 0" range="-30 30" limited="true"/><joint axis="1 0 0"/>
        <geom name="finger" type="capsule" fromto="0 0 0 0 0 -.25" size=".05"/></body></body>"""
    law = asp.FrictionLaw.associated(asp.Ellipse(0.6, 0.2))
    laws = {("floor", "finger"): PairLaw(law, axis=(1.0, 1.0, 0.0), carried_by="world")}
    runs = []
    for jacobian in ("dense", "sparse"):
        world = '<geom name="floor" type="plane" size="5 5 .1"/>' + boxes + arm
        model = model_of(world, option=f'jacobian="{jacobian}"')
        data, scene = mujoco.MjData(model), Scene(model, laws, starts="project")
        data.qvel[:] = 0.3 * np.sin(np.arange(model.nv))
        for _ in range(30):
            scene.step(data)
        problem = scene.problem(data)
        # At the midpoint, by matrices that are not sparse; turns of tangents leave the traces.
        middle = mujoco.MjData(scene._model)
        middle.qpos[:] = data.qpos
        mujoco.mj_integratePos(model, middle.qpos, data.qvel, 0.5 * scene.dt)
        mujoco.mj_fwdPosition(scene._model, middle)
        mass, rows = np.empty((model.nv, model.nv)), np.empty((model.nv, middle.nefc))
        mujoco.mj_fullM(model, middle, mass)
        mass += scene.dt * np.diag(model.dof_damping)
        for unit, own in zip(np.eye(model.nv), rows, strict=True):
            mujoco.mj_mulJacVec(scene._model, middle, own, unit)
        diagonal = np.einsum("ij,ij->j", rows, np.linalg.solve(mass, rows))
        traces = [diagonal[row : row + 3].sum() for row in middle.contact.efc_address]
        assert (problem.items >= 0).all()
        for own in np.diag(problem.delassus).reshape(-1, 3).sum(axis=1):
            assert np.abs(traces - own).min() < 1e-9 * own
        runs.append((np.concatenate((data.qpos, data.qvel)), problem.delassus))
    assert len(runs[0][1]) > 50
    np.testing.assert_allclose(runs[1][0], runs[0][0], atol=1e-9)
    np.testing.assert_allclose(runs[1][1], runs[0][1], atol=1e-7)


def test_a_problem_of_a_contact_that_its_own_percussion_opens_has_no_rows():
    """Of a damper that is stiff for the step: without the contact it ends inside, with it above."""
    model = model_of(
        '<geom type="plane" size="1 1 .1"/><body pos="0 0 .10055"><joint name="j" type="slide"'
        ' axis="0 0 1"/><geom size=".1" mass="1"/></body>',
        option='gravity="0 0 0"',
        more='<actuator><general joint="j" biastype="affine" biasprm="0 0 -6000"/></actuator>',
    )
    data = mujoco.MjData(model)
    data.qvel[0] = -1.0
    problem = Scene(model).problem(data)
    assert problem.items.size == problem.free_velocity.size == problem.delassus.size == 0


def test_contacts_are_those_of_the_last_step():
    model = box()
    data, scene = mujoco.MjData(model), Scene(model)
    with pytest.raises(asp.ParameterError, match="last step"):
        scene.contacts(data)
    scene.step(data)
    found = scene.contacts(data)
    assert {contact.geoms for contact in found} == {("floor", "box")}
    assert [contact.phase for contact in found] == [asp.Phase.STICK] * 4
    data.qpos[0] += 1.0
    with pytest.raises(asp.ParameterError, match="last step"):
        scene.contacts(data)
    data.qpos[2] += 1.0
    scene.step(data)
    assert scene.contacts(data) == []


def test_runs_keep_what_is_asked_for():
    model = box()
    data, scene = mujoco.MjData(model), Scene(model)
    run = scene.simulate(data, t_end=0.01, keep=("qpos", "xpos"))
    assert run.qpos.shape == (11, 7)
    assert run.kept["xpos"].shape == (11, 2, 3)
    np.testing.assert_allclose(run.t, np.arange(11) * 1e-3, atol=1e-15)
    for arguments, message in [
        ({"t_end": 0.0}, "data.time"),
        ({"t_end": 1.0, "keep": ("nothing",)}, "arrays of MjData"),
        ({"t_end": 1.0, "keep": "qpos"}, r"a sequence of names, as \('qpos',\)"),
    ]:
        with pytest.raises(asp.ParameterError, match=message):
            scene.simulate(data, **arguments)


def test_arrays_whose_size_changes_are_not_kept():
    model = box(height=0.02)
    with pytest.raises(asp.ParameterError, match="arrays of one size, not 'efc_J'"):
        Scene(model).simulate(mujoco.MjData(model), t_end=0.1, keep=("efc_J",))


def test_a_control_callback_is_called():
    model = model_of('<body><joint/><geom size=".1"/></body>')
    data, calls = mujoco.MjData(model), []
    mujoco.set_mjcb_control(lambda m, d: calls.append((m is model, d.time)))
    try:
        Scene(model).simulate(data, t_end=0.002)
    finally:
        mujoco.set_mjcb_control(None)
    assert calls == [(True, 0.0), (True, 0.001)]
