"""What does asperity say to a mistake?
====================================

An error names the argument, the file, the line or the step, and says what is allowed or what to do.
Learn which errors there are, and how to catch those of one kind.
"""

import os
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from textwrap import shorten

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np
from asperity import identify, problems

folder = tempfile.TemporaryDirectory()
law = asp.FrictionLaw.associated(asp.Ellipse(0.6, 0.2))
messages = {}


def say(error):
    """Print and keep a message."""
    messages[type(error)] = str(error)
    print(f"{type(error).__name__}: {error}")


# %%
# Arguments
# ---------

try:
    asp.Ellipse(0.6, -0.2)
except asp.ParameterError as error:
    say(error)
try:
    asp.MassOnBelt(1.0, stiffness=1.0, law=law, normal_force=1.0, belt_velocity=[1.0, 0.0, 0.0])
except asp.DimensionError as error:
    say(error)

# %%
# Files and measurements
# ----------------------

file = Path(folder.name) / "run.csv"
file.with_suffix(".toml").write_text('[file]\ndelimeter = ";"\n', encoding="utf-8")
table = "time,angle,tangential,radial,normal\n0,0,1,0,2\n0.1,0.2,overload,0,2\n"
file.write_text(table, encoding="utf-8")
try:
    identify.Configuration.load(file.with_suffix(".toml"))
except asp.ConfigurationError as error:
    say(error)
try:
    identify.read_csv(file)
except asp.RecordError as error:
    say(error)
phi = np.tile(np.deg2rad([0.0, 120.0, 240.0]), 8)
forces = np.stack([np.cos(phi), np.sin(phi)], axis=-1)
try:
    identify.fit_law((phi, forces, np.arange(24)))
except asp.FitError as error:
    say(error)

# %%
# Runs and solves
# ---------------
# What was computed before the failure comes with the error.

try:
    problems.stack(6, push=1.0).solve(asp.ProxJacobi(max_iterations=10))
except asp.ConvergenceError as error:
    say(error)
line = asp.FrictionLaw.isotropic(0.3, dimension=1)
jaws = np.kron([[1.0, -1.0], [-1.0, 1.0]], np.diag([1.0, 0.0])) + np.diag([0.0, 1.0, 0.0, 1.0])
try:
    asp.ContactProblem(jaws, free_velocity=[-1.0, 0.0, -1.0, 0.0], laws=line).solve()
except asp.NoSolutionError as error:
    say(error)
stiff = asp.Spring(0, point=(0.0, 0.0, 0.0), stiffness=1e6)
ball = asp.RigidBodies([asp.Body.ball(1.0, radius=0.1, position=(0.1, 0.0, 0.0))], springs=[stiff])
try:
    asp.simulate(ball, dt=0.1, t_end=1000.0)
except asp.DivergenceError as error:
    say(error)
    print(f"    before, it went on for {error.trajectory.t[-1]:.1f} s")
calm = asp.MassOnBelt(1.0, stiffness=1.0, law=law, normal_force=1.0, belt_velocity=[1.0, 0.2])
try:
    asp.limit_cycle(calm)
except asp.NoCycleError as error:
    say(error)
try:
    asp.sweep(
        lambda x: 1.0 / x, {"x": [1.0, 0.0]}, executor=ThreadPoolExecutor(1), on_failure="raise"
    )
except asp.SweepError as error:
    say(error)

# %%
# The family
# ----------
# ``except asp.AsperityError`` catches all of these, but not Ctrl-C. Most are an error of Python's
# own as well: a ``ValueError`` is about something that was given.


def place(kind, depth, rows):
    """Return the rows of a tree of classes with their depths."""
    rows.append((kind, depth))
    for child in kind.__subclasses__():
        place(child, depth + 1, rows)
    return rows


with asp.plot.style():
    rows = place(asp.AsperityError, 0, [])
    figure, ax = plt.subplots(figsize=(9.6, 4.6), layout="constrained")
    for row, (kind, depth) in enumerate(rows):
        parents = [base.__name__ for base in kind.__bases__ if base.__module__ == "builtins"]
        ax.annotate(kind.__name__, (0.03 * depth, -row), weight="bold", va="center")
        ax.annotate(", ".join(parents), (0.27, -row), color="0.4", va="center")
        text = messages.get(kind, "").replace(folder.name + os.sep, "")
        ax.annotate(
            shorten(text, 92, placeholder=" …"), (0.42, -row), va="center", fontsize="small"
        )
    ax.set(xlim=(0.0, 1.15), ylim=(0.6 - len(rows), 0.6))
    ax.axis("off")
plt.show()
folder.cleanup()
