"""One body on a plane in another engine: where it ends, how fast it creeps where it should stick.

    python benches/peers/sliding_body.py mujoco

with the Python that the engine is installed in (drake, exudyn, bullet: `pybullet`, dart: `dartpy`,
pinocchio: `pin`, siconos: `python3-siconos` of Debian, solve_nivp).
The body weighs 18 g, is launched at 1.52 m/s at 58° to x, and slides until 0.36 s in steps of
0.1 ms, and of larger ones that engines have by default; its friction coefficients are 5/9.3 along x
and 4.49/9.3 along y, or 0.5. It creeps under half of the load that it can hold, along x.
`tests/test_engines.py` compares `FrictionLaw.like` with these numbers.
"""

import sys
from collections.abc import Iterator

import numpy as np

MASS, GRAVITY, STEP, TIME = 0.018, 9.81, 1e-4, 0.36
M1, M2 = 5.00 / 9.3, 4.49 / 9.3
LAUNCH = 1.52 * np.array([np.cos(np.deg2rad(58.0)), np.sin(np.deg2rad(58.0))])
REST = np.zeros(2)
Row = tuple[str, np.ndarray, np.ndarray]
"""What was run, position and velocity at the end."""


def mujoco() -> Iterator[Row]:
    """Run contact pairs; friction along y comes first, as y is this contact's first tangent."""
    import mujoco as mj

    def run(friction, cone, launch, load=0.0, stiff="", step=STEP, **options):
        words = " ".join(f'{name}="{value}"' for name, value in options.items())
        model = mj.MjModel.from_xml_string(
            f'<mujoco><option timestep="{step}" gravity="{load} 0 {-GRAVITY}" cone="{cone}" '
            f'tolerance="1e-14" iterations="200" {words}/><worldbody>'
            '<geom name="floor" type="plane" size="5 5 .1"/><body pos="0 0 .01">'
            '<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>'
            f'<joint type="slide" axis="0 0 1"/><geom name="s" type="sphere" size=".01" '
            f'mass="{MASS}"/></body></worldbody>'
            f'<contact><pair geom1="floor" geom2="s" condim="3" {stiff} '
            f'friction="{friction[1]} {friction[0]} .005 .0001 .0001"/></contact></mujoco>'
        )
        data = mj.MjData(model)
        for _ in range(3000):
            mj.mj_step(model, data)
        data.qpos[:2], data.qvel[:] = 0.0, 0.0
        data.qvel[:2] = launch
        for _ in range(round((TIME if load == 0.0 else 1.0) / step)):
            mj.mj_step(model, data)
        return data.qpos[:2].copy(), data.qvel[:2].copy()

    stiffer = 'solref="0.002 1" solimp="0.95 0.99 0.001"'
    for cone in ("elliptic", "pyramidal"):
        for friction in ((0.5, 0.5), (M1, M2), (M2, M1)):
            what = f"{cone} {np.round(friction, 5)}"
            yield what, *run(friction, cone, LAUNCH)
            yield f"{what}, step 2 ms", *run(friction, cone, LAUNCH, step=2e-3)
            yield f"{what}, stiffer contact", *run(friction, cone, LAUNCH, stiff=stiffer)
        for friction in ((0.5, 0.5), (0.6, 0.4), (0.9, 0.3)):
            for degrees in (15, 30, 45, 58, 75):
                phi = np.deg2rad(degrees)
                launch = np.linalg.norm(LAUNCH) * np.array([np.cos(phi), np.sin(phi)])
                yield f"{cone} {friction} at {degrees}°", *run(friction, cone, launch)
        for ratio in (0.5, 1, 2, 10, 100):
            yield (
                f"{cone} creep, impratio {ratio}",
                *run((0.5, 0.5), cone, REST, 0.25 * GRAVITY, impratio=ratio),
            )


def drake() -> Iterator[Row]:
    """Run the four discrete approximations and, with a step of zero, the continuous model."""
    from pydrake import all as dr

    def run(kind, step, static, launch, load=0.0):
        builder = dr.DiagramBuilder()
        plant, _ = dr.AddMultibodyPlantSceneGraph(builder, time_step=step)
        if kind:
            plant.set_discrete_contact_approximation(getattr(dr.DiscreteContactApproximation, kind))
        plant.set_contact_model(dr.ContactModel.kPoint)
        surface = dr.ProximityProperties()
        dr.AddContactMaterial(
            friction=dr.CoulombFriction(static, 0.5),
            properties=surface,
            dissipation=1.0,
            point_stiffness=1e5,
        )
        plant.RegisterCollisionGeometry(
            plant.world_body(), dr.RigidTransform(), dr.HalfSpace(), "floor", surface
        )
        # The continuous model needs some mass in every body.
        light = dr.SpatialInertia(1e-9, [0, 0, 0], dr.UnitInertia(1e-3, 1e-3, 1e-3))
        empty = dr.SpatialInertia(0.0, [0, 0, 0], dr.UnitInertia(0, 0, 0))
        instance, last = plant.AddModelInstance("slider"), plant.world_body()
        for axis, name in enumerate("xyz"):
            inertia = empty if step else light
            if name == "z":
                inertia = dr.SpatialInertia(MASS, [0, 0, 0], dr.UnitInertia.SolidSphere(0.01))
            body = plant.AddRigidBody(name, instance, inertia)
            along = np.eye(3)[axis]
            joint = dr.PrismaticJoint(f"j{name}", last.body_frame(), body.body_frame(), along)
            plant.AddJoint(joint)
            last = body
        plant.RegisterCollisionGeometry(last, dr.RigidTransform(), dr.Sphere(0.01), "s", surface)
        plant.Finalize()
        simulator = dr.Simulator(builder.Build())
        context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
        # At rest: the stiffnesses of ball and floor act in series.
        plant.SetPositions(context, [0.0, 0.0, 0.01 - 2.0 * MASS * GRAVITY / 1e5])
        plant.SetVelocities(context, [*launch, 0.0])
        port = plant.get_applied_generalized_force_input_port()
        port.FixValue(context, [load, 0.0, 0.0])
        simulator.AdvanceTo(TIME)
        return plant.GetPositions(context)[:2], plant.GetVelocities(context)[:2]

    load = 0.25 * MASS * GRAVITY
    for kind in ("kLagged", "kSimilar", "kTamsi", "kSap"):
        for step in (STEP, 3e-4, 1e-3):
            yield f"{kind}, static 0.9, step {step}", *run(kind, step, 0.9, LAUNCH)
        yield f"{kind}, creep, step 1 ms", *run(kind, 1e-3, 0.5, REST, load)
    yield "continuous, static 0.9", *run(None, 0.0, 0.9, LAUNCH)


def rolling_disc(launch, add, *, load=0.0, time=TIME):
    """Slide a disc of Exudyn that cannot turn; `add` adds the contact, its axis is along x."""
    import exudyn as exu
    from exudyn import utilities as items

    world = exu.SystemContainer().AddSystem()
    node = world.AddNode(
        items.NodeRigidBodyRxyz(
            referenceCoordinates=[0, 0, 0.01, 0, 0, 0], initialVelocities=[*launch, 0, 0, 0, 0]
        )
    )
    body = world.AddObject(
        items.ObjectRigidBody(nodeNumber=node, mass=MASS, inertia=[1e6, 1e6, 1e6, 0, 0, 0])
    )
    ground = world.AddMarker(
        items.MarkerBodyRigid(bodyNumber=world.AddObject(items.ObjectGround()))
    )
    centre = world.AddMarker(items.MarkerBodyRigid(bodyNumber=body))
    world.AddLoad(items.Force(markerNumber=centre, loadVector=[load, 0, -MASS * GRAVITY]))
    memory = items.NodeGenericData(initialCoordinates=[0, 0, 0], numberOfDataCoordinates=3)
    add(world, ground, centre, world.AddNode(memory))
    world.Assemble()
    settings = exu.SimulationSettings()
    settings.timeIntegration.numberOfSteps = round(time / STEP)
    settings.timeIntegration.endTime = time
    settings.solution.file.write = False
    world.SolveDynamic(settings)
    kinds = (exu.OutputVariableType.Position, exu.OutputVariableType.Velocity)
    return tuple(np.array(world.GetObjectOutputBody(body, one, [0, 0, 0]))[:2] for one in kinds)


def exudyn() -> Iterator[Row]:
    """Run ObjectConnectorRollingDiscPenalty, with both forms of its proportional zone."""
    from exudyn import utilities as items

    def run(friction, launch, *, angle=0.0, linear=True, load=0.0):
        def add(world, ground, centre, memory):
            world.AddObject(
                items.ObjectConnectorRollingDiscPenalty(
                    markerNumbers=[ground, centre],
                    nodeNumber=memory,
                    discRadius=0.01,
                    discAxis=[1, 0, 0],
                    planeNormal=[0, 0, 1],
                    contactStiffness=1e4,
                    contactDamping=10.0,
                    dryFriction=list(friction),
                    dryFrictionAngle=angle,
                    dryFrictionProportionalZone=1e-3,
                    useLinearProportionalZone=linear,
                )
            )

        return rolling_disc(launch, add, load=load)

    for friction in ((0.5, 0.5), (M1, M2), (0.9, 0.3)):
        yield f"disc {friction}", *run(friction, LAUNCH)
    for angle in (0.3, -0.3):
        yield f"disc (0.9, 0.3) turned by {angle}", *run((0.9, 0.3), LAUNCH, angle=angle)
    for linear in (True, False):
        row = run((0.5, 0.5), REST, load=0.25 * MASS * GRAVITY, linear=linear)
        yield f"creep, useLinearProportionalZone={linear}", *row


def bullet() -> Iterator[Row]:
    """Run a sphere of pybullet on three sliding joints; coefficients are multiplied."""
    import pybullet as bt

    bt.connect(bt.DIRECT)

    def run(cone, mu, scale):
        bt.resetSimulation()
        bt.setGravity(0, 0, -GRAVITY)
        bt.setPhysicsEngineParameter(enableConeFriction=cone, fixedTimeStep=STEP)
        floor = bt.createMultiBody(0, bt.createCollisionShape(bt.GEOM_PLANE))
        ball = bt.createCollisionShape(bt.GEOM_SPHERE, radius=0.01)
        none = [[0, 0, 0]] * 3
        body = bt.createMultiBody(
            basePosition=[0, 0, 0.01],
            linkMasses=[1e-9, 1e-9, MASS],
            linkCollisionShapeIndices=[-1, -1, ball],
            linkVisualShapeIndices=[-1, -1, -1],
            linkPositions=none,
            linkOrientations=[[0, 0, 0, 1]] * 3,
            linkInertialFramePositions=none,
            linkInertialFrameOrientations=[[0, 0, 0, 1]] * 3,
            linkParentIndices=[0, 1, 2],
            linkJointTypes=[bt.JOINT_PRISMATIC] * 3,
            linkJointAxis=np.eye(3).tolist(),
        )
        bt.changeDynamics(floor, -1, lateralFriction=1.0)
        bt.changeDynamics(body, 2, lateralFriction=mu, anisotropicFriction=scale)
        for link in range(-1, 3):
            bt.changeDynamics(body, link, linearDamping=0, angularDamping=0, jointDamping=0)
        for link in range(3):
            bt.setJointMotorControl2(body, link, bt.VELOCITY_CONTROL, force=0)
        for _ in range(2000):
            bt.stepSimulation()
        for link in range(2):
            bt.resetJointState(body, link, 0.0, LAUNCH[link])
        for _ in range(round(TIME / STEP)):
            bt.stepSimulation()
        x, y = (bt.getJointState(body, link) for link in range(2))
        return np.array([x[0], y[0]]), np.array([x[1], y[1]])

    for cone in (1, 0):
        for mu, scale in ((0.5, (1, 1, 1)), (1.0, (M1, M2, 1))):
            yield (
                f"enableConeFriction={cone}, {mu} times {np.round(scale, 5)}",
                *run(cone, mu, scale),
            )


def box_of_dart(launch, floor, body, *, prepared=None, time=TIME):
    """Slide a box on a box; `prepared` takes the world and the body before it moves."""
    import dartpy

    world = dartpy.simulation.World()
    world.setGravity([0, 0, -GRAVITY])
    world.setTimeStep(STEP)
    for moves, size, place, mu in (
        (False, [20, 20, 1], [0, 0, -0.5], floor),
        (True, [0.028, 0.028, 0.013], [0, 0, 0.0065], body),
    ):
        one = dartpy.dynamics.Skeleton()
        if moves:
            _, node = one.createTranslationalJointAndBodyNodePair()
            inertia = dartpy.dynamics.Inertia()
            inertia.setMass(MASS)
            node.setInertia(inertia)
            one.setPositions(place)
        else:
            joint, node = one.createWeldJointAndBodyNodePair()
            there = dartpy.math.Isometry3()
            there.set_translation(place)
            joint.setTransformFromParentBodyNode(there)
        shape = node.createShapeNode(dartpy.dynamics.BoxShape(size))
        shape.createVisualAspect()
        shape.createCollisionAspect()
        shape.createDynamicsAspect()
        shape.getDynamicsAspect().setFrictionCoeff(mu)
        world.addSkeleton(one)
    if prepared is not None:
        prepared(world, node)
    for _ in range(200):
        world.step()
    one.setPositions([0, 0, one.getPositions()[2]])
    one.setVelocities([*launch, 0.0])
    for _ in range(round(time / STEP)):
        world.step()
    return one.getPositions()[:2], one.getVelocities()[:2]


def dart() -> Iterator[Row]:
    """Run a box on a box."""
    yield "0.5 and 0.5", *box_of_dart(LAUNCH, 0.5, 0.5)
    yield "0.5 and 0.8: the smaller counts", *box_of_dart(LAUNCH, 0.5, 0.8)


def point_of_pinocchio(kind, friction, factor, launch, time=TIME):
    """Run a loop of one's own around a solver; the tangential rows are multiplied by hand."""
    import pinocchio as pin

    model = pin.Model()
    joint = model.addJoint(0, pin.JointModelTranslation(), pin.SE3.Identity(), "slider")
    inertia = pin.Inertia(MASS, np.zeros(3), np.zeros((3, 3)))
    model.appendBodyToJoint(joint, inertia, pin.SE3.Identity())
    one = pin.SE3.Identity()
    contact = pin.PointContactConstraintModel(model, joint, one, 0, one)
    contact.setFriction(friction)
    models, data = pin.StdVec_ConstraintModel(), pin.StdVec_ConstraintData()
    models.append(pin.ConstraintModel(contact))
    data.append(models[0].createData())
    settings = getattr(pin, f"{kind}SolverSettings")()
    settings.absolute_feasibility_tol = settings.absolute_complementarity_tol = 1e-12
    settings.relative_feasibility_tol = settings.relative_complementarity_tol = 0
    settings.max_iterations, settings.solve_ncp = 2000, True
    solver = getattr(pin, f"{kind}ConstraintSolver")(3)
    result = getattr(pin, f"{kind}SolverResult")()
    rows = np.eye(3)
    rows[:2, :2] = factor
    delassus = pin.DelassusOperatorDense(rows @ rows.T / MASS)
    q, u = np.zeros(3), np.array([*launch, 0.0])
    for _ in range(round(time / STEP)):
        free = u + STEP * np.array([0.0, 0.0, -GRAVITY])
        solver.solve(delassus, rows @ free, models, data, settings, result)
        after = free + rows.T @ np.array(result.retrieveConstraintImpulses()) / MASS
        q, u = q + 0.5 * STEP * (u + after), after
    return q[:2], u[:2]


def pinocchio() -> Iterator[Row]:
    """Run the two solvers."""
    for kind in ("PGS", "ADMM"):
        for scale in ((1.0, 1.0), (M1 / 0.5, M2 / 0.5)):
            run = point_of_pinocchio(kind, 0.5, np.diag(scale), LAUNCH)
            yield f"{kind}, rows times {np.round(scale, 5)}", *run


def point_of_siconos(law, factor, launch, time=TIME):
    """Run a point mass with Moreau and Jean's scheme; rows of H are multiplied by hand."""
    from siconos import kernel as sk

    body = sk.LagrangianLinearTIDS([0.0, 0.0, 0.0], [*launch, 0.0], MASS * np.eye(3))
    body.setFExtPtr(np.array([0.0, 0.0, -MASS * GRAVITY]))
    rows = np.zeros((3, 3))
    rows[0, 2], rows[1:, :2] = 1.0, factor
    contact = sk.Interaction(law, sk.LagrangianLinearTIR(rows))
    model = sk.NonSmoothDynamicalSystem(0.0, time)
    model.insertDynamicalSystem(body)
    model.link(contact, body)
    scheme, problem = sk.MoreauJeanOSI(0.5), sk.FrictionContact(3)
    problem.numericsSolverOptions().dparam[0] = 1e-13
    run = sk.TimeStepping(model, sk.TimeDiscretisation(0.0, STEP), scheme, problem)
    for _ in range(round(time / STEP)):
        run.computeOneStep()
        run.nextStep()
    return np.array(body.q())[:2], np.array(body.velocity())[:2]


def siconos() -> Iterator[Row]:
    """Run both scalings."""
    from siconos import kernel as sk

    for scale in ((1.0, 1.0), (M1 / 0.5, M2 / 0.5)):
        law = sk.NewtonImpactFrictionNSL(0.0, 0.0, 0.5, 3)
        run = point_of_siconos(law, np.diag(scale), LAUNCH)
        yield f"rows times {np.round(scale, 5)}", *run


def solve_nivp() -> Iterator[Row]:
    """Run the trapezoidal rule with a projection of one's own, of whose set v − prox(v) is."""
    import solve_nivp as nivp
    from scipy.optimize import brentq

    class Sliding(nivp.projections.Projection):
        def __init__(self, mu):
            super().__init__()
            self.axes = GRAVITY * np.array(mu)

        def project(self, current_state, candidate, rhok=None):
            found = candidate.copy()
            axes, speed = rhok[2:] * self.axes, candidate[2:]

            def nearest(shift):
                return axes**2 * speed / (axes**2 + shift)

            def outside(shift):
                return np.linalg.norm(nearest(shift) / axes) - 1.0

            if outside(0.0) <= 0.0:
                found[2:] = 0.0
            else:
                most = axes.max() * np.linalg.norm(speed)
                found[2:] -= nearest(brentq(outside, 0.0, most, xtol=1e-15 * most))
            return found

        def tangent_cone(self, *_, **__):
            return np.eye(4)

    def run(mu, launch, load=0.0):
        whole = [slice(0, 4)]
        solver = nivp.ImplicitEquationSolver(
            method="VI", proj=Sliding(mu), tol=1e-12, component_slices=whole
        )
        system = nivp.ODESystem(
            lambda _, state: np.array([*state[2:], load, 0.0]),
            np.array([0.0, 0.0, *launch]),
            method=nivp.Trapezoidal(solver=solver),
            component_slices=whole,
        )
        _, states, *_ = nivp.ODESolver(system, (0.0, TIME), STEP).solve()
        return states[-1, :2], states[-1, 2:]

    for mu in ((0.5, 0.5), (M1, M2)):
        yield f"{np.round(mu, 5)}", *run(mu, LAUNCH)
        yield f"{np.round(mu, 5)} creep", *run(mu, REST, 0.5 * mu[0] * GRAVITY)


ENGINES = {
    one.__name__: one
    for one in (bullet, dart, drake, exudyn, mujoco, pinocchio, siconos, solve_nivp)
}


def main() -> None:
    """Print what the engine does."""
    if sys.argv[1:2] not in [[name] for name in ENGINES]:
        sys.exit(f"one of {', '.join(ENGINES)}")
    for what, position, velocity in ENGINES[sys.argv[1]]():
        x, y = position
        speed = np.linalg.norm(velocity)
        angle = np.rad2deg(np.arctan2(y, x))
        print(f"{what:45} {x:.7f} {y:.7f} m  {angle:7.3f}°  {speed:.5e} m/s")


if __name__ == "__main__":
    main()
