"""Exported laws in the engines that they are for: where the body of docs/engines.md ends there.

    python benches/peers/exported_laws.py mujoco

with the Python that has the engine (drake, mujoco, yade, pybullet as bullet) and asperity. Every
row has the end in the engine, that of the law which the export promises, and their distance.
"""

import re
import sys

import asperity as asp
import numpy as np
from sliding_body import GRAVITY, LAUNCH, MASS, STEP, TIME

LAWS = {
    "isotropic": asp.FrictionLaw.isotropic(0.5),
    "associated": asp.FrictionLaw.associated(asp.Ellipse(0.54, 0.48)),
    "grooved": asp.FrictionLaw(asp.Ellipse(0.5, 0.4), asp.Ellipse(3.0, 2.0)),
}


def mujoco(export):
    """Put the text into a model; the first tangent of a sphere on a floor is y, so it is turned."""
    import mujoco as mj

    text = re.sub("<!--.*?-->", "", export.text).replace("GEOM1", "floor").replace("GEOM2", "s")
    model = mj.MjModel.from_xml_string(
        f'<mujoco>{text}<option timestep="{STEP}" gravity="0 0 {-GRAVITY}" iterations="200"/>'
        '<worldbody><geom name="floor" type="plane" size="5 5 .1"/><body pos="0 0 .01">'
        '<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>'
        '<joint type="slide" axis="0 0 1"/>'
        f'<geom name="s" type="sphere" size=".01" mass="{MASS}"/></body></worldbody></mujoco>'
    )
    data = mj.MjData(model)
    for _ in range(3000):
        mj.mj_step(model, data)
    # Along the first tangent, which is y, is along x of the law; y of the law is −x there.
    data.qpos[:2], data.qvel[:] = 0.0, [-LAUNCH[1], LAUNCH[0], 0.0]
    for _ in range(round(TIME / STEP)):
        mj.mj_step(model, data)
    return np.array([data.qpos[1], -data.qpos[0]])


def bullet(export):
    """Run the calls of the text with a box that cannot turn, as a multibody."""
    import pybullet

    pybullet.connect(pybullet.DIRECT)
    pybullet.resetSimulation()
    pybullet.setGravity(0, 0, -GRAVITY)
    pybullet.setTimeStep(STEP)
    plane = pybullet.createCollisionShape(pybullet.GEOM_PLANE)
    box = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=[0.014, 0.014, 0.0065])
    ground = pybullet.createMultiBody(0, plane)
    body = pybullet.createMultiBody(MASS, box, basePosition=[0, 0, 0.0065])
    exec(export.text, {"pybullet": pybullet, "body": body, "ground": ground})
    pybullet.changeDynamics(body, -1, localInertiaDiagonal=[1e6] * 3, linearDamping=0)
    for _ in range(200):
        pybullet.stepSimulation()
    start = np.array(pybullet.getBasePositionAndOrientation(body)[0])
    pybullet.resetBaseVelocity(body, [*LAUNCH, 0.0])
    for _ in range(round(TIME / STEP)):
        pybullet.stepSimulation()
    return (np.array(pybullet.getBasePositionAndOrientation(body)[0]) - start)[:2]


def drake(export):
    """Read the text as part of a model in SDF."""
    from pydrake import all as dr

    text = re.sub("<!--.*?-->", "", export.text)

    def link(name, shape, inertia):
        return (
            f'<link name="{name}">{inertia}<collision name="c"><geometry>{shape}</geometry>{text}'
            "</collision></link>"
        )

    light = "<inertial><mass>{}</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia>"
    ball = link("z", "<sphere><radius>.01</radius></sphere>", light.format(MASS) + "</inertial>")
    floor = link("floor", "<plane><normal>0 0 1</normal></plane>", "")
    slides = "".join(
        f'<joint name="j{own}" type="prismatic"><parent>{parent}</parent><child>{own}</child>'
        f"<axis><xyz>{axis}</xyz></axis></joint>"
        for own, parent, axis in (("x", "world", "1 0 0"), ("y", "x", "0 1 0"), ("z", "y", "0 0 1"))
    )
    empty = "".join(f'<link name="{n}">{light.format(1e-9)}</inertial></link>' for n in "xy")
    builder = dr.DiagramBuilder()
    plant, _ = dr.AddMultibodyPlantSceneGraph(builder, time_step=STEP)
    parser = dr.Parser(plant)
    header = '<sdf version="1.9" xmlns:drake="drake.mit.edu">'
    static = f'{header}<model name="ground"><static>true</static>{floor}</model></sdf>'
    parser.AddModelsFromString(static, "sdf")
    moves = f'{header}<model name="slider">{empty}{ball}{slides}</model></sdf>'
    parser.AddModelsFromString(moves, "sdf")
    plant.Finalize()
    simulator = dr.Simulator(builder.Build())
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    plant.SetPositions(context, [0.0, 0.0, 0.01])
    simulator.AdvanceTo(0.2)
    plant.SetPositions(context, [0.0, 0.0, plant.GetPositions(context)[2]])
    plant.SetVelocities(context, [*LAUNCH, 0.0])
    simulator.AdvanceTo(0.2 + TIME)
    return plant.GetPositions(context)[:2]


def yade(export):
    """Run the material of the text with the clump of the atlas on a box of the same."""
    from atlas import CUBE, launched
    from atlas import yade as modes
    from yade import FrictMat, Omega

    world = Omega()
    exec(export.text, {"O": world, "FrictMat": FrictMat})
    mu = np.tan(world.materials[-1].frictionAngle)
    ((_, mode),) = modes()
    path = launched(mode, 1.52, 58.0, TIME, CUBE, (mu, mu))
    return path[-1, 2:4] - path[0, 2:4]


ENGINES = {one.__name__: one for one in (bullet, drake, mujoco, yade)}


def main() -> None:
    """Print where the body ends in the engine, and under the law that the export promises."""
    if sys.argv[1:2] not in [[name] for name in ENGINES]:
        sys.exit(f"one of {', '.join(ENGINES)}")
    for name, law in LAWS.items():
        export = law.export(sys.argv[1])
        there = ENGINES[sys.argv[1]](export)
        point = asp.SlidingPoint(MASS, law=export.law.replace(rate=None))
        promised = asp.simulate(point, dt=STEP, t_end=TIME, u0=LAUNCH).q[-1]
        own = asp.simulate(asp.SlidingPoint(MASS, law=law), dt=STEP, t_end=TIME, u0=LAUNCH).q[-1]
        off, price = (1e3 * np.linalg.norm(one - there) for one in (promised, own))
        said = 1e3 * export.end_distance
        print(
            f"{name:11} ends at {1e3 * there.round(6)} mm, {off:.3f} mm from the promised law; "
            f"{price:.2f} mm from the exported one, said {said:.2f} mm"
        )


if __name__ == "__main__":
    main()
