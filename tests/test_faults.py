"""Files are complete or absent: writers that are killed, have no space, or must not write.

What is written and how it fails stands in `faults.py`, which runs in a process of its own.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("resource", reason="needs processes and limits of POSIX")

from faults import WRITERS

KILLS, MANY = 5, 100


def come_to_grief(name, count):
    program = Path(__file__).with_name("faults.py")
    done = subprocess.run(
        [sys.executable, program, name, str(count)],
        capture_output=True,
        text=True,
        env={**os.environ, "MPLBACKEND": "agg", "OMP_NUM_THREADS": "1"},
    )
    assert done.returncode == 0, done.stdout + done.stderr


# Of single files and of files that belong together: all others write through the same two.
@pytest.mark.parametrize("name", ["trajectory", "folder"])
def test_files_are_complete_or_absent(name):
    come_to_grief(name, KILLS)


@pytest.mark.long
@pytest.mark.parametrize("name", WRITERS)
def test_files_are_complete_or_absent_a_hundred_times(name):
    come_to_grief(name, MANY)
