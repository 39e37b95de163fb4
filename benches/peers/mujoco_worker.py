"""One step of MuJoCo on a stack of unit cubes, in place of the solution of a contact problem.

MuJoCo takes scenes, not matrices, and softens its contacts: it is tried only on problems that
`--stack` says to be stacks of cubes. The stack settles, loses its velocity, is pushed and makes one
step; the forces at MuJoCo's contacts, times dt, are taken for r at the nearest contact point of the
problem. The time is that of the whole step, collisions included, started from the forces before it.
"""

from argparse import Namespace
from functools import partial
from itertools import pairwise

import mujoco
import numpy as np
from problem import Problem
from worker import Attempts, Prepared, serve

SETTLE = 2000
CORNERS = np.array([[-0.5, -0.5], [-0.5, 0.5], [0.5, -0.5], [0.5, 0.5]])
XML = """<mujoco><size memory="200M"/>
<option timestep="{dt}" gravity="0 0 -9.81" cone="elliptic" solver="{solver}"
 tolerance="1e-12" iterations="1000"/>
<default><geom friction="{mu} 0 0" condim="3"/></default>
<worldbody><geom type="plane" size="50 50 .1"/>{bodies}</worldbody></mujoco>"""
BOX = '<body pos="0 0 {z}"><freejoint/><geom type="box" size=".5 .5 .5" mass="1"/></body>'


def attempts(problem: Problem, options: Namespace) -> Attempts:
    """Yield the one attempt at a stack, none at other problems."""
    if options.stack is not None:
        yield options.solver, partial(call, problem, options.solver, *options.stack)


def call(problem: Problem, solver: str, count: float, push: float, dt: float) -> Prepared:
    """Return the call of one step from the settled stack."""
    boxes = int(count)
    bodies = "".join(BOX.format(z=0.5 + k) for k in range(boxes))
    words = {"dt": dt, "solver": solver, "mu": problem.mu[0]}
    model = mujoco.MjModel.from_xml_string(XML.format(bodies=bodies, **words))
    data = mujoco.MjData(model)
    for _ in range(SETTLE):
        mujoco.mj_step(model, data)
    data.qvel[:] = 0.0
    data.xfrc_applied[boxes, 0] = push

    return partial(mujoco.mj_step, model, data), lambda: dt * forces(model, data, boxes).ravel()


def forces(model: mujoco.MjModel, data: mujoco.MjData, boxes: int) -> np.ndarray:
    """Return the forces (z, x, y) on the upper bodies at the corners of the interfaces."""
    found, force = np.zeros((boxes, 4, 3)), np.zeros(6)
    levels = {pair: level for level, pair in enumerate(pairwise(range(boxes + 1)))}
    for k, contact in enumerate(data.contact[: data.ncon]):
        mujoco.mj_contactForce(model, data, k, force)
        lower, upper = (int(geom) for geom in contact.geom)
        # The force acts on the second geom along the frame's rows.
        x, y, z = force[:3] @ np.reshape(contact.frame, (3, 3))
        if lower > upper:
            lower, upper, x, y, z = upper, lower, -x, -y, -z
        corner = np.linalg.norm(CORNERS - contact.pos[:2], axis=1).argmin()
        found[levels[lower, upper], corner] += z, x, y
    return found


if __name__ == "__main__":
    serve(attempts)
