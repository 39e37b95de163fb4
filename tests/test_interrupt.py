"""Ctrl-C stops what takes long at once; a simulation keeps what was computed."""

import os

import pytest
from children import run_interrupted

# Processor time in s. The calls take much longer, and look for Ctrl-C every 50 ms.
PROMPT = 1.0

pytestmark = pytest.mark.skipif(os.name == "nt", reason="sends SIGINT")

SIMULATE = """
import asperity as asp
law = asp.FrictionLaw.isotropic(0.5)
belt = asp.MassOnBelt(1.0, stiffness=1.0, law=law, normal_force=1.0, belt_velocity=[0.1, 0.0])
ready = []
def report(step, steps):
    if step and not ready:
        ready.append(step)
        print("ready", flush=True)
try:
    asp.simulate(belt, dt=1e-6, t_end=1e6, sample_every=1e-3, progress=report)
except asp.errors.SimulationInterrupted as stopped:
    print("interrupted", flush=True)
    trajectory = stopped.trajectory
    assert trajectory.steps > 0
    assert len(trajectory) >= trajectory.steps // 1000
    assert trajectory.phase_counts.sum() == trajectory.steps
    raise SystemExit(42)
"""

SOLVE = """
import asperity as asp
import numpy as np
law = asp.FrictionLaw.isotropic(0.5)
problem = asp.ContactProblem(np.eye(2), free_velocity=[0.2, 0.3], laws=law, normal_force=1.0)
print("ready", flush=True)
try:
    # The step is far too large: the iteration jumps from side to side for ever.
    problem.solve(asp.ProxJacobi(r=100.0, max_iterations=10**15))
except KeyboardInterrupt:
    print("interrupted", flush=True)
    raise SystemExit(42)
"""


WITHIN_A_STEP = """
import asperity as asp
law = asp.FrictionLaw.isotropic(0.5)
belt = asp.MassOnBelt(1.0, stiffness=1.0, law=law, normal_force=1.0, belt_velocity=[0.1, 0.0])
# The step of the iteration is far too large: where the mass sticks, it jumps to and fro for ever.
solver = asp.ProxJacobi(r=1e8, max_iterations=10**15)
ready = []
def report(step, steps):
    if step and not ready:
        ready.append(step)
        print("ready", flush=True)
try:
    asp.simulate(belt, dt=1e-3, t_end=10.0, solver=solver, sample_every=0.007, progress=report)
except asp.errors.SimulationInterrupted as stopped:
    print("interrupted", flush=True)
    part = stopped.trajectory
    assert 0 < part.steps < 1000
    assert part.t[-1] == part.end.t
    # The step that was given up has changed nothing.
    whole = asp.simulate(belt, dt=1e-3, t_end=part.end.t, solver=solver)
    assert whole.end == part.end
    raise SystemExit(42)
"""


@pytest.mark.parametrize(
    "script", [SIMULATE, WITHIN_A_STEP, SOLVE], ids=["simulate", "step", "solve"]
)
def test_interrupt_is_answered_at_once(script):
    found = run_interrupted(script)
    assert found.lines == ["interrupted"]
    assert found.code == 42
    assert found.seconds < PROMPT


SETS = """
import threading, time
import asperity as asp
import numpy as np
x = np.ones((10_000_000, 2))
x[:, 0] = np.linspace(-1.0, 1.0, len(x))
wedge = asp.WedgeAsperity(0.5, beta=0.6)
call = {call}
ticks = []
def tick():
    while True:
        ticks.append(time.perf_counter())
        time.sleep(0.005)
threading.Thread(target=tick, daemon=True).start()
print("ready", flush=True)
try:
    call(x)
except KeyboardInterrupt:
    print("interrupted", flush=True)
    print(len(ticks), flush=True)
    raise SystemExit(42)
"""
LONG_CALLS = {
    "gauge": "(asp.Superellipse(0.3, 0.2, 3.0) + asp.Ellipse(0.2, 0.1)).gauge",
    "gauge_gradient": "(asp.Superellipse(0.3, 0.2, 3.0) + asp.Ellipse(0.2, 0.1)).gauge_gradient",
    "project": "(asp.Superellipse(0.3, 0.2, 3.0) + asp.Ellipse(0.2, 0.1)).project",
    "support_point": "asp.sets.Mapped(wedge, [[1, 0.4], [0, 1]]).support_point",
    "force": "asp.FrictionLaw(asp.Disk(0.3) + asp.Disk(0.1), wedge).force",
    "cone": "asp.sets.Cone([np.ones((60, 2)) * np.cos(np.arange(60))[:, None]]).project",
}


@pytest.mark.parametrize("call", LONG_CALLS.values(), ids=LONG_CALLS.keys())
def test_interrupt_ends_a_call_with_ten_million_points_and_others_run_meanwhile(call):
    found = run_interrupted(SETS.format(call=call))
    word, ticks = found.lines
    assert word == "interrupted"
    assert found.code == 42
    assert found.seconds < PROMPT
    # Half a second without the interpreter would leave a handful.
    assert int(ticks) > 25


QUESTIONS = """
import asperity as asp
# The gauge of a sum is found by iteration.
tilted = asp.Ellipsoid([0.6, 0.3, 0.2]) & asp.Ellipsoid([0.3, 0.6, 0.2])
slow = tilted + asp.Ellipsoid([0.1, 0.3, 0.2])
other = slow | asp.Ellipsoid([0.1, 2.0, 0.1])
print("ready", flush=True)
try:
    {question}
except KeyboardInterrupt:
    print("interrupted", flush=True)
    raise SystemExit(42)
print("done", flush=True)
"""
LONG_QUESTIONS = ["other.is_convex", "other.is_symmetric", "slow.scale_inside(other)"]


@pytest.mark.parametrize("question", LONG_QUESTIONS)
def test_interrupt_ends_a_long_question_to_a_set(question):
    found = run_interrupted(QUESTIONS.format(question=question))
    assert found.lines == ["interrupted"]
    assert found.code == 42
    assert found.seconds < PROMPT


INTERRUPTED = """
import asperity as asp, numpy as np
problem = asp.problems.wall(12, columns=12)
rng = np.random.default_rng(0)
free = problem.free_velocity * (1 + 1e-2 * rng.normal(size=problem.free_velocity.size))
problem = problem.replace(free_velocity=free)
print("ready", flush=True)
try:
    while True:
        problem.solve({solver}, tolerance=1e-15, on_failure="record")
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""


@pytest.mark.skipif(os.name == "nt", reason="sends SIGINT")
@pytest.mark.parametrize("solver", ["asp.Auto()", "asp.ProximalPoint()", "asp.Exact()"])
def test_ctrl_c_ends_every_phase(solver):
    found = run_interrupted(INTERRUPTED.format(solver=solver), after=1.0)
    assert found.lines == ["interrupted"]
    assert found.code == 0
    assert found.seconds < 5.0
