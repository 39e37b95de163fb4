"""Which models of gymnasium and dm_control run in a Scene, and what every step leaves over.

    python benches/mujoco_models.py [--seconds 10] [--seeds 5] [--models ant finger] [--root FOLDER]

Random controls, new every 20 ms. A row per model: steps; items, contacts among them, in the mean;
largest residual; then largest depth of contacts in mm and violation of limits and equalities in mm
or mrad after a step; steps whose energy grows beyond the work of the actuators by more than 1e-4
max(1 J, |E|), those left when what resists at the end of the step and what the projection lifts are
counted too, and the largest of these in J. Dampers and dry friction resist v⁺: in a step in which
the motion reverses, their work over the mean velocity is positive. The first tenth of a run, from
starts that violate limits, does not count. Packages that are not installed are left out; ``--root``
is a folder that has them.
"""

import argparse
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

import mujoco
import numpy as np
from asperity import ConvergenceError, ParameterError
from asperity.mujoco import Scene

FOLDERS = {"gymnasium": "envs/mujoco/assets", "dm_control": "suite"}
SHARE = 1e-4
"""Energy over the largest of 1 J and |E| that counts as gained."""


class Result(NamedTuple):
    """What the steps of a model left over."""

    steps: int
    items: float
    contacts: float
    residual: float
    depth: float
    violation: float
    gains: int
    unexplained: int
    largest: float


class Observer:
    """The energy of a state, and how far it is from being admissible, by MuJoCo alone."""

    def __init__(self, model):
        self.model, self.data = model, mujoco.MjData(model)

    def energy(self, q, v):
        """Return the energy of a state."""
        m, d = self.model, self.data
        d.qpos[:], d.qvel[:] = q, v
        mujoco.mj_fwdPosition(m, d)
        mujoco.mj_fwdVelocity(m, d)
        mujoco.mj_energyPos(m, d)
        mujoco.mj_energyVel(m, d)
        return float(d.energy.sum())

    def look(self, data):
        """Return energy, depth of contacts and violation of limits and equalities."""
        m, d = self.model, self.data
        d.eq_active[:] = data.eq_active
        energy = self.energy(data.qpos, data.qvel)
        moves = d.efc_J[: d.nefc * m.nv].reshape(d.nefc, m.nv).any(axis=1) if m.nv < 60 else None
        depth = violation = 0.0
        for contact in d.contact:
            row = contact.efc_address
            if row >= 0 and (moves is None or moves[row]):
                depth = max(depth, contact.includemargin - contact.dist)
        for row in range(d.ne + d.nf + d.nl):
            kind = d.efc_type[row]
            error = d.efc_margin[row] - d.efc_pos[row]
            if kind == mujoco.mjtConstraint.mjCNSTR_EQUALITY:
                violation = max(violation, abs(error))
            elif row >= d.ne + d.nf:
                violation = max(violation, error)
        return energy, depth, violation


def run(path, *, seconds, seed):
    """Simulate a model with random controls."""
    model = mujoco.MjModel.from_xml_path(str(path))
    data, observer = mujoco.MjData(model), Observer(model)
    scene = Scene(model, starts="project", rolling="ignore")
    rng, dt = np.random.default_rng(seed), scene.dt
    limited = model.actuator_ctrllimited.astype(bool)
    low = np.where(limited, model.actuator_ctrlrange[:, 0], -1.0)
    high = np.where(limited, model.actuator_ctrlrange[:, 1], 1.0)
    steps, items, contacts, residual = round(seconds / dt), 0, 0, 0.0
    depth = violation = largest = 0.0
    gains = unexplained = 0
    energy = None
    for k in range(steps):
        if k % max(1, round(0.02 / dt)) == 0:
            data.ctrl[:] = rng.uniform(low, high)
        position, before = data.qpos.copy(), data.qvel.copy()
        step = scene.step(data)
        if step.solution is not None:
            items += len(step.solution.phase)
            contacts += len(scene.contacts(data))
            residual = max(residual, step.solution.residual)
        mean = 0.5 * (before + data.qvel)
        last, (energy, deep, violated) = energy, observer.look(data)
        if k < steps // 10:
            continue
        depth, violation = max(depth, deep), max(violation, violated)
        gained = energy - last - dt * (data.qfrc_actuator @ mean)
        damping = -dt * (model.dof_damping * data.qvel) @ mean
        resisted = max(damping, 0.0) + max(dt * data.qfrc_constraint @ mean, 0.0)
        allowed = SHARE * max(1.0, abs(last))
        if gained <= allowed:
            continue
        gains += 1
        mujoco.mj_integratePos(model, position, mean, dt)
        lifted = max(energy - observer.energy(position, data.qvel), 0.0)
        if gained - resisted - lifted > allowed:
            unexplained += 1
            largest = max(largest, gained - resisted - lifted)
    mean_items, mean_contacts = items / steps, contacts / steps
    return Result(
        *(steps, mean_items, mean_contacts, residual, 1e3 * depth, 1e3 * violation),
        *(gains, unexplained, largest),
    )


def paths(root=None):
    """Return the files of models by package."""
    found = {}
    for package, folder in FOLDERS.items():
        spec = find_spec(package) if root is None else None
        base = Path(root) / package if root else spec and Path(spec.origin).parent
        if base and base.is_dir():
            found[package] = sorted((base / folder).glob("*.xml"))
    return found


def main():
    """Print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--models", nargs="*")
    parser.add_argument("--root")
    options = parser.parse_args()
    print("| model | steps | items | contacts | residual | mm | mm, mrad | gains | left | J |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for package, files in paths(options.root).items():
        for path in files:
            if options.models and path.stem not in options.models:
                continue
            name, runs = f"{package} {path.stem}", []
            for seed in range(options.seeds):
                try:
                    runs.append(run(path, seconds=options.seconds, seed=seed))
                except (ConvergenceError, ParameterError, ValueError) as error:
                    print(f"| {name}, seed {seed} | {error} |", flush=True)
            if runs:
                print(_row(name, runs), flush=True)
    return 0


def _row(name, runs):
    steps, gains, left = (
        sum(getattr(r, n) for r in runs) for n in ("steps", "gains", "unexplained")
    )
    items, contacts = (np.mean([getattr(r, n) for r in runs]) for n in ("items", "contacts"))
    most = [max(getattr(r, n) for r in runs) for n in ("residual", "depth", "violation", "largest")]
    residual, depth, violation, largest = most
    return (
        f"| {name} | {steps} | {items:.1f} | {contacts:.1f} | {residual:.0e} | {depth:.1g} |"
        f" {violation:.1g} | {gains} | {left} | {largest:.2g} |"
    )


if __name__ == "__main__":
    sys.exit(main())
