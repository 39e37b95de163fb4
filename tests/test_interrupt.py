"""Ctrl-C stops a simulation or a solve at once; a simulation keeps what was computed."""

import os
import signal
import subprocess
import sys
import time

import pytest

SIMULATE = """
import time
import asperity as asp
belt = asp.MassOnBelt(1.0, 1.0, asp.FrictionLaw.isotropic(0.5), 1.0, [0.1, 0.0])
print("ready", flush=True)
try:
    asp.simulate(belt, dt=1e-6, t_end=1e6, save_every=1000)
except asp.SimulationInterrupted as stopped:
    print(time.time(), flush=True)
    trajectory = stopped.trajectory
    assert trajectory.steps > 0
    assert len(trajectory) >= trajectory.steps // 1000
    assert trajectory.phase_counts.sum() == trajectory.steps
    raise SystemExit(42)
"""

SOLVE = """
import time
import asperity as asp
import numpy as np
law = asp.FrictionLaw.isotropic(0.5)
problem = asp.ContactProblem(np.eye(2), [0.2, 0.3], law, normal_force=1.0)
print("ready", flush=True)
try:
    # The step is far too large: the iteration jumps from side to side for ever.
    problem.solve(asp.ProxJacobi(r=100.0, max_iterations=10**15))
except KeyboardInterrupt:
    print(time.time(), flush=True)
    raise SystemExit(42)
"""


@pytest.mark.skipif(os.name == "nt", reason="sends SIGINT")
@pytest.mark.parametrize("script", [SIMULATE, SOLVE], ids=["simulate", "solve"])
def test_interrupt_is_answered_at_once(script):
    process = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout.readline() == "ready\n"
        time.sleep(0.5)
        sent = time.time()
        process.send_signal(signal.SIGINT)
        assert float(process.stdout.readline()) - sent < 0.2
        assert process.wait(timeout=10.0) == 42
    finally:
        process.kill()
        process.stdout.close()
