"""What other engines do with friction: the numbers of the atlas in docs/engines.md.

    python benches/peers/atlas.py rapier

with the Python that the engine is installed in, from PyPI under the name in ENGINES, ODE and yade
from Debian. For Bullet's rigid bodies, which no Python has, see `btrigidbody.cpp`. Every mode of
the engine prints a table of TOML, the one of `python/asperity/law/engines.toml`, with which
`tests/test_engines.py` compares `FrictionLaw.like`. A box of 1 kg on a plane, coefficient 0.5:

cube, long: degrees and size over the weight of the mean friction force in the first 50 ms after a
    launch with 2 m/s along 15, 30, 45, 60 and 75°; a cube of 0.2 m and a box of twice the length.
creep: speed in m/s from 1.5 s to 2 s under half of the force that it can hold, 0 below 1 µm/s.
two: coefficient between 0.2 and 0.8.
lift: by how many m the cube rises in the first 0.3 s after a launch with 1.52 m/s at 58°.
spin: torque over μ λ_N in m, of the cube that spins about its normal with 20 rad/s; its corners are
    at 0.141 m.
roll: torque over λ_N in m, of a ball of radius 0.1 m that rolls at 1 m/s.
end: where the cube is 0.36 s after that launch, in m, in steps of 0.1 ms.
"""

import contextlib
import functools
import importlib.metadata
import itertools
import sys
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

GRAVITY, MU = 9.81, 0.5
CUBE, LONG, BALL = (0.1, 0.1, 0.1), (0.2, 0.1, 0.1), 0.1
ANGLES = (15.0, 30.0, 45.0, 60.0, 75.0)


class Body(NamedTuple):
    """A body at rest on a plane: functions that step, set the velocity, and return the state."""

    step: Callable[[float], None]
    """With a force in N along x."""
    launch: Callable[[np.ndarray], None]
    """With the velocity and the angular velocity."""
    state: Callable[[], tuple[np.ndarray, np.ndarray, np.ndarray]]
    """Position, velocity, angular velocity."""
    reported: Callable[[], np.ndarray] | None = None
    """Sums of the forces that the engine reports of its contacts, of both orders of bodies."""


Make = Callable[..., Body]
"""Of half sizes in m, coefficients of plane and body; how the mode is set up."""


class Mode(NamedTuple):
    """A mode of an engine: how its body is made, and its step in s."""

    make: Make
    step: float = 1e-3
    settle: float = 0.2
    mu: float = MU
    """Coefficient along x."""
    window: float = 0.05
    """Of the mean force in s; short where the force is not opposite to the slip."""
    turning: tuple[str, ...] = ("spin", "roll")
    """What its bodies can do but slide."""
    extras: Callable[[], Iterator[tuple[str, float]]] = lambda: iter(())
    """Other numbers and their names."""


def launched(mode: Mode, velocity: float, angle: float, time: float, *given) -> np.ndarray:
    """Return velocities and places over the time after a launch."""
    body = mode.make(*given, dt=mode.step)
    for _ in range(round(mode.settle / mode.step)):
        body.step(0.0)
    phi = np.deg2rad(angle)
    before = body.state()
    start = velocity * np.array([np.cos(phi), np.sin(phi), 0.0])
    body.launch(np.concatenate([start, np.zeros(3)]))
    rows = [[*start[:2], *before[0]]]
    for _ in range(round(time / mode.step)):
        body.step(0.0)
        place, speed, _ = body.state()
        rows.append([*speed[:2], *place])
    return np.array(rows)


def friction(mode: Mode, angle: float, *given) -> tuple[float, float]:
    """Return direction in degrees and size over the weight of the mean braking force."""
    rows = launched(mode, 2.0, angle, mode.window, *given)
    x, y = (rows[0, :2] - rows[-1, :2]) / (mode.window * GRAVITY)
    return round(float(np.degrees(np.arctan2(y, x))), 2), round(float(np.hypot(x, y)), 4)


def creep(mode: Mode, *given) -> float:
    """Return the speed in m/s under half of the force that the contact can hold."""
    body = mode.make(*given, dt=mode.step)
    steps = [round(time / mode.step) for time in (mode.settle, 1.5, 0.5)]
    places = []
    for number, push in zip(steps, (0.0, *2 * [0.5 * mode.mu * GRAVITY]), strict=True):
        for _ in range(number):
            body.step(push)
        places.append(body.state()[0][0])
    found = abs(places[2] - places[1]) / 0.5
    return float(f"{found:.3g}") if found >= 1e-6 else 0.0


def deceleration(mode: Mode, number: int, start: float, time: float, *given, wait=0.0) -> float:
    """Return the mean deceleration of one of the six components of the velocity, after a wait."""
    body = mode.make(*given, dt=mode.step)
    for _ in range(round(mode.settle / mode.step)):
        body.step(0.0)
    speeds = start * np.eye(6)[number]
    if number == 4:
        speeds[0] = start * BALL
    body.launch(speeds)
    seen = []
    for part in (wait, time):
        for _ in range(round(part / mode.step)):
            body.step(0.0)
        seen.append(float(np.concatenate(body.state()[1:])[number]))
    return (seen[0] - seen[1]) / time


def turning(mode: Mode) -> Iterator[tuple[str, float]]:
    """Return names and values of what the torques of spinning and rolling are measured by."""
    if "spin" in mode.turning:
        torque = 0.02 / 3.0 * deceleration(mode, 5, 20.0, 0.05)
        yield "spin", torque / (mode.mu * GRAVITY)
    if "roll" in mode.turning or "roll in a plane" in mode.turning:
        inertia = (0.4 if "roll" in mode.turning else 0.5) * BALL**2
        # A ball that sinks in rolls faster first.
        slowed = deceleration(mode, 4, 10.0, 0.2, BALL, wait=0.2)
        torque = (inertia + BALL**2) * slowed
        yield "roll", torque / GRAVITY


def bullet() -> Iterator[tuple[str, Mode]]:
    """Run pybullet, whose bodies are multibodies."""
    import pybullet as bt

    bt.connect(bt.DIRECT)

    def make(half=CUBE, mu=(1.0, MU), *, dt, cone, own=None, other=None):
        bt.resetSimulation()
        bt.setGravity(0, 0, -GRAVITY)
        bt.setPhysicsEngineParameter(enableConeFriction=cone, fixedTimeStep=dt)
        ground = bt.createCollisionShape(bt.GEOM_BOX, halfExtents=[20, 20, 1])
        plane = bt.createMultiBody(0, ground, basePosition=[0, 0, -1])
        shape = (
            bt.createCollisionShape(bt.GEOM_SPHERE, radius=half)
            if np.ndim(half) == 0
            else bt.createCollisionShape(bt.GEOM_BOX, halfExtents=half)
        )
        height = half if np.ndim(half) == 0 else half[2]
        body = bt.createMultiBody(1.0, shape, basePosition=[0, 0, height])
        free = {"linearDamping": 0, "angularDamping": 0}
        bt.changeDynamics(body, -1, lateralFriction=mu[1], **free, **(own or {}))
        bt.changeDynamics(plane, -1, lateralFriction=mu[0], **(other or {}))

        def step(push):
            place = bt.getBasePositionAndOrientation(body)[0]
            if push:
                bt.applyExternalForce(body, -1, [push, 0, 0], place, bt.WORLD_FRAME)
            bt.stepSimulation()

        def launch(speeds):
            bt.resetBaseVelocity(body, speeds[:3].tolist(), speeds[3:].tolist())

        def state():
            place = bt.getBasePositionAndOrientation(body)[0]
            return (np.array(place), *map(np.array, bt.getBaseVelocity(body)))

        def reported():
            # Rows: as asked for the contacts of body and plane, and of plane and body.
            rows = np.zeros((2, 3))
            for row, two in zip(rows, ((body, plane), (plane, body)), strict=True):
                for one in bt.getContactPoints(*two):
                    for force, along in ((9, 7), (10, 11), (12, 13)):
                        row += one[force] * np.array(one[along])
            return rows

        return Body(step, launch, state, reported)

    def extras(cone):
        # Radius 0.1 m and 1 kg: the inertia is 0.004 kg m².
        for own, other, mu in ((0.01, 0.0, (0.5, 0.5)), (0.01, 0.02, (1.0, 0.5))):
            for word, number, time in (("spinning", 5, 0.05), ("rolling", 4, 0.2)):
                mode = Mode(
                    functools.partial(
                        make,
                        cone=cone,
                        own={f"{word}Friction": own},
                        other={f"{word}Friction": other},
                    )
                )
                found = deceleration(mode, number, 20.0 if number == 5 else 10.0, time, BALL, mu)
                inertia = 0.004 if number == 5 else 0.004 + BALL**2
                yield f"{word}_{own}_{other}_{mu}, torque over N, m", found * inertia / GRAVITY

    for cone in (0, 1):
        make_one = functools.partial(make, cone=cone)
        yield f"enableConeFriction={cone}", Mode(make_one, extras=functools.partial(extras, cone))


def dart() -> Iterator[tuple[str, Mode]]:
    """Run every solver of friction that dartpy has."""
    import dartpy

    constraint = dartpy.constraint
    laws = type(constraint.NsgsFrictionSolver().getOptions().law)

    def nsgs(law):
        solver = constraint.NsgsFrictionSolver()
        options = solver.getOptions()
        options.law = getattr(laws, law)
        solver.setOptions(options)
        return solver

    def make(half=CUBE, mu=(MU, MU), *, dt, solver):
        world = dartpy.simulation.World()
        world.setTimeStep(dt)
        world.setGravity([0, 0, -GRAVITY])
        used = None if solver is None else solver()
        if used is not None:
            world.getConstraintSolver().setBoxedLcpSolver(used)
        for moves, size, place, one in (
            (False, [10, 10, 0.5], [0, 0, -0.5], mu[0]),
            (True, half, [0, 0, half if np.ndim(half) == 0 else half[2]], mu[1]),
        ):
            skeleton = dartpy.dynamics.Skeleton(str(moves))
            add = (
                skeleton.createFreeJointAndBodyNodePair
                if moves
                else skeleton.createWeldJointAndBodyNodePair
            )
            joint, node = add()
            if np.ndim(size) == 0:
                shape = dartpy.dynamics.SphereShape(size)
            else:
                shape = dartpy.dynamics.BoxShape([2 * side for side in size])
            piece = node.createShapeNode(shape)
            piece.createCollisionAspect()
            piece.createDynamicsAspect().setFrictionCoeff(one)
            inertia = dartpy.dynamics.Inertia(1.0, np.zeros(3), shape.computeInertia(1.0))
            node.setInertia(inertia)
            there = dartpy.math.Isometry3(np.eye(3), np.array(place, float))
            (joint.setTransform if moves else joint.setTransformFromParentBodyNode)(there)
            world.addSkeleton(skeleton)

        def step(push):
            if push:
                node.addExtForce(np.array([push, 0.0, 0.0]))
            world.step()

        def launch(speeds):
            joint.setLinearVelocity(speeds[:3])
            joint.setAngularVelocity(speeds[3:])

        def state():
            return node.getCOM(), node.getCOMLinearVelocity(), node.getAngularVelocity()

        def reported():
            # Rows: the sums on contacts whose first object is the body, and the floor.
            rows = np.zeros((2, 3))
            for one in world.getLastCollisionResult().getContacts():
                first = one.collisionObject1.getShapeFrame().asShapeNode().getBodyNodePtr()
                rows[int(first.getSkeleton().getName() != skeleton.getName())] += one.force
            return rows

        return Body(step, launch, state, reported)

    for name, solver in (
        ("default", None),
        *((f"NsgsFrictionSolver {law}", functools.partial(nsgs, law)) for law in laws.__members__),
        ("FbfFrictionSolver", constraint.FbfFrictionSolver),
    ):
        yield name, Mode(functools.partial(make, solver=solver))


def drake() -> Iterator[tuple[str, Mode]]:
    """Run the discrete approximations with a body on four spherical feet, as long as it is wide."""
    from pydrake import all as dr

    def make(half=CUBE, mu=(MU, MU), *, dt, kind):
        builder = dr.DiagramBuilder()
        plant, _ = dr.AddMultibodyPlantSceneGraph(builder, dt)
        plant.set_discrete_contact_approximation(getattr(dr.DiscreteContactApproximation, kind))
        if np.ndim(half) == 0:
            inertia, height = dr.SpatialInertia.SolidSphereWithMass(1.0, half), half
            feet, radius = [[0, 0, 0]], half
        else:
            sides, height = [2 * side for side in half], half[2]
            inertia, radius = dr.SpatialInertia.SolidBoxWithMass(1.0, *sides), 0.02
            feet = [[x * half[0], y * half[1], 0.02 - height] for x in (1, -1) for y in (1, -1)]
        body = plant.AddRigidBody("body", inertia)
        for number, place in enumerate(feet):
            plant.RegisterCollisionGeometry(
                body,
                dr.RigidTransform(place),
                dr.Sphere(radius),
                f"foot{number}",
                dr.CoulombFriction(mu[1], mu[1]),
            )
        plant.RegisterCollisionGeometry(
            plant.world_body(),
            dr.RigidTransform(),
            dr.HalfSpace(),
            "floor",
            dr.CoulombFriction(mu[0], mu[0]),
        )
        plant.Finalize()
        simulator = dr.Simulator(builder.Build())
        context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
        plant.SetFreeBodyPose(context, body, dr.RigidTransform([0, 0, height]))
        port = plant.get_applied_generalized_force_input_port()
        port.FixValue(context, np.zeros(6))
        count = [0]

        def step(push):
            port.FixValue(context, [0, 0, 0, push, 0, 0])
            count[0] += 1
            simulator.AdvanceTo(count[0] * dt)

        def launch(speeds):
            velocity = dr.SpatialVelocity(speeds[3:], speeds[:3])
            plant.SetFreeBodySpatialVelocity(body, velocity, context)

        def state():
            speed = plant.EvalBodySpatialVelocityInWorld(context, body)
            place = plant.EvalBodyPoseInWorld(context, body).translation()
            return place, speed.translational(), speed.rotational()

        def reported():
            # Rows: the sums on contacts whose body B is the body, and the floor.
            rows = np.zeros((2, 3))
            results = plant.get_contact_results_output_port().Eval(context)
            for number in range(results.num_point_pair_contacts()):
                one = results.point_pair_contact_info(number)
                rows[int(one.bodyB_index() != body.index())] += one.contact_force()
            return rows

        return Body(step, launch, state, reported)

    for kind in ("kLagged", "kSimilar", "kTamsi", "kSap"):
        yield kind, Mode(functools.partial(make, kind=kind))


def mujoco() -> Iterator[tuple[str, Mode]]:
    """Run both cones, with one contact point, three and four, and the options that change creep."""
    import mujoco as mj

    slides = "".join(f'<joint type="slide" axis="{a}"/>' for a in ("1 0 0", "0 1 0", "0 0 1"))

    def make(half=CUBE, mu=(MU, MU), *, dt, cone, points=4, held=False, options="", flag=""):
        sphere = np.ndim(half) == 0
        size = half if sphere else " ".join(map(str, half))
        kind = "sphere" if sphere else "box"
        geom = f'<geom type="{kind}" size="{size}" mass="1" friction="{mu[1]}"/>'
        if points == 3:
            feet = ((0.1, 0.0), (-0.05, 0.0866), (-0.05, -0.0866))
            geom = (
                '<inertial pos="0 0 0" mass="1" diaginertia="0.00667 0.00667 0.00667"/>'
                + "".join(
                    f'<geom type="sphere" size=".02" pos="{x} {y} -.08" friction="{mu[1]}"/>'
                    for x, y in feet
                )
            )
        joint = slides if held else "<freejoint/>"
        height = half if sphere else half[2]
        model = mj.MjModel.from_xml_string(
            f'<mujoco><option timestep="{dt}" cone="{cone}" {options}>{flag}</option><worldbody>'
            f'<geom type="plane" size="5 5 1" friction="{mu[0]}"/><body pos="0 0 {height}">{joint}'
            f"{geom}</body></worldbody></mujoco>"
        )
        data = mj.MjData(model)

        def step(push):
            data.xfrc_applied[1, 0] = push
            mj.mj_step(model, data)

        def launch(speeds):
            data.qvel[:] = speeds[: model.nv]

        def state():
            speed = np.concatenate([data.qvel, np.zeros(6 - model.nv)])
            return data.xpos[1].copy(), speed[:3], speed[3:]

        def reported():
            # Rows: the sums of mj_contactForce, turned by the frame, whose geom2 is the body's, the
            # floor's.
            rows, force = np.zeros((2, 3)), np.zeros(6)
            for number in range(data.ncon):
                contact = data.contact[number]
                mj.mj_contactForce(model, data, number, force)
                second = model.geom_bodyid[contact.geom2]
                rows[int(second != 1)] += contact.frame.reshape(3, 3).T @ force[:3]
            return rows

        return Body(step, launch, state, reported)

    def extras(cone):
        for name, given, more in (
            ("one point", (BALL,), {"held": True}),
            ("three points", (), {"points": 3}),
            ("four points, diagexact", (), {"flag": '<flag diagexact="enable"/>'}),
            ("one point, noslip", (BALL,), {"held": True, "options": 'noslip_iterations="10"'}),
            ("four points, noslip", (), {"options": 'noslip_iterations="10"'}),
        ):
            mode = Mode(functools.partial(make, cone=cone, **more), 2e-3)
            yield f"creep, {name}", creep(mode, *given)

    for cone in ("elliptic", "pyramidal"):
        yield (
            cone,
            Mode(functools.partial(make, cone=cone), 2e-3, extras=functools.partial(extras, cone)),
        )


def rapier() -> Iterator[tuple[str, Mode]]:
    """Run both friction models of rapier3d."""
    import rapier3d as rp

    names = ("GEOMETRIC_MEAN", "CLAMPED_SUM", "MAX", "MULTIPLY", "MIN", "AVERAGE")

    def make(half=CUBE, mu=(MU, MU), *, dt, model, rules=("AVERAGE", "AVERAGE")):
        of_ground, own = (
            {"friction": one, "friction_combine_rule": getattr(rp.CoefficientCombineRule, rule)}
            for one, rule in zip(mu, rules, strict=True)
        )
        world = rp.PhysicsWorld(gravity=(0, 0, -GRAVITY))
        world.integration_parameters.dt = dt
        world.integration_parameters.friction_model = model
        world.add_body(
            rp.RigidBody.fixed(translation=(0, 0, -1)),
            colliders=[rp.Collider.cuboid(50, 50, 1, **of_ground)],
        )
        if np.ndim(half) == 0:
            height, collider = half, functools.partial(rp.Collider.ball, half)
            density = 0.75 / (np.pi * half**3)
        else:
            height, collider = half[2], functools.partial(rp.Collider.cuboid, *half)
            density = 0.125 / np.prod(half)
        handle = world.add_body(
            rp.RigidBody.dynamic(translation=(0, 0, height), can_sleep=False),
            colliders=[collider(density=density, **own)],
        )

        def step(push):
            body = world.rigid_bodies[handle]
            body.reset_forces(True)
            body.add_force((push, 0.0, 0.0), True)
            world.step()

        def launch(speeds):
            body = world.rigid_bodies[handle]
            body.linvel, body.angvel = tuple(speeds[:3]), tuple(speeds[3:])

        def state():
            body = world.rigid_bodies[handle]
            of = (body.translation, body.linvel, body.angvel)
            return tuple(np.array([one.x, one.y, one.z]) for one in of)

        def reported():
            # Rows: the impulses over the step of pairs whose collider1 is the body's, the floor's.
            rows = np.zeros((2, 3))
            for pair in world.narrow_phase.contact_pairs():
                first = world.colliders[pair.collider1].parent != handle
                one = pair.total_impulse()
                rows[int(first)] += np.array([one.x, one.y, one.z]) / dt
            return rows

        return Body(step, launch, state, reported)

    def extras(model):
        for first, second in itertools.product(names, names):
            mode = Mode(functools.partial(make, model=model, rules=(first, second)))
            yield f"0.2 {first}, 0.6 {second}", friction(mode, 0.0, CUBE, (0.2, 0.6))[1]

    for name in ("SIMPLIFIED", "COULOMB"):
        model = getattr(rp.FrictionModel, name)
        one = functools.partial(make, model=model)
        yield name, Mode(one, extras=functools.partial(extras, model))


def motrix() -> Iterator[tuple[str, Mode]]:
    """Run motrixsim, which reads MJCF."""
    import motrixsim as mx

    def make(half=CUBE, mu=(MU, MU), *, dt, pair=""):
        sphere = np.ndim(half) == 0
        kind, height = ("sphere", half) if sphere else ("box", half[2])
        size = half if sphere else " ".join(map(str, half))
        model = mx.load_mjcf_str(
            f'<mujoco><option timestep="{dt}" gravity="0 0 {-GRAVITY}"/><worldbody>'
            f'<geom name="floor" type="plane" size="5 5 1" friction="{mu[0]}"/>'
            f'<body pos="0 0 {height}"><freejoint/><geom name="box" type="{kind}" size="{size}" '
            f'mass="1" friction="{mu[1]}"/></body></worldbody>{pair}</mujoco>'
        )
        data = mx.SceneData(model)
        pushes = [0.0]

        def step(push):
            if push != pushes[0]:
                # Gravity is the only constant force that the model takes.
                model.options.gravity = np.array([push, 0.0, -GRAVITY], np.float32)
                pushes[0] = push
            mx.step(model, data)

        def launch(speeds):
            data.set_dof_vel(speeds.astype(data.dof_vel.dtype))

        def state():
            speeds = np.array(data.dof_vel, float)
            return np.array(data.dof_pos[:3], float), speeds[:3], speeds[3:]

        return Body(step, launch, state)

    def extras():
        words = 'geom1="floor" geom2="box" friction="0.9 0.3 0.005 1e-4 1e-4"'
        mode = Mode(functools.partial(make, pair=f"<contact><pair {words}/></contact>"))
        yield "pair friction 0.9 0.3 along 90°, over the weight", friction(mode, 90.0)[1]

    yield "default", Mode(make, extras=extras)


def omi() -> Iterator[tuple[str, Mode]]:
    """Run omi-physics, whose second axis is up."""
    import omi_physics as om
    from omi_physics import model as parts

    def make(half=CUBE, mu=(MU, MU), *, dt, rule=None, static=None):
        world = om.PhysicsWorld(sleep_enabled=False, fixed_dt=dt, backend=om.NumpyBackend())
        ground, own = (
            world.add_material(parts.Material(one if static is None else static, one)) for one in mu
        )
        floor = world.add_shape(parts.Shape.box((40, 2, 40)))
        sphere = np.ndim(half) == 0
        height = half if sphere else half[2]
        sides = () if sphere else (2 * half[0], 2 * half[2], 2 * half[1])
        shape = parts.Shape.sphere(half) if sphere else parts.Shape.box(sides)
        box = world.add_shape(shape)
        world.add_body(
            parts.Motion(type="static"), parts.Collider(floor, ground), position=(0, -1, 0)
        )
        moves = parts.Motion(type="dynamic", mass=1.0)
        body = world.add_body(moves, parts.Collider(box, own), position=(0, height, 0))
        if rule is not None:
            world.set_pair_rule(lambda first, second: rule)

        def step(push):
            world.set_force(body, (push, 0.0, 0.0))
            world.step(dt)

        def launch(speeds):
            world.linear_velocity[body] = speeds[[0, 2, 1]]
            # Two axes are exchanged, which mirrors rotations.
            world.angular_velocity[body] = -speeds[[3, 5, 4]]

        def state():
            of = (world.position, world.linear_velocity, -world.angular_velocity)
            return tuple(np.array(one[body], float)[[0, 2, 1]] for one in of)

        return Body(step, launch, state)

    def extras():
        rule = parts.ContactParameters(friction=(0.9, 0.3), friction_direction=(1.0, 0.0, 0.0))
        mode = Mode(functools.partial(make, rule=rule))
        for angle in ANGLES:
            found = friction(mode, angle)
            yield f"rule with friction (0.9, 0.3) along {angle}°, degrees", found[0]
            yield f"rule with friction (0.9, 0.3) along {angle}°, over the weight", found[1]
        body = make(CUBE, (0.3, 0.3), dt=1e-3, static=0.9)
        for _ in range(500):
            body.step(0.5 * GRAVITY)
        yield (
            "m/s with static 0.9, dynamic 0.3 after 0.5 s under half the weight",
            body.state()[1][0],
        )

    yield "default", Mode(make, extras=extras)


def newton() -> Iterator[tuple[str, Mode]]:
    """Run the solvers of rigid bodies on the CPU."""
    import newton as nt
    import warp as wp

    wp.config.quiet = True
    wp.set_device("cpu")

    def make(half=CUBE, mu=(MU, MU), *, dt, solver, shape=None, text="", **options):
        kind = getattr(nt.solvers, solver)
        builder = nt.ModelBuilder()
        if hasattr(kind, "register_custom_attributes"):
            kind.register_custom_attributes(builder)
        surface = functools.partial(nt.ModelBuilder.ShapeConfig, **(shape or {}))
        ground = builder.add_ground_plane(cfg=surface(mu=mu[0]))
        sphere = np.ndim(half) == 0
        height = half if sphere else half[2]
        number = builder.add_body(xform=wp.transform((0, 0, height), wp.quat_identity()))
        density = 0.75 / (np.pi * half**3) if sphere else 0.125 / float(np.prod(half))
        own = surface(mu=mu[1], density=density)
        if sphere:
            box = builder.add_shape_sphere(number, radius=half, cfg=own)
        else:
            hx, hy, hz = half
            box = builder.add_shape_box(number, hx=hx, hy=hy, hz=hz, cfg=own)
        if solver == "SolverVBD":
            builder.color()
        if text:
            # An exported law makes model and solver.
            known = {"newton": nt, "builder": builder, "first": ground, "second": box}
            exec(text, known)
            model, engine = known["model"], known["solver"]
        else:
            model = builder.finalize()
            engine = kind(model, **options)
        states = [model.state(), model.state()]
        control, contacts = model.control(), model.contacts()
        seen = {}
        if "contact_f" in engine.supported_observables:
            seen["observables"] = engine.observables({"contact_f"}, contacts=contacts)

        def step(push):
            states[0].clear_forces()
            if push:
                states[0].body_f.assign(np.array([[push, 0, 0, 0, 0, 0]], np.float32))
            model.collide(states[0], contacts)
            engine.step(states[0], states[1], control, contacts, dt, **seen)
            states.reverse()

        def launch(speeds):
            for one in states:
                one.body_qd.assign(speeds.reshape(1, 6).astype(np.float32))
                if one.joint_qd is not None:
                    one.joint_qd.assign(speeds.astype(np.float32))

        def state():
            speed = states[0].body_qd.numpy()[0].astype(float)
            return states[0].body_q.numpy()[0, :3].astype(float), speed[:3], speed[3:]

        def reported():
            # Rows: the sums on contacts whose shape 0 is the box, is the ground.
            rows, number = np.zeros((2, 3)), int(contacts.rigid_contact_count.numpy()[0])
            first = contacts.rigid_contact_shape0.numpy()[:number]
            forces = seen["observables"].contact_f.numpy()[:number, :3]
            for row, of in zip(rows, (box, ground), strict=True):
                row += forces[first == of].sum(axis=0)
            return rows

        return Body(step, launch, state, reported if seen else None)

    for name, more, dt in (
        ("SolverXPBD", {}, 1e-3),
        ("SolverVBD", {"shape": {"ke": 1e5}}, 1e-3),
        ("SolverSemiImplicit", {}, 1e-4),
        ("SolverFeatherstone", {}, 1e-4),
        ("SolverSteel", {}, 1e-3),
        ("SolverMuJoCo", {"use_mujoco_cpu": True}, 2e-3),
        ("SolverMuJoCo elliptic", {"use_mujoco_cpu": True, "cone": "elliptic"}, 2e-3),
    ):
        yield name, Mode(functools.partial(make, solver=name.split()[0], **more), dt)


def physx() -> Iterator[tuple[str, Mode]]:
    """Run PhysX through sapien, with both solvers."""
    import sapien
    from sapien import physx as px

    def make(half=CUBE, mu=(MU, MU), *, dt, tgs, patch=0.0, dynamic=None):
        px.set_scene_config(gravity=np.array([0, 0, -GRAVITY]), enable_tgs=tgs)
        scene = sapien.Scene([px.PhysxCpuSystem()])
        scene.set_timestep(dt)
        ground, own = (px.PhysxMaterial(m, m if dynamic is None else dynamic, 0.0) for m in mu)
        builder = scene.create_actor_builder()
        upright = sapien.Pose(q=[0.5**0.5, 0, -(0.5**0.5), 0])
        builder.add_plane_collision(upright, material=ground)
        builder.build_static("floor")
        builder = scene.create_actor_builder()
        sphere = np.ndim(half) == 0
        if sphere:
            density = 0.75 / (np.pi * half**3)
            words = {"patch_radius": patch, "min_patch_radius": patch}
            builder.add_sphere_collision(radius=half, material=own, density=density, **words)
        else:
            density = 0.125 / np.prod(half)
            builder.add_box_collision(half_size=list(half), material=own, density=density)
        builder.set_initial_pose(sapien.Pose([0, 0, half if sphere else half[2]]))
        actor = builder.build("body")
        body = actor.find_component_by_type(px.PhysxRigidDynamicComponent)
        body.linear_damping = body.angular_damping = 0.0

        def step(push):
            body.add_force_torque([push, 0, 0], [0, 0, 0])
            scene.step()

        def launch(speeds):
            body.set_linear_velocity(speeds[:3])
            body.set_angular_velocity(speeds[3:])

        def state():
            of = (actor.pose.p, body.get_linear_velocity(), body.get_angular_velocity())
            return tuple(np.array(one, float) for one in of)

        def reported():
            # Rows: the sums on contacts whose bodies[0] is the body, and the floor.
            rows = np.zeros((2, 3))
            for one in scene.get_contacts():
                second = one.bodies[0].entity.name != "body"
                rows[int(second)] += sum(point.impulse for point in one.points) / dt
            return rows

        return Body(step, launch, state, reported)

    def extras(tgs):
        for patch in (0.0, 0.02):
            mode = Mode(functools.partial(make, tgs=tgs, patch=patch))
            torque = 0.004 * deceleration(mode, 5, 20.0, 0.05, BALL)
            yield f"spinning, min_patch_radius {patch} m, torque over N, m", torque / GRAVITY
        mode = Mode(functools.partial(make, tgs=tgs, dynamic=0.2))
        yield "sliding with static 0.5, dynamic 0.2", friction(mode, 0.0)[1]

    for name, tgs in (("TGS", True), ("PGS", False)):
        yield name, Mode(functools.partial(make, tgs=tgs), extras=functools.partial(extras, tgs))


def pymunk() -> Iterator[tuple[str, Mode]]:
    """Run Chipmunk, in a plane: what is up is the second coordinate."""
    import pymunk as ck

    def make(half=CUBE, mu=(MU, 1.0), *, dt, belt=0.0):
        space = ck.Space()
        space.gravity = (0, -GRAVITY)
        ground = ck.Segment(space.static_body, (-50, 0), (50, 0), 0.01)
        if np.ndim(half) == 0:
            body = ck.Body(1.0, ck.moment_for_circle(1.0, 0.0, half))
            height, box = half, ck.Circle(body, half)
        else:
            height, sides = half[2], (2 * half[0], 2 * half[2])
            body = ck.Body(1.0, ck.moment_for_box(1.0, sides))
            box = ck.Poly.create_box(body, sides)
        body.position = (0, height + 0.01)
        ground.friction, box.friction = mu
        ground.surface_velocity = (belt, 0.0)
        space.add(ground, body, box)

        def step(push):
            body.apply_force_at_world_point((push, 0), body.position)
            space.step(dt)

        def launch(speeds):
            body.velocity, body.angular_velocity = (speeds[0], 0.0), -speeds[4]

        def reported():
            # Rows: the impulses over the step of arbiters whose first shape is the box, the ground.
            rows = np.zeros((2, 3))

            def add(arbiter):
                first = int(arbiter.shapes[0] is not box)
                rows[first, [0, 2]] += np.array(arbiter.total_impulse) / dt

            body.each_arbiter(add)
            return rows

        return Body(step, launch, functools.partial(planar, body), reported)

    def extras():
        yield "speed of a box on a ground of surface_velocity 1 m/s", carried(make)

    yield "default", Mode(make, turning=("roll in a plane",), extras=extras)


def carried(make) -> float:
    """Return the speed after 1 s on a ground that moves with 1 m/s."""
    body = make(dt=1e-3, belt=1.0)
    for _ in range(1000):
        body.step(0.0)
    return float(body.state()[1][0])


def box2d() -> Iterator[tuple[str, Mode]]:
    """Run Box2D through pyb2d3, in a plane."""
    import pyb2d3 as b2

    def make(half=CUBE, mu=(MU, MU), *, dt, belt=0.0, rolling=0.0):
        world = b2.World(gravity=(0, -GRAVITY))
        surfaces = [
            b2.surface_material(
                friction=one, restitution=0.0, tangent_speed=speed, rolling_resistance=roll
            )
            for one, speed, roll in zip(mu, (belt, 0.0), (0.0, rolling), strict=True)
        ]
        ground = world.create_static_body(position=(0, 0))
        ground.create_shape(b2.shape_def(material=surfaces[0]), b2.segment((-50, 0), (50, 0)))
        if np.ndim(half) == 0:
            height, density, box = half, 1.0 / (np.pi * half**2), b2.circle(radius=half)
        else:
            height, density = half[2], 0.25 / (half[0] * half[2])
            box = b2.box(half[0], half[2])
        body = world.create_dynamic_body(position=(0, height))
        body.create_shape(b2.shape_def(density=density, material=surfaces[1]), box)

        def step(push):
            body.apply_force_to_center((push, 0.0), True)
            world.step(dt, 4)

        def launch(speeds):
            body.linear_velocity, body.angular_velocity = (speeds[0], 0.0), -speeds[4]

        return Body(step, launch, functools.partial(planar, body, speed="linear_velocity"))

    def extras():
        yield "speed of a box on a ground of tangent_speed 1 m/s", carried(make)
        for radius in (0.1, 0.5):
            body = make(radius, dt=1e-3, rolling=0.1)
            for _ in range(200):
                body.step(0.0)
            body.launch(np.array([1.0, 0, 0, 0, 1.0 / radius, 0]))
            for _ in range(200):
                body.step(0.0)
            # A disc of 1 kg: torque = a (m r + I/r).
            torque = (1.0 - body.state()[1][0]) / 0.2 * 1.5 * radius
            words = f"rolling_resistance 0.1 of a disc of radius {radius} m, torque over N, m"
            yield words, torque / GRAVITY

    yield "default", Mode(make, turning=("roll in a plane",), extras=extras)


def ode() -> Iterator[tuple[str, Mode]]:
    """Run ODE through python3-pyode of Debian, with a contact at each corner of the box."""
    import ode as od

    corners = np.array([[x, y, -1] for x in (1, -1) for y in (1, -1)])

    def make(half=CUBE, mu=(None, MU), *, dt, quick, mode=0, mu2=None, text=""):
        world = od.World()
        world.setGravity((0, 0, -GRAVITY))
        body = od.Body(world)
        mass = od.Mass()
        if np.ndim(half) == 0:
            height, touching = half, np.array([[0.0, 0.0, -half]])
            mass.setSphereTotal(1.0, half)
        else:
            height, touching = half[2], corners * half
            mass.setBoxTotal(1.0, *(2 * side for side in half))
        body.setMass(mass)
        body.setPosition((0, 0, height - 1e-6))
        joints, seen = od.JointGroup(), []

        def step(push):
            joints.empty()
            made = []
            turn = np.array(body.getRotation()).reshape(3, 3) if len(touching) > 1 else np.eye(3)
            for point in body.getPosition() + touching @ turn.T:
                if point[2] > 0.0:
                    continue
                contact = od.Contact()
                contact.setMode(mode)
                contact.setMu(mu[1])
                if mu2 is not None:
                    contact.setMu2(mu2)
                    contact.setFDir1((1, 0, 0))
                exec(text, {"ode": od, "contact": contact})
                contact.setContactGeomParams(tuple(point), (0, 0, 1), -point[2])
                made.append(od.ContactJoint(world, joints, contact))
                made[-1].attach(body, None)
                made[-1].setFeedback(True)
            body.addForce((push, 0, 0))
            (world.quickStep if quick else world.step)(dt)
            seen[:] = [one.getFeedback()[0] for one in made]
            for one in made:
                one.setFeedback(False)

        def launch(speeds):
            body.setLinearVel(speeds[:3])
            body.setAngularVel(speeds[3:])

        def state():
            of = (body.getPosition(), body.getLinearVel(), body.getAngularVel())
            return tuple(map(np.array, of))

        def reported():
            # Rows: the sum of the first force of the feedback; the second one is of the world.
            return np.array([np.sum(seen, axis=0), np.zeros(3)])

        return Body(step, launch, state, reported)

    def extras(quick):
        newtons = Mode(functools.partial(make, quick=quick, mode=0))
        yield "four corners without Approx1, over the weight", friction(newtons, 0.0)[1]
        both = od.ContactApprox1 | od.ContactMu2 | od.ContactFDir1
        unequal = Mode(functools.partial(make, quick=quick, mode=both, mu2=0.3))
        for angle in ANGLES:
            found = friction(unequal, angle, CUBE, (None, 0.9))
            yield f"0.9, 0.3 along {angle}°, degrees", found[0]
            yield f"0.9, 0.3 along {angle}°, over the weight", found[1]

    for name, quick in (("quickStep", True), ("step", False)):
        one = functools.partial(make, quick=quick, mode=od.ContactApprox1)
        yield f"{name}, ContactApprox1", Mode(one, extras=functools.partial(extras, quick))


def yade() -> Iterator[tuple[str, Mode]]:
    """Run yade of Debian: a clump of four spheres as feet, as long as it is wide, on a box."""
    from yade import Omega, utils
    from yade import wrapper as yd

    world = Omega()

    def make(half=CUBE, mu=(MU, MU), *, dt, damping=0.0):
        world.reset()
        ground, own = (
            world.materials.append(yd.FrictMat(young=1e7, poisson=0.3, frictionAngle=np.arctan(m)))
            for m in mu
        )
        floor = utils.box((0, 0, -0.5), (20, 20, 0.5), fixed=True, material=ground)
        world.bodies.append(floor)
        if np.ndim(half) == 0:
            number = world.bodies.append(utils.sphere((0, 0, half), half, material=own))
            inertia = 3 * [0.4 * half**2]
        else:
            a, b, c = half
            feet = [
                utils.sphere((x * a, y * b, 0.02), 0.02, material=own)
                for x in (1, -1)
                for y in (1, -1)
            ]
            number, _ = world.bodies.appendClumped(feet)
            inertia = (np.array([b * b + c * c, a * a + c * c, a * a + b * b]) / 3).tolist()
        body = world.bodies[number]
        body.state.mass, body.state.inertia = 1.0, inertia
        newton = yd.NewtonIntegrator(gravity=(0, 0, -GRAVITY), damping=0.2)
        world.engines = [
            yd.ForceResetter(),
            yd.InsertionSortCollider([yd.Bo1_Sphere_Aabb(), yd.Bo1_Box_Aabb()]),
            yd.InteractionLoop(
                [yd.Ig2_Box_Sphere_ScGeom()],
                [yd.Ip2_FrictMat_FrictMat_FrictPhys()],
                [yd.Law2_ScGeom_FrictPhys_CundallStrack()],
            ),
            newton,
        ]
        world.dt = dt

        def step(push):
            world.forces.setPermF(number, (push, 0, 0))
            world.step()

        def launch(speeds):
            newton.damping = damping
            body.state.vel, body.state.angVel = speeds[:3].tolist(), speeds[3:].tolist()
            # What is not a sphere is turned by its angular momentum.
            body.state.angMom = (np.array(inertia) * speeds[3:]).tolist()

        def state():
            of = (body.state.pos, body.state.vel, body.state.angVel)
            return tuple(map(np.array, of))

        def reported():
            # Rows: sums of both forces of interactions whose id1 is the floor, is not.
            rows = np.zeros((2, 3))
            for one in world.interactions:
                force = one.phys.normalForce + one.phys.shearForce
                rows[int(one.id1 != 0)] += np.array(force)
            return rows

        return Body(step, launch, state, reported)

    def extras():
        default = yd.NewtonIntegrator().damping
        mode = Mode(functools.partial(make, damping=default), 1e-4)
        yield f"NewtonIntegrator(damping={default}), over the weight", friction(mode, 0.0)[1]

    yield "Law2_ScGeom_FrictPhys_CundallStrack", Mode(make, 1e-4, extras=extras)


def opensim() -> Iterator[tuple[str, Mode]]:
    """Run OpenSim, whose forces are those of Simbody, with a body on four spherical feet."""
    import opensim as os

    os.Logger.setLevelString("off")

    def make(half=CUBE, mu=(None, MU), *, dt, kind, text=""):
        model = os.Model()
        model.setGravity(os.Vec3(0, 0, -GRAVITY))
        if np.ndim(half) == 0:
            height, radius, feet = half, half, [(0, 0, 0)]
            inertia = 3 * [0.4 * half**2]
        else:
            (a, b, c), radius = half, 0.02
            height, feet = c, [(x * a, y * b, 0.02 - c) for x in (1, -1) for y in (1, -1)]
            inertia = [(b * b + c * c) / 3, (a * a + c * c) / 3, (a * a + b * b) / 3]
        body = os.Body("body", 1.0, os.Vec3(0), os.Inertia(*inertia, 0, 0, 0))
        joint = os.FreeJoint("joint", model.getGround(), body)
        model.addBody(body)
        model.addJoint(joint)
        # The half space is where its first axis points to.
        down = os.Vec3(0), os.Vec3(0, 0.5 * np.pi, 0)
        floor = os.ContactHalfSpace(*down, model.getGround(), "floor")
        model.addContactGeometry(floor)
        for n, place in enumerate(feet):
            foot = os.ContactSphere(radius, os.Vec3(*place), body, f"foot{n}")
            model.addContactGeometry(foot)
            if kind == "HuntCrossleyForce":
                force = os.HuntCrossleyForce()
                force.setName(f"force{n}")
                for name in ("floor", f"foot{n}"):
                    force.addGeometry(name)
                force.setStiffness(1e6)
                force.setDissipation(100.0)
                force.setStaticFriction(mu[1])
                force.setDynamicFriction(mu[1])
                force.setTransitionVelocity(1e-3)
                exec(text, {"force": force})
            else:
                force = os.SmoothSphereHalfSpaceForce(f"force{n}", foot, floor)
                force.set_stiffness(1e6)
                force.set_dissipation(100.0)
                force.set_static_friction(mu[1])
                force.set_dynamic_friction(mu[1])
                force.set_viscous_friction(0.0)
                force.set_transition_velocity(1e-3)
            model.addForce(force)
        pusher = os.CoordinateActuator("joint_coord_3")
        pusher.setName("pusher")
        pusher.setCoordinate(joint.upd_coordinates(3))
        model.addForce(pusher)
        state = model.initSystem()
        pusher = os.CoordinateActuator.safeDownCast(model.getForceSet().get("pusher"))
        pusher.overrideActuation(state, True)
        coordinates = [joint.get_coordinates(k) for k in range(6)]
        coordinates[5].setValue(state, height)
        held = [state, None]

        def step(push):
            if held[1] is None or push != held[2]:
                # A state is its manager's.
                held[0] = os.State(held[0])
                pusher.setOverrideActuation(held[0], push)
                manager = os.Manager(model)
                manager.setIntegratorAccuracy(1e-5)
                manager.initialize(held[0])
                held[1:] = [manager, push]
            held[0] = held[1].integrate(held[0].getTime() + dt)

        def launch(speeds):
            held[0] = os.State(held[0])
            for one, speed in zip(coordinates, [*speeds[3:], *speeds[:3]], strict=True):
                one.setSpeedValue(held[0], float(speed))
            held[1] = None

        def state_of():
            q = np.array([one.getValue(held[0]) for one in coordinates])
            u = np.array([one.getSpeedValue(held[0]) for one in coordinates])
            return q[3:], u[3:], u[:3]

        def reported():
            # Rows: the sums of the recorded forces of the body, or Sphere, and of the ground.
            rows = np.zeros((2, 3))
            model.realizeDynamics(held[0])
            for n in range(len(feet)):
                force = model.getForceSet().get(f"force{n}")
                labels, values = force.getRecordLabels(), force.getRecordValues(held[0])
                for k in range(labels.getSize()):
                    *_, of, what, axis = labels.get(k).split(".")
                    if what == "force":
                        rows[int(of not in ("body", "Sphere")), "XYZ".index(axis)] += values.get(k)
            return rows

        held.append(0.0)
        return Body(step, launch, state_of, reported)

    for kind in ("HuntCrossleyForce", "SmoothSphereHalfSpaceForce"):
        yield kind, Mode(functools.partial(make, kind=kind), settle=0.5)


def jaxsim() -> Iterator[tuple[str, Mode]]:
    """Run the contact models of JaxSim with a box, whose corners are its contact points."""
    import jax
    import jax.numpy as jnp
    import jaxsim.api as js
    import rod
    from jaxsim.rbda import contacts
    from rod.builder.primitives import BoxBuilder

    jax.config.update("jax_enable_x64", True)

    @functools.cache
    def built(half, mu, dt, kind):
        x, y, z = (2 * side for side in half)
        box = BoxBuilder(x=x, y=y, z=z, mass=1.0, name="box").build_model().add_link()
        box = box.add_inertial().add_visual().add_collision().build()
        box.switch_frame_convention(rod.FrameConvention.Urdf, explicit_frames=True)
        model = js.model.JaxSimModel.build_from_model_description(
            model_description=box,
            time_step=dt,
            contact_model=getattr(contacts, kind).build(),
            contact_params=getattr(contacts, f"{kind}Params").build(mu=mu),
        )

        @jax.jit
        def moved(data, push):
            forces = jnp.zeros((1, 6)).at[0, 0].set(push)
            return js.model.step(model=model, data=data, link_forces=forces)

        return model, moved

    def make(half=CUBE, mu=(None, MU), *, dt, kind):
        model, moved = built(tuple(half), mu[1], dt, kind)
        place = jnp.array([0, 0, half[2]])
        held = [js.data.JaxSimModelData.build(model=model, base_position=place)]

        def step(push):
            held[0] = moved(held[0], float(push))

        def launch(speeds):
            held[0] = js.data.JaxSimModelData.build(
                model=model,
                base_position=held[0].base_position,
                base_quaternion=held[0].base_quaternion,
                base_linear_velocity=jnp.array(speeds[:3]),
                base_angular_velocity=jnp.array(speeds[3:]),
            )

        def state():
            with held[0].switch_velocity_representation(js.common.VelRepr.Mixed):
                speed = np.array(held[0].base_velocity)
            return np.array(held[0].base_position), speed[:3], speed[3:]

        return Body(step, launch, state)

    def extras(mode):
        pushed = mode.make(dt=mode.step)
        for _ in range(1000):
            pushed.step(1.2 * MU * GRAVITY)
        yield "m/s after 1000 steps under 1.2 of the force that it can hold", pushed.state()[1][0]
        height = launched(mode, 2.0, 0.0, 0.05, CUBE, (None, 0.8))[:, 4]
        rise = (height[-1] - height[-2] - height[1] + height[0]) / mode.step
        yield "mean normal force over the weight, coefficient 0.8", 1.0 + rise / (0.05 * GRAVITY)

    for kind in ("SoftContacts", "RigidContacts", "RelaxedRigidContacts"):
        mode = Mode(functools.partial(make, kind=kind), 5e-4, settle=0.5, turning=("spin",))
        yield kind, mode._replace(extras=functools.partial(extras, mode))


def ipctk() -> Iterator[tuple[str, Mode]]:
    """Integrate a point mass under the friction of ipctk, which has no bodies, over a triangle."""
    import ipctk as ip

    floor = np.array([[-90.0, -50.0, 0.0], [90.0, -50.0, 0.0], [0.0, 90.0, 0.0]])
    faces, edges = np.array([[0, 1, 2]]), np.array([[0, 1], [1, 2], [2, 0]])
    dhat, eps = 1e-3, 1e-3

    def make(half=CUBE, mu=(None, MU), *, dt, scale=None):
        barrier = ip.BarrierPotential(dhat, 1e6)
        friction = ip.FrictionPotential(eps)
        position, velocity = np.array([0.0, 0.0, 0.5 * dhat]), np.zeros(3)

        def forces(push):
            vertices = np.vstack([floor, position])
            mesh = ip.CollisionMesh(vertices, edges, faces)
            normal = ip.NormalCollisions()
            normal.build(mesh, vertices, dhat)
            lift = -barrier.gradient(normal, mesh, vertices).reshape(-1, 3)[3]
            # The normal force of the law is the weight.
            weight = GRAVITY / lift[2]
            tangential = ip.TangentialCollisions()
            tangential.build(mesh, vertices, normal, barrier, weight * mu[1])
            if scale is not None:
                # The numbers are along the basis of the collision, here x and y.
                (one,) = tangential.fv_collisions
                assert np.allclose(np.abs(one.tangent_basis), np.eye(3)[:, :2])
                one.mu_aniso = np.array(scale)
                tangential.update_lagged_anisotropic_friction_coefficients(
                    mesh, vertices, np.zeros_like(vertices), np.vstack([0 * floor, velocity])
                )
            moves = np.zeros_like(vertices)
            moves[3] = velocity
            still = np.zeros_like(vertices)
            own = friction.force(tangential, mesh, vertices, still, moves, barrier)
            return np.asarray(own).reshape(-1, 3)[3] + [push, 0.0, 0.0]

        def step(push):
            velocity[:2] += dt * forces(push)[:2]
            position[:2] += dt * velocity[:2]

        def launch(speeds):
            velocity[:2] = speeds[:2]

        def state():
            return position.copy(), velocity.copy(), np.zeros(3)

        return Body(step, launch, state)

    yield "FrictionPotential", Mode(make, 1e-4, settle=1e-4, turning=())
    unequal = functools.partial(make, mu=(None, 1.0), scale=(0.9, 0.3))
    yield "mu_aniso (0.9, 0.3)", Mode(unequal, 1e-4, 1e-4, 1.0, 1e-3, turning=())


def pyelastica() -> Iterator[tuple[str, Mode]]:
    """Move a rod of PyElastica, along x, under the forces of its contact with a plane."""
    import elastica as ea

    def make(half=CUBE, mu=(None, MU), *, dt, sideways=None, text=""):
        rod = ea.CosseratRod.straight_rod(
            n_elements=4,
            start=np.array([-half[0], 0.0, 0.01]),
            direction=np.array([1.0, 0.0, 0.0]),
            normal=np.array([0.0, 1.0, 0.0]),
            base_length=2 * half[0],
            base_radius=0.01,
            density=1.0 / (2 * half[0] * np.pi * 0.01**2),
            youngs_modulus=1e7,
        )
        plane = ea.Plane(plane_origin=np.zeros(3), plane_normal=np.array([0.0, 0.0, 1.0]))
        three = np.array([mu[1], mu[1], mu[1] if sideways is None else sideways])
        contact = ea.RodPlaneContactWithAnisotropicFriction(
            k=1e4, nu=0.0, slip_velocity_tol=1e-4, static_mu_array=three, kinetic_mu_array=three
        )
        if text:
            known = {**vars(ea), "np": np, "k": 1e4, "nu": 0.0}
            exec(text, known)
            contact = known["contact"]
        mass, place = rod.mass.sum(), np.zeros(3)

        def step(push):
            rod.external_forces[:] = rod.mass * np.array([[push / mass], [0.0], [-GRAVITY]])
            rod.external_torques[:] = 0.0
            contact.apply_contact(rod, plane)
            # All nodes move alike: what turns and bends the rod is left out.
            force = rod.external_forces.sum(axis=1)
            rod.velocity_collection[:2] += dt * force[:2, None] / mass
            place[:2] += dt * rod.velocity_collection[:2, 0]

        def launch(speeds):
            rod.velocity_collection[:2] = speeds[:2, None]

        def state():
            return place.copy(), rod.velocity_collection[:, 0].copy(), np.zeros(3)

        return Body(step, launch, state)

    yield "RodPlaneContactWithAnisotropicFriction", Mode(make, settle=1e-3, turning=())
    unequal = functools.partial(make, mu=(None, 0.9), sideways=0.3)
    yield "(0.9, 0.9, 0.3)", Mode(unequal, 1e-4, 1e-3, 0.9, 1e-3, turning=())


def planar(body, speed="velocity"):
    """Return the state of a body in a plane as one in space."""
    x, z = body.position
    u, w = getattr(body, speed)
    turn = np.array([0.0, -body.angular_velocity, 0.0])
    return np.array([x, 0.0, z]), np.array([u, 0.0, w]), turn


ENGINES: dict[str, tuple[Callable[[], Iterator[tuple[str, Mode]]], str]] = {
    "box2d": (box2d, "pyb2d3"),
    "bullet": (bullet, "pybullet"),
    "chipmunk": (pymunk, "pymunk"),
    "dart": (dart, "dartpy"),
    "drake": (drake, "drake"),
    "ipctk": (ipctk, "ipctk"),
    "jaxsim": (jaxsim, "jaxsim"),
    "motrix": (motrix, "motrixsim-core"),
    "mujoco": (mujoco, "mujoco"),
    "newton": (newton, "newton"),
    "ode": (ode, "python3-pyode"),
    "omi": (omi, "omi-physics"),
    "opensim": (opensim, "opensim"),
    "physx": (physx, "sapien"),
    "pyelastica": (pyelastica, "pyelastica"),
    "rapier": (rapier, "rapier3d"),
    "yade": (yade, "python3-yade"),
}


def main() -> None:
    """Print what the modes of the engine do."""
    if sys.argv[1:2] not in [[name] for name in ENGINES]:
        sys.exit("one of " + ", ".join(f"{name} ({one[1]})" for name, one in ENGINES.items()))
    modes, distribution = ENGINES[sys.argv[1]]
    with contextlib.suppress(importlib.metadata.PackageNotFoundError):
        print(f"# {distribution} {importlib.metadata.version(distribution)}")
    for name, mode in modes():
        print(f"[[{sys.argv[1]}.modes]]\nname = {name!r}")
        directions = (0.0,) if sys.argv[1] in ("box2d", "chipmunk") else ANGLES
        for word, half in (("cube", CUBE), ("long", LONG)):
            found = [list(friction(mode, angle, half)) for angle in directions]
            print(f"{word} = {found}", flush=True)
        print(f"creep = {creep(mode)}")
        if mode.mu == MU:
            print(f"two = {friction(mode, 0.0, CUBE, (0.2, 0.8))[1]}")
        heights = launched(mode, 1.52, 58.0, 0.3, CUBE)[:, 4]
        print(f"lift = {max(heights) - heights[0]:.2g}", flush=True)
        for word, found in turning(mode):
            print(f"{word} = {found if abs(found) >= 1e-4 else 0.0:.3g}", flush=True)
        if len(directions) > 1:
            path = launched(mode._replace(step=1e-4), 1.52, 58.0, 0.36, CUBE)
            print(f"end = {[round(float(one), 6) for one in path[-1, 2:4] - path[0, 2:4]]}")
        body = mode.make(dt=mode.step)
        if body.reported is not None:
            for _ in range(round(mode.settle / mode.step)):
                body.step(0.0)
            body.launch(np.array([2.0, 0, 0, 0, 0, 0]))
            # The feet of a clump of yade have the velocity one step later.
            for _ in range(2):
                body.step(0.0)
            print(f"# reported in N after a launch along x: {body.reported().round(2).tolist()}")
        for what, found in mode.extras():
            print(f"# {what}: {found:.4g}", flush=True)


if __name__ == "__main__":
    main()
