"""Exported laws in the engines that they are for: forces, and where a body comes to rest.

    python benches/peers/exported_laws.py mujoco

with the Python that has the engine, see `atlas.py`, and asperity. Every row has the distance of the
end in the engine from that of the exported law, beside what the export states, and how far the end,
and the mean forces after launches along twelve directions, are from those of the law that it
promises. "As said" are ends within 5 % or 0.1 mm and what the law's report says of the engine
itself, and forces within 5 % of the stated error or 1e-3.
"""

import functools
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import asperity as asp
import atlas
import numpy as np
from sliding_body import (
    GRAVITY,
    LAUNCH,
    MASS,
    STEP,
    box_of_dart,
    point_of_pinocchio,
    point_of_siconos,
    rolling_disc,
)

LAWS = {
    "isotropic": asp.FrictionLaw.isotropic(0.5),
    "associated": asp.FrictionLaw.associated(asp.Ellipse(0.54, 0.48)),
    "grooved": asp.FrictionLaw(asp.Ellipse(0.5, 0.4), asp.Ellipse(3.0, 2.0)),
}
# Until all bodies rest, and for a mean force, as in the atlas.
REST, WINDOW = 0.7, 0.05
DIRECTIONS = np.deg2rad(np.arange(0.0, 360.0, 30.0))


def mujoco(export, launch, time):
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
    data.qpos[:2], data.qvel[:] = 0.0, [-launch[1], launch[0], 0.0]
    for _ in range(round(time / STEP)):
        mj.mj_step(model, data)
    return tuple(np.array([one[1], -one[0]]) for one in (data.qpos, data.qvel))


def bullet(export, launch, time):
    """Run the calls of the text with a box that cannot turn, as a multibody."""
    import pybullet

    if not pybullet.isConnected():
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
    pybullet.resetBaseVelocity(body, [*launch, 0.0])
    for _ in range(round(time / STEP)):
        pybullet.stepSimulation()
    way = np.array(pybullet.getBasePositionAndOrientation(body)[0]) - start
    return way[:2], np.array(pybullet.getBaseVelocity(body)[0])[:2]


def drake(export, launch, time):
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
    plant.SetVelocities(context, [*launch, 0.0])
    simulator.AdvanceTo(0.2 + time)
    return plant.GetPositions(context)[:2], plant.GetVelocities(context)[:2]


def exudyn(export, launch, time):
    """Add the disc of the text, whose axis is along x."""
    from exudyn import utilities

    def add(world, ground, centre, memory):
        own = {"mbs": world, "ground": ground, "body": centre, "memory": memory, "radius": 0.01}
        exec(export.text, {**vars(utilities), **own, "stiffness": 1e4, "damping": 10.0})

    return rolling_disc(launch, add, time=time)


def dart(export, launch, time):
    """Run the calls of the text with a box; the floor has DART's default, 1.0."""
    import dartpy

    def prepared(world, node):
        exec(export.text, {"dartpy": dartpy, "world": world, "body": node})

    return box_of_dart(launch, 1.0, 1.0, prepared=prepared, time=time)


def of_atlas(engine, launch, time, step, mu=(None, None), **given):
    """Slide the cube of the atlas in the first mode of its engine."""
    ((_, mode), *_) = engine()
    mode = mode._replace(step=step, make=functools.partial(mode.make, **given))
    degrees = float(np.degrees(np.arctan2(launch[1], launch[0])))
    path = atlas.launched(mode, np.linalg.norm(launch), degrees, time, atlas.CUBE, mu)
    return path[-1, 2:4] - path[0, 2:4], path[-1, :2]


def newton(export, launch, time):
    """Make the model of the text, with the cube of the atlas; until then coefficients are 1."""
    return of_atlas(atlas.newton, launch, time, STEP, (1.0, 1.0), text=export.text)


def ode(export, launch, time):
    """Run the calls of the text on every contact of the atlas's cube."""
    return of_atlas(atlas.ode, launch, time, STEP, (None, 1.0), text=export.text)


def opensim(export, launch, time):
    """Run the calls of the text on every HuntCrossleyForce of the atlas's feet."""
    return of_atlas(atlas.opensim, launch, time, STEP, (None, 1.0), text=export.text)


def physx(export, launch, time):
    """Give the material of the text to the atlas's cube and plane."""
    from sapien import physx as px

    known = {"physx": px}
    exec(export.text, known)
    mu = known["material"].dynamic_friction
    assert known["material"].static_friction == mu
    return of_atlas(atlas.physx, launch, time, STEP, (mu, mu))


def pyelastica(export, launch, time):
    """Give the contact of the text to the atlas's rod."""
    return of_atlas(atlas.pyelastica, launch, time, STEP, (None, 1.0), text=export.text)


def rapier(export, launch, time):
    """Give the number of the text, which is in Rust, to the colliders of the atlas."""
    mu = float(re.search(r"^let .*friction\((.*)\);", export.text, re.M)[1])
    return of_atlas(atlas.rapier, launch, time, STEP, (mu, mu))


def pinocchio(export, launch, time):
    """Use the numbers of the text in a loop around PGS."""
    known = {"np": np}
    exec(export.text, known)
    return point_of_pinocchio("PGS", known["friction"], known["S"], launch, time)


def siconos(export, launch, time):
    """Use the law of the text, and its factor of the tangential rows."""
    from siconos import kernel as sk

    known = {"np": np, "sk": sk, "e_n": 0.0, "e_t": 0.0}
    exec(export.text, known)
    return point_of_siconos(known["law"], known["factor_of_tangential_rows"], launch, time)


@functools.cache
def program_of_bullet(text):
    """Compile the calls of the text with the cube of btrigidbody.cpp, which does not turn."""
    folder = Path(tempfile.mkdtemp())
    source = f"""
#define main main_of_the_atlas
#include "btrigidbody.cpp"
#undef main
#include <cstdlib>
int main(int, char **given) {{
    World one(CUBE, 1, 1, ONE);
    btRigidBody *body = &one.body, *ground = &one.floor;
    {text}
    body->setAngularFactor(btVector3(0, 0, 0));
    body->setLinearVelocity(btVector3(std::atof(given[1]), std::atof(given[2]), 0));
    btVector3 start = body->getCenterOfMassPosition();
    for (int k = std::atoi(given[3]); k > 0; --k) one.world.stepSimulation({STEP}, 0, {STEP});
    btVector3 way = body->getCenterOfMassPosition() - start, v = body->getLinearVelocity();
    std::printf("%.9g %.9g %.9g %.9g", way.x(), way.y(), v.x(), v.y());
}}"""
    (folder / "exported.cpp").write_text(source)
    libraries = ("-lBulletDynamics", "-lBulletCollision", "-lLinearMath")
    here = Path(__file__).parent
    words = ["g++", "-O1", "exported.cpp", "-o", "exported", "-I/usr/include/bullet", f"-I{here}"]
    subprocess.run([*words, *libraries], cwd=folder, check=True)
    return folder / "exported"


def btrigidbody(export, launch, time):
    """Run the calls of the text, in C++."""
    words = [program_of_bullet(export.text), *map(str, launch), str(round(time / STEP))]
    found = subprocess.run(words, check=True, capture_output=True, text=True).stdout
    return np.split(np.array(found.split(), dtype=float), 2)


def yade(export, launch, time):
    """Run the material of the text with the clump of the atlas on a box of the same."""
    from yade import FrictMat, Omega

    world = Omega()
    exec(export.text, {"O": world, "FrictMat": FrictMat})
    mu = np.tan(world.materials[-1].frictionAngle)
    return of_atlas(atlas.yade, launch, time, STEP, (mu, mu))


ENGINES = {
    one.__name__: one
    for one in (
        btrigidbody,
        bullet,
        dart,
        drake,
        exudyn,
        mujoco,
        newton,
        ode,
        opensim,
        physx,
        pinocchio,
        pyelastica,
        rapier,
        siconos,
        yade,
    )
}


def main() -> None:
    """Print ends and forces in the engine beside those that the export states."""
    if sys.argv[1:2] not in [[name] for name in ENGINES]:
        sys.exit(f"one of {', '.join(ENGINES)}")
    run = ENGINES[sys.argv[1]]
    turns = np.linalg.norm(LAUNCH) * np.stack([np.cos(DIRECTIONS), np.sin(DIRECTIONS)], axis=-1)
    for name, law in LAWS.items():
        export = law.export(sys.argv[1])
        promised = asp.SlidingPoint(MASS, law=export.law.replace(rate=None))
        moves = functools.partial(asp.simulate, promised, dt=STEP)
        off = max(
            np.linalg.norm(run(export, one, WINDOW)[1] - moves(t_end=WINDOW, u0=one).u[-1])
            for one in turns
        ) / (WINDOW * GRAVITY)
        there = run(export, LAUNCH, REST)[0]
        own = asp.simulate(asp.SlidingPoint(MASS, law=law), dt=STEP, t_end=REST, u0=LAUNCH).q[-1]
        end, price = (
            1e3 * np.linalg.norm(there - one) for one in (moves(t_end=REST, u0=LAUNCH).q[-1], own)
        )
        said, error = 1e3 * export.end_distance, 1e3 * (export.law.report.end_error or 0.0)
        as_said = {
            "end": abs(price - said) <= max(0.05 * said, 0.1) + error,
            "force": off <= max(0.05 * export.force_error, 1e-3),
        }
        print(
            f"{name:11} ends {price:.2f} mm from the law, said {said:.2f} and the engine's own "
            f"{error:.3f}; {end:.3f} mm and {off:.5f} λ_N from what is promised, force said "
            f"{export.force_error:.4f}; as said: "
            + ", ".join(what for what, good in as_said.items() if good)
        )


if __name__ == "__main__":
    main()
