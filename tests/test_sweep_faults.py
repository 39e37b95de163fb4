"""Stores of sweeps that are killed at any instant, have no space, or must not be written into."""

import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import asperity as asp
import numpy as np
import pytest
from profiles import counts, every
from sweep_functions import GRID, SEED, noted, reference

pytest.importorskip("resource", reason="needs processes and limits of POSIX")
pytest.importorskip("zarr")
xarray = pytest.importorskip("xarray")

TESTS = Path(__file__).parent
PAUSE = 0.004
OPTIONS = {"seed": SEED, "chunk": 4}
PREAMBLE = f"""
import os, sys
sys.path.insert(0, {os.fspath(TESTS)!r})
import asperity as asp
from sweep_functions import GRID, SEED, noted, several
import xarray, zarr
"""


def start(script, *arguments):
    return subprocess.Popen(
        [sys.executable, script, *map(str, arguments)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
    )


def run(script, *arguments):
    process = start(script, *arguments)
    try:
        output, errors = process.communicate(timeout=120.0)
    finally:
        process.kill()
    assert process.returncode == 0, errors
    return output


def constants(folder):
    return {"log": os.fspath(folder / "log"), "pause": PAUSE}


def committed(store):
    """Points that are done or failed, and whether they are what they must be."""
    if not store.exists():
        return set()
    found = reference()
    with xarray.open_zarr(store, chunks=None) as chart:
        status = chart.status.values
        for name, values in found.items():
            if name in chart:
                there = status > 0
                assert chart[name].values[there].tobytes() == values[there].tobytes(), name
    a, b = GRID.values()
    return {(a[i].item(), b[j].item()) for i, j in np.argwhere(status > 0)}


def computed(folder):
    """Points in the order in which they were computed."""
    log = folder / "log"
    lines = log.read_text().splitlines() if log.exists() else []
    return [tuple(map(float, line.split())) for line in lines]


SWEPT = f"""{PREAMBLE}
if __name__ == "__main__":
    folder, pause = sys.argv[1:]
    print("ready", flush=True)
    constants = {{"log": folder + "/log", "pause": float(pause)}}
    asp.sweep(noted, GRID, store=folder + "/x.zarr", seed=SEED, chunk=4, constants=constants)
"""


def one_run(script, folder, seconds=None):
    """Run until the end or for some seconds; return whether it ended, and what it computed."""
    already = len(computed(folder))
    process = start(script, folder, PAUSE)
    assert process.stdout.readline() == "ready\n"
    try:
        process.wait(timeout=120.0 if seconds is None else seconds)
    except subprocess.TimeoutExpired:
        process.send_signal(signal.SIGKILL)
    _, errors = process.communicate(timeout=60.0)
    assert process.returncode in (0, -signal.SIGKILL), errors
    # Workers end with the process that made them, perhaps a little later.
    time.sleep(0.05)
    return process.returncode == 0, computed(folder)[already:]


@counts(1, 100)
def test_a_sweep_that_is_killed_loses_what_was_in_flight_and_nothing_else(tmp_path, count):
    script = tmp_path / "swept.py"
    script.write_text(SWEPT)
    rng = np.random.default_rng(3)
    (tmp_path / "unbroken").mkdir()
    begin = time.perf_counter()
    ended, points = one_run(script, tmp_path / "unbroken")
    longest = time.perf_counter() - begin
    assert ended
    assert len(points) == len(committed(tmp_path / "unbroken" / "x.zarr"))
    kills = rounds = 0
    while kills < count:
        folder = tmp_path / f"{rounds}"
        folder.mkdir()
        ended, rounds = False, rounds + 1
        while not ended:
            before = committed(folder / "x.zarr")
            seconds = rng.uniform(0.0, longest) if kills < count else None
            ended, points = one_run(script, folder, seconds)
            kills += not ended
            assert len(set(points)) == len(points)
            assert not before & set(points), "computed twice"
            after = committed(folder / "x.zarr")
            assert before <= after
        assert len(after) == GRID["a"].size * GRID["b"].size
        assert asp.sweep_status(folder / "x.zarr").missing == 0
    print(f"{kills} kills, {rounds} sweeps")


FULL = f"""{PREAMBLE}
import resource

from concurrent.futures import ThreadPoolExecutor

def limited(done, whole):
    # As on a full disk, but for the number of the error.
    if done >= int(sys.argv[2]):
        resource.setrlimit(resource.RLIMIT_FSIZE, (5, 5))

if __name__ == "__main__":
    store = sys.argv[1] + "/new/x.zarr"
    options = dict(seed=SEED, chunk=20, executor=ThreadPoolExecutor(2))
    asp.sweep(several, GRID, store=sys.argv[1] + "/warm.zarr", **options)
    if sys.argv[2] == "-1":
        limited(0, 0)
    try:
        asp.sweep(several, GRID, store=store, progress=limited, **options)
    except OSError as error:
        assert error.filename == store, error.filename
        print(error.strerror)
"""


@pytest.mark.parametrize("done", every(3, [60, -1, 0]))
def test_a_full_disk_is_told_and_the_store_can_be_gone_on_with(tmp_path, done):
    script, store = tmp_path / "full.py", tmp_path / "new" / "x.zarr"
    script.write_text(FULL)
    assert run(script, tmp_path, done).strip() == "File too large"
    known = committed(store)
    assert len(known) >= done
    assert len(known) < GRID["a"].size * GRID["b"].size
    assert not list(store.parent.glob(".*.tmp"))
    assert not list(store.rglob(".*.tmp"))
    if done >= 0:
        with xarray.open_zarr(store, chunks=None) as chart:
            assert int((chart.status != 0).sum()) == len(known)
    from sweep_functions import several

    chart = asp.sweep(several, GRID, store=store, seed=SEED, chunk=20).load()
    for name, values in reference().items():
        assert chart[name].values.tobytes() == values.tobytes(), name


READ_ONLY = f"""{PREAMBLE}
from concurrent.futures import ThreadPoolExecutor

def stopped(done, whole):
    if done > 30:
        raise KeyboardInterrupt

if __name__ == "__main__":
    os.umask(0o022)
    folder = sys.argv[1]
    options = dict(seed=SEED, chunk=20, executor=ThreadPoolExecutor(2))
    whole = asp.sweep(several, GRID, store=folder + "/whole.zarr", **options).load()
    try:
        asp.sweep(several, GRID, store=folder + "/part.zarr", progress=stopped, **options)
    except asp.errors.SweepInterrupted:
        pass
    for place, names, files in os.walk(folder, topdown=False):
        os.chmod(place, 0o555)
    if os.getuid() == 0:
        # The administrator may write anywhere.
        os.setgid(65534)
        os.setuid(65534)
    again = asp.sweep(several, GRID, store=folder + "/whole.zarr", **options).load()
    assert again.identical(whole)
    assert 30 < asp.sweep_status(folder + "/part.zarr").done < whole.status.size
    with xarray.open_zarr(folder + "/part.zarr", chunks=None) as part:
        assert int((part.status > 0).sum()) > 30
    try:
        asp.sweep(several, GRID, store=folder + "/part.zarr", **options)
    except asp.ParameterError as error:
        print(error)
    try:
        asp.sweep(several, GRID, store=folder + "/new.zarr", **options)
    except OSError as error:
        print(error.strerror, error.filename)
"""


def test_a_store_that_must_not_be_written_is_read_and_told():
    place = Path(tempfile.mkdtemp())
    try:
        place.chmod(0o755)
        (place / "script.py").write_text(READ_ONLY)
        folder = place / "folder"
        folder.mkdir()
        part, new = run(place / "script.py", folder).splitlines()
        assert "store: must be a folder to write into" in part
        assert "part.zarr does not allow it" in part
        assert new == f"Permission denied {folder / 'new.zarr'}"
        assert not (folder / "new.zarr").exists()
    finally:
        subprocess.run(["chmod", "-R", "u+w", place], check=True)
        subprocess.run(["rm", "-r", place], check=True)


def test_the_reference_is_that_of_the_function_with_a_log(tmp_path):
    """What the script computes and what is compared with it are the same."""
    found = reference(noted, log=os.fspath(tmp_path / "log"), pause=0.0)
    for name, values in reference().items():
        np.testing.assert_array_equal(found[name], values)
    assert len(computed(tmp_path)) == values.size
