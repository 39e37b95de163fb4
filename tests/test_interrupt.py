"""Ctrl-C stops a simulation at once and keeps what was computed."""

import os
import signal
import subprocess
import sys
import time

import pytest

SCRIPT = """
import sys
import asperity as asp
belt = asp.MassOnBelt(1.0, 1.0, asp.FrictionLaw.isotropic(0.5), 1.0, [0.1, 0.0])
print("ready", flush=True)
try:
    asp.simulate(belt, dt=1e-6, t_end=1e6, save_every=1000)
except asp.SimulationInterrupted as stopped:
    trajectory = stopped.trajectory
    assert trajectory.steps > 0
    assert len(trajectory) >= trajectory.steps // 1000
    assert trajectory.phase_counts.sum() == trajectory.steps
    sys.exit(42)
"""


@pytest.mark.skipif(os.name == "nt", reason="sends SIGINT")
def test_interrupt_keeps_the_part_before():
    process = subprocess.Popen([sys.executable, "-c", SCRIPT], stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout.readline() == "ready\n"
        time.sleep(0.5)
        sent = time.monotonic()
        process.send_signal(signal.SIGINT)
        assert process.wait(timeout=10.0) == 42
        assert time.monotonic() - sent < 1.0
    finally:
        process.kill()
        process.stdout.close()
