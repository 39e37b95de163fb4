"""Scripts in processes of their own that are interrupted as by Ctrl-C."""

import queue
import signal
import subprocess
import sys
import threading
import time
from dataclasses import dataclass

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

    Its exit code, its lines after "ready", the delay of the first, and what it said of errors.
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
        sent = time.perf_counter()
        process.send_signal(signal.SIGINT)
        lines = [said.get(timeout=patience)]
        seconds = time.perf_counter() - sent
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


_END = "(end of output)"


def _read(stream, say):
    """Hand on every line of a stream, and its end."""
    with stream:
        for line in stream:
            say(line.rstrip("\n"))
    say(_END)
