"""Scripts in processes of their own that are interrupted as by Ctrl-C."""

import os
import queue
import signal
import subprocess
import sys
import threading
import time
from dataclasses import dataclass
from pathlib import Path

# A process that is started with SIGINT ignored, as by a shell in the background, ignores it for
# good unless it says otherwise, and so do its children.
_PREAMBLE = """
import signal
signal.signal(signal.SIGINT, signal.default_int_handler)
"""
_PATIENCE = 60.0


@dataclass(frozen=True)
class Interrupted:
    """How a script ended.

    Its exit code, its lines after "ready", the processor time that it took until the first of them,
    and what it said of errors.
    """

    code: int
    lines: list[str]
    seconds: float
    errors: str


def run_interrupted(script, *, after=0.5, patience=_PATIENCE):
    """Run a script that prints "ready", send SIGINT `after` seconds later and wait for its end.

    Nothing here waits for ever: a script that says nothing for `patience` seconds is killed and
    the test fails with what it wrote to standard error.
    """
    process = subprocess.Popen(
        [sys.executable, "-c", _PREAMBLE + script],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    said, errors = queue.Queue(), []
    readers = [
        threading.Thread(target=_read, args=(process.stdout, said.put), daemon=True),
        threading.Thread(target=_read, args=(process.stderr, errors.append), daemon=True),
    ]
    for reader in readers:
        reader.start()
    try:
        assert said.get(timeout=patience) == "ready"
        time.sleep(after)
        sent = _processor_time(process.pid)
        process.send_signal(signal.SIGINT)
        lines = [said.get(timeout=patience)]
        seconds = _processor_time(process.pid) - sent
        code = process.wait(timeout=patience)
    except (AssertionError, queue.Empty, subprocess.TimeoutExpired):
        process.kill()
        readers[1].join(timeout=patience)
        raise AssertionError("the script did not end as it should:\n" + "\n".join(errors)) from None
    finally:
        process.kill()
        process.wait(timeout=patience)
    for reader in readers:
        reader.join(timeout=patience)
    while not said.empty():
        lines.append(said.get())
    said_of_errors = "\n".join(line for line in errors if line != _END)
    return Interrupted(code, [line for line in lines if line != _END], seconds, said_of_errors)


def _processor_time(pid):
    """Seconds of processor that a process has had; the time, elsewhere than on Linux."""
    try:
        # The name of the program, in brackets, may have blanks.
        fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return time.perf_counter()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


_END = "(end of output)"


def _read(stream, say):
    """Hand on every line of a stream, and its end."""
    with stream:
        for line in stream:
            say(line.rstrip("\n"))
    say(_END)
