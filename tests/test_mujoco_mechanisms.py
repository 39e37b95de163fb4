"""Joints, limits, loops and dry joints of MuJoCo models, held rigidly."""

from concurrent.futures import ThreadPoolExecutor
from functools import partial

import asperity as asp
import mujoco
import numpy as np
import pytest
from asperity.mujoco import Scene

GRAVITY = 9.81
ROD = 'type="capsule" size=".01" contype="0" conaffinity="0"'

CRANK = f"""
<worldbody>
  <body name="crank"><joint name="crank" axis="0 1 0"/>
    <geom {ROD} fromto="0 0 0 0 0 .1" mass=".1"/>
    <body name="coupler" pos="0 0 .1"><joint axis="0 1 0"/>
      <geom {ROD} fromto="0 0 0 .3 0 .15" mass=".2"/></body></body>
  <body name="rocker" pos=".3 0 0"><joint name="rocker" axis="0 1 0"/>
    <geom {ROD} fromto="0 0 0 0 0 .25" mass=".15"/></body>
</worldbody>
<equality>{{}}</equality>"""
LOOP = '<connect body1="coupler" body2="rocker" anchor=".3 0 .15"/>'
WELD = """
<worldbody>
  <body name="a" pos="0 0 1"><freejoint/><geom type="box" size=".1 .05 .02" mass="1"/></body>
  <body name="b" pos=".3 0 1"><freejoint/><geom type="box" size=".03 .05 .08" mass=".5"/></body>
</worldbody>
<equality><weld body1="a" body2="b"/></equality>"""
PAIR = """
<worldbody>
  <body><joint name="a" axis="0 0 1"/><geom type="box" size=".1 .02 .02" mass="1"/></body>
  <body pos="1 0 0"><joint name="b" axis="0 0 1"/><geom type="box" size=".1 .03 .02"/></body>
</worldbody>"""
GEAR = '<equality><joint joint1="a" joint2="b" polycoef="0 -2 0 0 0"/></equality>'
CURVED = '<equality><joint joint1="a" joint2="b" polycoef="0 1 .2 .1 0"/></equality>'
TENDON = """<tendon><fixed name="t"><joint joint="a" coef="1"/><joint joint="b" coef="1.5"/></fixed>
</tendon><equality><tendon tendon1="t"/></equality>"""


def model_of(parts, *, dt=1e-3):
    return mujoco.MjModel.from_xml_string(
        f'<mujoco><compiler angle="degree"/><option timestep="{dt}"/>{parts}</mujoco>'
    )


class Observer:
    """Energy and errors of equalities by MuJoCo alone."""

    def __init__(self, model):
        self.model, self.data = model, mujoco.MjData(model)

    def look(self, data):
        model, other = self.model, self.data
        other.qpos[:], other.qvel[:] = data.qpos, data.qvel
        mujoco.mj_fwdPosition(model, other)
        mujoco.mj_fwdVelocity(model, other)
        mujoco.mj_energyPos(model, other)
        mujoco.mj_energyVel(model, other)
        return float(other.energy.sum()), np.abs(other.efc_pos[: other.ne]).max()


@pytest.mark.parametrize(
    ("parts", "start"),
    [
        (CRANK.format(LOOP), {"crank": 10.0}),
        (CRANK.format(2 * LOOP), {"crank": 10.0}),
        (WELD, {}),
        (PAIR + GEAR, {"a": -2.0, "b": 1.0}),
        (PAIR + CURVED, {"a": 3.0, "b": 3.0}),
        (PAIR + TENDON, {"a": 3.0, "b": -2.0}),
    ],
    ids=["crank", "crank with a redundant loop", "weld", "gear", "curved gear", "tendon"],
)
def test_loops_hold_and_keep_their_energy(parts, start):
    lost = []
    for dt in (1e-3, 5e-4):
        model = model_of(parts, dt=dt)
        data, scene = mujoco.MjData(model), Scene(model)
        for name, speed in start.items():
            data.joint(name).qvel = speed
        if parts == WELD:
            spin = np.array([1.0, 2.0, 3.0])
            data.qvel[:] = *(0.3, 0.0, 0.0), *spin, *np.cross(spin, (0.3, 0.0, 0.0)), *spin
            data.qvel[6] += 0.3
        # The start takes out the velocities that a loop does not allow.
        scene.step(data)
        observer = Observer(model)
        before, _ = observer.look(data)
        energy = before
        for _ in range(round(0.2 / dt)):
            assert scene.step(data).solution.converged
            last, (energy, drift) = energy, observer.look(data)
            assert drift < 1e-6 * model.stat.extent
            assert energy - last < 1e-4 * max(1.0, abs(last))
        lost.append(abs(energy - before))
    # Of second order.
    assert lost[0] < 1e-3 * max(1.0, abs(before))
    assert lost[1] < 0.5 * lost[0] + 1e-9


def test_a_redundant_loop_moves_as_one_alone():
    ends = []
    for loops in (LOOP, 2 * LOOP):
        model = model_of(CRANK.format(loops))
        data, scene = mujoco.MjData(model), Scene(model)
        data.joint("crank").qvel = 5.0
        scene.simulate(data, t_end=0.3)
        ends.append(data.qpos.copy())
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-8)


def test_a_crank_obeys_the_equation_of_its_loop():
    """Freudenstein's equation of four bars, for the angles of crank and rocker."""
    model = model_of(CRANK.format(LOOP))
    data, scene = mujoco.MjData(model), Scene(model)
    data.joint("crank").qvel = 5.0
    r, b, c, d = 0.1, np.hypot(0.3, 0.15), 0.25, 0.3
    for _ in range(300):
        scene.step(data)
        # Angles from the line of the fixed joints; those of the model are from the vertical.
        one = np.pi / 2 - data.joint("crank").qpos[0]
        other = np.pi / 2 - data.joint("rocker").qpos[0]
        left = d / r * np.cos(other) - d / c * np.cos(one)
        left += (r * r - b * b + c * c + d * d) / (2 * r * c)
        assert abs(left - np.cos(one - other)) < 1e-6
    assert data.joint("crank").qpos[0] > 0.5


def test_an_anchor_is_a_ball_joint():
    """A body that hangs on a connect moves as on a ball joint, by MuJoCo's Runge–Kutta."""
    body = '<geom size=".03" mass=".3" pos=".1 .3 0"/><geom size=".02" mass="1"/>'
    hung = model_of(
        f'<worldbody><body name="b"><freejoint/>{body}</body></worldbody>'
        '<equality><connect body1="b" anchor=".3 0 .4"/></equality>',
        dt=5e-4,
    )
    jointed = model_of(
        f'<worldbody><body><joint type="ball" pos=".3 0 .4"/>{body}</body></worldbody>'
    )
    jointed.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    data, expected = mujoco.MjData(hung), mujoco.MjData(jointed)
    Scene(hung).simulate(data, t_end=0.5)
    while expected.time < 0.5 - 1e-9:
        mujoco.mj_step(jointed, expected)
    mujoco.mj_kinematics(jointed, expected)
    np.testing.assert_allclose(data.qpos[:3], expected.xpos[1], atol=2e-6)


def test_a_gear_has_the_inertia_of_both():
    model = model_of(PAIR + GEAR)
    data, scene = mujoco.MjData(model), Scene(model)
    data.qfrc_applied[1] = 0.3
    run = scene.simulate(data, t_end=0.1)
    one, other = model.dof_M0
    np.testing.assert_allclose(run.qvel[-1], np.array([-2, 1]) * 0.03 / (other + 4 * one))


def test_limits_of_every_type_hold():
    rod = 'type="capsule" size=".01" contype="0" conaffinity="0"'
    model = model_of(f"""
      <worldbody>
        <site name="hook" pos="0 1 0"/>
        <body><joint name="hinge" axis="0 1 0" range="-20 40" limited="true"/>
          <geom {rod} fromto="0 0 0 .3 0 0"/>
          <body pos=".3 0 0"><joint name="ball" type="ball" range="0 30" limited="true"/>
            <geom {rod} fromto="0 0 0 .3 .05 0"/></body></body>
        <body pos="1 0 0"><joint name="slide" type="slide" axis="0 0 1" range="-.1 .1"
            limited="true"/><geom size=".05"/></body>
        <body pos="0 1 -.1"><freejoint/><geom size=".03"/><site name="eye"/></body>
      </worldbody>
      <tendon><spatial name="rope" limited="true" range="0 .3">
        <site site="hook"/><site site="eye"/></spatial></tendon>""")
    data, scene = mujoco.MjData(model), Scene(model)
    data.qvel[-6] = 1.5
    touched = np.zeros(4)
    for _ in range(2000):
        step = scene.step(data)
        assert step.violation < 1e-8
        angle = 2 * np.arccos(min(abs(data.joint("ball").qpos[0]), 1.0))
        rope = np.linalg.norm(data.qpos[-7:-4] - [0.0, 1.0, 0.0])
        excess = np.array(
            [
                np.abs(data.joint("hinge").qpos[0] - np.deg2rad(10)) - np.deg2rad(30),
                angle - np.deg2rad(30),
                np.abs(data.joint("slide").qpos[0]) - 0.1,
                rope - 0.3,
            ]
        )
        assert excess.max() < 1e-7
        touched += excess > -1e-6
    assert touched.min() > 0


def test_margins_of_limits_are_where_they_rest():
    """As in MuJoCo, whose limits act from their margin on."""
    model = model_of(
        '<worldbody><body><joint type="slide" axis="0 0 1" range="-.1 .1" limited="true"'
        ' margin=".02"/><geom size=".05"/></body></worldbody>'
    )
    data = mujoco.MjData(model)
    Scene(model).simulate(data, t_end=0.5)
    assert data.qpos[0] == pytest.approx(-0.08, abs=1e-8)


def test_dry_joints_hold_up_to_their_bound_and_stop_where_theory_says():
    dry = (
        '<worldbody><body><joint axis="0 0 1" frictionloss=".3"/>'
        '<geom type="box" size=".1 .02 .02" mass="1"/></body></worldbody>'
    )
    model = model_of(dry)
    data = mujoco.MjData(model)
    data.qfrc_applied[0] = 0.15
    run = Scene(model).simulate(data, t_end=1.0)
    assert np.abs(run.qvel).max() < 1e-12
    for dt in (1e-3, 1e-4):
        model = model_of(dry, dt=dt)
        data = mujoco.MjData(model)
        data.qvel[0] = 2.0
        Scene(model).simulate(data, t_end=0.1)
        assert data.qvel[0] == 0.0
        expected = 0.5 * model.dof_M0[0] * 4.0 / 0.3
        # The last step, in which it stops, is as long as the others.
        assert abs(data.qpos[0] - expected) < 0.3 * dt**2 / model.dof_M0[0]


def test_dry_tendons_and_free_joints_have_a_bound_per_row():
    model = model_of(
        '<worldbody><body><joint type="slide" name="a" axis="1 0 0"/><geom size=".1" mass="1"/>'
        '</body></worldbody><tendon><fixed frictionloss="2"><joint joint="a" coef="1"/></fixed>'
        "</tendon>"
    )
    for push, speed in ((1.9, 0.0), (3.0, 0.1)):
        data = mujoco.MjData(model)
        data.qfrc_applied[0] = push
        Scene(model).simulate(data, t_end=0.1)
        assert data.qvel[0] == pytest.approx(speed, abs=1e-12)
    ball = '<body><joint type="ball" frictionloss=".1"/><geom size=".1"/></body>'
    model = model_of(f"<worldbody>{ball}</worldbody>")
    data = mujoco.MjData(model)
    data.qvel[:] = 1.0, -2.0, 0.0
    Scene(model).step(data)
    change = 1e-3 * 0.1 / model.dof_M0[0]
    np.testing.assert_allclose(data.qvel, [1.0 - change, -2.0 + change, 0.0], atol=1e-9)


def test_joints_that_contradict_each_other_are_named():
    ends = "".join(
        f'<joint name="at {end}" joint1="a" polycoef="{end} 0 0 0 0"/>' for end in ("-.1", ".1")
    )
    model = model_of(PAIR + f"<equality>{ends}</equality>")
    data = mujoco.MjData(model)
    with pytest.raises(asp.ParameterError, match=r"equality 'at -.1' by 0.1 .*equality 'at .1'"):
        Scene(model).step(data)
    with pytest.raises(asp.NoSolutionError, match=r"cannot be projected: equality 'at"):
        Scene(model).project(data)
    np.testing.assert_array_equal(data.qpos, 0.0)


@pytest.mark.parametrize("anchor", ["0 0 .1", "0 .1 -.1"])
def test_contacts_do_not_contradict_equalities_that_hold_the_same(anchor):
    """A box that is held where it touches the floor turns there, and carries its weight once."""
    model = model_of(
        '<worldbody><geom type="plane" size="1 1 .1"/><body name="b" pos="0 0 .1"><freejoint/>'
        '<geom type="box" size=".1 .1 .1" mass="1"/></body>'
        '<body pos="3 0 1"><joint axis="0 1 0" range="-6 6"/><geom size=".1" pos=".2 0 0"/></body>'
        f'</worldbody><equality><connect body1="b" anchor="{anchor}"/></equality>'
    )
    data, scene = mujoco.MjData(model), Scene(model)
    data.qvel[5] = 1.0
    scene.simulate(data, t_end=0.1)
    if anchor == "0 0 .1":
        assert data.qvel[5] == pytest.approx(1.0, rel=1e-9)
    assert data.qfrc_constraint[2] == pytest.approx(GRAVITY, rel=1e-6)


def test_a_box_jams_between_its_anchor_and_the_floor():
    """Lines from corners to the anchor are within the friction cone."""
    anchor = np.array([0.09616706775524603, 0.03710839689613893, 0.1])
    model = model_of(
        '<worldbody><geom type="plane" size="1 1 .1" friction="1"/><body name="b" pos="0 0 .1">'
        '<freejoint/><geom type="box" size=".1 .1 .1" mass="1" friction="1"/></body></worldbody>'
        f'<equality><connect body1="b" anchor="{anchor[0]} {anchor[1]} {anchor[2]}"/></equality>'
    )
    assert np.hypot(*(anchor[:2] - [0.1, -0.1])) < 1.0 * (anchor[2] + 0.1)
    data, scene = mujoco.MjData(model), Scene(model)
    data.qvel[5] = -0.6664714561253771
    run = scene.simulate(data, t_end=0.1)
    assert run.worst_residual < 1e-9
    assert np.abs(data.qvel).max() < 1e-12
    assert np.abs(data.qpos[3:] - [1.0, 0.0, 0.0, 0.0]).max() < 1e-3


PLATES = """<worldbody><geom type="plane" size="9 9 .1"/>
<body name="a" pos="-.1 0 1"><freejoint/><geom type="box" size=".1 .1 .02" mass="1"/></body>
<body name="b" pos=".1 0 1"><freejoint/><geom type="box" size=".1 .1 .02" mass="1"/></body>
</worldbody><equality><connect body1="a" body2="b" anchor=".1 -.1 .02"/>
<connect body1="a" body2="b" anchor=".1 .1 .02"/></equality>"""
CAPS = """<worldbody><geom type="plane" size="9 9 .1"/>
<body name="a" pos="-.4 0 .8"><freejoint/>
<geom type="capsule" fromto="-.04 0 0 .04 0 0" size=".01" mass=".05"/></body>
<body name="b" pos="-.3 0 .8"><freejoint/>
<geom type="capsule" fromto="-.04 0 0 .04 0 0" size=".01" mass=".05"/></body>
</worldbody><equality><connect body1="a" body2="b" anchor=".05 0 0"/>
<connect body1="a" anchor="-.05 0 0"/></equality>"""


@pytest.mark.parametrize(("parts", "spin"), [(PLATES, 2.0), (CAPS, 0.0)])
def test_contacts_beside_an_anchor_add_no_energy(parts, spin):
    """Plates folded about edges that touch, and rods whose caps touch at their joint.

    Their contacts have levers of nearly nothing: reflected anchors would ask them for any velocity.
    """
    model = model_of(parts)
    data, scene, observer = mujoco.MjData(model), Scene(model), Observer(model)
    data.qvel[[4, 10]] = spin, -spin
    energy = [observer.look(data)[0]]
    for _ in range(1000):
        assert scene.step(data).violation <= 1e-8
        energy.append(observer.look(data)[0])
    assert np.diff(energy).max() < 1e-4


def test_a_crushed_box_stays_where_it_is():
    """Also where failures are recorded: a hand that goes on into it has no place to go."""
    model = model_of("""<worldbody><geom type="plane" size="1 1 .1"/>
<body name="hand" mocap="true" pos="0 0 .25"><geom name="palm" type="box" size=".1 .1 .05"/></body>
<body pos="0 0 .1"><freejoint/><geom name="box" type="box" size=".1 .1 .1"/></body></worldbody>""")
    for on_failure, message in [("raise", "'palm' and 'box'"), ("record", "cannot follow")]:
        data, scene = mujoco.MjData(model), Scene(model, on_failure=on_failure)
        scene.step(data)
        before = data.qpos.copy()
        data.mocap_pos[0, 2] -= 0.0005
        with pytest.raises(asp.NoSolutionError, match=message):
            scene.step(data)
        np.testing.assert_array_equal(data.qpos, before)


def test_bodies_that_nothing_moves_do_not_stop_planar_models():
    """Third rows that vanish, as in planar walkers, and normal rows, as in pushers on a table."""
    model = model_of(
        '<worldbody><geom type="plane" size="1 1 .1" friction=".5"/>'
        '<body pos="0 0 .1"><joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/>'
        '<geom size=".1" mass="1" friction=".5"/></body>'
        '<body pos="0 1 .05"><joint type="slide" axis="1 0 0"/><geom size=".1"/></body>'
        "</worldbody>"
    )
    data = mujoco.MjData(model)
    data.qvel[0] = 1.0
    Scene(model).simulate(data, t_end=0.1)
    assert data.qvel[0] == pytest.approx(1.0 - 0.05 * GRAVITY, rel=1e-6)


def test_equalities_that_are_switched_on_far_from_where_they_hold_are_refused():
    model = model_of(WELD)
    data, scene = mujoco.MjData(model), Scene(model)
    data.eq_active[0] = 0
    data.qvel[:3] = 1.0, 0.5, 0.0
    scene.simulate(data, t_end=0.01)
    data.eq_active[0] = 1
    before = data.qpos.copy()
    with pytest.raises(asp.ParameterError, match="must be admissible, it violates equality"):
        scene.step(data)
    np.testing.assert_array_equal(data.qpos, before)
    report = scene.project(data)
    assert max(report.violations.values()) == pytest.approx(np.hypot(0.01, 0.005), rel=0.2)
    scene.step(data)


TABLE = """<worldbody><body name="table" mocap="true"><geom type="plane" size="1 1 .1"/></body>
<body pos="0 0 .05"><freejoint/><geom type="box" size=".1 .1 .05"/></body></worldbody>"""
HAND = """<worldbody><body name="hand" mocap="true"/><body name="tool" pos=".2 0 0"><freejoint/>
<geom type="box" size=".05 .02 .03" mass="2"/></body></worldbody>
<equality><weld body1="hand" body2="tool"/></equality>"""


def test_a_tool_follows_the_hand_that_it_is_welded_to():
    """And has the hand's velocity, and the forces that this takes, to first order in h."""
    errors = []
    for dt in (1e-3, 5e-4):
        model = model_of(HAND, dt=dt)
        data, scene = mujoco.MjData(model), Scene(model)
        scene.step(data)
        worst = 0.0
        for k in range(1, round(0.5 / dt) + 1):
            t, middle = k * dt, (k - 0.5) * dt
            data.mocap_pos[0, 1] = 0.1 * (1.0 - np.cos(6.0 * t))
            step = scene.step(data)
            assert step.solution.converged
            place = [0.2, data.mocap_pos[0, 1], 0.0, 1.0, 0.0, 0.0, 0.0]
            np.testing.assert_allclose(data.qpos, place, atol=1e-8)
            worst = max(worst, abs(data.qvel[1] - 0.6 * np.sin(6.0 * t)))
            if k > 1:
                force = 2.0 * 3.6 * np.cos(6.0 * middle)
                worst = max(worst, abs(data.qfrc_constraint[1] - force))
            assert data.qfrc_constraint[2] == pytest.approx(2.0 * GRAVITY, rel=1e-9)
        errors.append(worst)
    assert errors[1] < 0.6 * errors[0] < 0.03
    scene.step(data)
    assert np.abs(data.qvel).max() < 1e-9


def test_a_tool_turns_with_the_hand():
    model = model_of(HAND)
    data, scene = mujoco.MjData(model), Scene(model)
    scene.step(data)
    for k in range(1, 501):
        angle = 2e-3 * k
        data.mocap_quat[0] = np.cos(angle / 2), 0.0, 0.0, np.sin(angle / 2)
        scene.step(data)
    np.testing.assert_allclose(data.qpos[:2], [0.2 * np.cos(1.0), 0.2 * np.sin(1.0)], atol=1e-7)
    np.testing.assert_allclose(data.qvel[3:], [0.0, 0.0, 2.0], atol=1e-5)
    speed = [-0.4 * np.sin(1.0), 0.4 * np.cos(1.0)]
    np.testing.assert_allclose(data.qvel[:2], speed, atol=1e-3)
    inward = -data.qfrc_constraint[:2] @ [np.cos(1.0), np.sin(1.0)]
    assert inward == pytest.approx(2.0 * 0.2 * 4.0, rel=1e-2)


TRAY = """<worldbody><body name="tray" mocap="true" {}>
<geom name="tray" type="box" size=".5 .5 .1"/></body>
<body name="load" pos="0 0 .15"><freejoint/>
<geom name="load" type="box" size=".05 .05 .05" mass="2"/></body></worldbody>"""


def test_a_tray_carries_its_load_by_friction():
    model = model_of(TRAY.format(""))
    laws = {("tray", "load"): asp.FrictionLaw.isotropic(0.2)}
    data, scene = mujoco.MjData(model), Scene(model, laws)
    scene.simulate(data, t_end=0.02)
    for k in range(1, 301):
        data.mocap_pos[0, 0] += 0.4e-3
        scene.step(data)
        assert data.qvel[0] == pytest.approx(min(0.2 * GRAVITY * 1e-3 * k, 0.4), abs=1e-9)
    assert data.qpos[0] == pytest.approx(0.12 - 0.4**2 / (2 * 0.2 * GRAVITY), abs=1e-6)


@pytest.mark.parametrize("e", [0.0, 0.5])
def test_a_mocap_body_strikes_and_lifts(e):
    model = model_of(TRAY.format('pos="0 0 -.0105"'))
    model.opt.gravity[:] = 0.0
    data, scene = mujoco.MjData(model), Scene(model, normal_restitution=e)
    data.qvel[2] = -1.0
    scene.step(data)
    for _ in range(9):
        data.mocap_pos[0, 2] += 0.5e-3
        scene.step(data)
    assert data.qvel[2] == pytest.approx(0.5 + 1.5 * e, abs=1e-9)
    gap = data.qpos[2] - data.mocap_pos[0, 2] - 0.15
    assert gap == pytest.approx(0.0, abs=1e-5) if e == 0.0 else gap > 0.0


def test_a_mocap_body_pushes_against_friction():
    model = model_of("""<worldbody><geom name="floor" type="plane" size="2 2 .1"/>
<body name="pusher" mocap="true" pos="-.1 0 .05"><geom name="pusher" size=".05"/></body>
<body name="load" pos="0 0 .05"><freejoint/>
<geom name="load" type="box" size=".05 .05 .05" mass="2"/></body></worldbody>""")
    floor, pusher = asp.FrictionLaw.isotropic(0.3), asp.FrictionLaw.isotropic(1e-9)
    scene = Scene(model, {("floor", "load"): floor, ("pusher", "load"): pusher})
    data = mujoco.MjData(model)
    scene.step(data)
    for _ in range(200):
        data.mocap_pos[0, 0] += 0.2e-3
        scene.step(data)
    assert data.qvel[0] == pytest.approx(0.2, abs=1e-9)
    assert data.qpos[0] == pytest.approx(0.04, abs=1e-6)
    (push,) = [c for c in scene.contacts(data) if "pusher" in c.geoms]
    assert abs(push.force[0]) == pytest.approx(0.3 * 2.0 * GRAVITY, rel=1e-6)


def test_hands_that_are_placed_elsewhere_give_no_velocity():
    model = model_of(HAND)
    data, scene = mujoco.MjData(model), Scene(model)
    scene.step(data)
    data.mocap_pos[0, 0] = 0.1
    scene.project(data)
    scene.step(data)
    assert data.qpos[0] == pytest.approx(0.3, abs=1e-6)
    assert np.abs(data.qvel).max() < 1e-9
    data.mocap_pos[0, 0] = np.nan
    with pytest.raises(asp.ParameterError, match="finite mocap_pos"):
        scene.step(data)


def test_a_reset_puts_hands_back_without_a_velocity():
    """Also where nothing else has moved, and past what is between."""
    model = model_of(
        '<worldbody><body mocap="true" pos="-.2 0 0"><geom size=".05"/></body><body>'
        '<joint type="slide" axis="1 0 0"/><geom size=".05"/></body></worldbody>'
    )
    data, scene = mujoco.MjData(model), Scene(model)
    data.mocap_pos[0, 0] = 0.3
    scene.step(data)
    mujoco.mj_resetData(model, data)
    scene.step(data)
    assert not data.qpos.any()
    assert not data.qvel.any()


def test_data_that_take_turns_move_as_each_alone():
    """A table that moves under a box, in two states that one scene steps."""
    model = model_of(TABLE)
    scene, alone = Scene(model), Scene(model)
    data = [mujoco.MjData(model) for _ in range(3)]
    for k in range(100):
        for one in data:
            one.mocap_pos[0, 0] += 2e-6 * k
        for one in data[:2]:
            scene.step(one)
        alone.step(data[2])
    assert data[2].qvel[0] > 0.1
    for one in data[:2]:
        np.testing.assert_allclose(one.qpos, data[2].qpos, rtol=0.0, atol=1e-9)


def test_threads_wait_for_a_scene():
    model = model_of(TABLE)

    def end(scene, speed):
        data = mujoco.MjData(model)
        data.qvel[0] = speed
        return scene.simulate(data, t_end=0.1).qpos[-1]

    speeds, scene = (0.1, 0.5, 1.0), Scene(model)
    with ThreadPoolExecutor(3) as pool:
        ends = list(pool.map(partial(end, scene), speeds))
    expected = [end(Scene(model), speed) for speed in speeds]
    np.testing.assert_allclose(ends, expected, rtol=0.0, atol=1e-9)


def test_a_hand_out_of_reach_is_named_and_leaves_the_state():
    rod = 'type="capsule" fromto="0 0 0 .3 0 0" size=".02" contype="0" conaffinity="0"'
    model = model_of(
        f"""<worldbody><body name="hand" mocap="true"/><body>
<joint axis="0 0 1"/><geom {rod}/><body name="fore" pos=".3 0 0"><joint axis="0 0 1"/><geom {rod}/>
</body></body></worldbody>
<equality><connect name="grip" site1="palm" site2="tip"/></equality>""".replace(
            '"true"/>', '"true"><site name="palm"/></body>'
        ).replace(f"<geom {rod}/>\n</body>", f'<geom {rod}/><site name="tip" pos=".3 0 0"/></body>')
    )
    data, scene = mujoco.MjData(model), Scene(model)
    data.qpos[:] = 0.5, -1.0
    data.mocap_pos[0, 0] = 0.6 * np.cos(0.5)
    scene.step(data)
    for _ in range(145):
        data.mocap_pos[0, 0] += 0.5e-3
        scene.step(data)
    data.mocap_pos[0, 0] = 0.601
    before = data.qpos.copy(), data.qvel.copy(), data.time
    with pytest.raises(asp.NoSolutionError, match=r"cannot follow.*equality 'grip'"):
        scene.step(data)
    np.testing.assert_array_equal(data.qpos, before[0])
    np.testing.assert_array_equal(data.qvel, before[1])
    assert data.time == before[2]


ARM = """
<robot name="arm">
  <link name="base"><collision><origin xyz="0 0 -0.05"/>
    <geometry><box size="2 2 0.1"/></geometry></collision></link>
  <link name="rod">
    <inertial><mass value="1"/><origin xyz="0.25 0 0"/>
      <inertia ixx="0.01" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><origin xyz="0.5 0 0"/><geometry><sphere radius="0.05"/></geometry>
    </collision></link>
  <joint name="hinge" type="revolute"><parent link="base"/><child link="rod"/>
    <origin xyz="0 0 0.3"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="2" effort="10" velocity="10"/></joint>
</robot>"""


def test_an_arm_in_urdf_falls_on_its_base():
    model = mujoco.MjModel.from_xml_string(ARM)
    scene, data = Scene(model, {"default": asp.FrictionLaw.isotropic(0.5)}), mujoco.MjData(model)
    scene.simulate(data, t_end=1.0)
    # Its ball of 0.05 m, 0.5 m from the hinge, lies 0.3 m below that.
    assert abs(np.sin(data.qpos[0]) - 0.5) < 1e-8
    assert [contact.geoms for contact in scene.contacts(data)] == [("rod[0]", "world[0]")]
