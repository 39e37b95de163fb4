"""Sweeps on every executor: the same bits; workers that are killed; Ctrl-C; pools that fork."""

import multiprocessing
import os
import signal
import subprocess
import sys
import textwrap
import time
from concurrent.futures import Future, ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

import asperity as asp
import numpy as np
import pytest
from asperity._base.pool import WorkerPool, available_cores, one_of_many, threads_to_use
from children import run_interrupted
from sweep_functions import (
    GRID,
    SEED,
    deadly,
    deadly_once,
    reference,
    several,
    surroundings,
)

pytest.importorskip("zarr")
xarray = pytest.importorskip("xarray")

TESTS = Path(__file__).parent


@pytest.fixture(scope="module")
def client():
    """A client of a cluster of two worker processes."""
    distributed = pytest.importorskip("distributed", reason="dask's scheduler")
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
        ) as cluster,
        distributed.Client(cluster) as found,
    ):
        yield found


def own(_):
    return None


def threads(_):
    return ThreadPoolExecutor(3)


def a_pool_of_the_user(_):
    return ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn"))


def a_function(_):
    return lambda: WorkerPool(1)


def loky(_):
    return pytest.importorskip("loky").get_reusable_executor(max_workers=2)


def dask(request):
    return request.getfixturevalue("client")


def executor_of_dask(request):
    return request.getfixturevalue("client").get_executor(pure=False)


def mpi(_):
    try:
        from mpi4py.futures import MPIPoolExecutor
    except (ImportError, RuntimeError) as error:
        pytest.skip(f"needs mpi4py and an MPI: {error}")
    return MPIPoolExecutor(2, path=sys.path)


EVERY = [own, threads, a_pool_of_the_user, a_function, loky, dask, executor_of_dask, mpi]


@pytest.mark.parametrize("executor", EVERY, ids=lambda one: one.__name__)
def test_every_executor_finds_the_same_bits(request, tmp_path, executor):
    store = tmp_path / "x.zarr"
    chart = asp.sweep(
        several, GRID, store=store, seed=SEED, chunk=5, executor=executor(request)
    ).load()
    for name, values in reference().items():
        assert chart[name].values.tobytes() == values.tobytes(), name
    assert asp.sweep_status(store).failed == 1


def test_functions_that_workers_cannot_import_travel_with_their_code(request, client):
    pytest.importorskip("cloudpickle")
    factor = 3.0
    for executor in (None, client, ThreadPoolExecutor(1)):
        chart = asp.sweep(lambda a: factor * a, {"a": [1.0, 2.0]}, executor=executor)
        assert chart.value.values.tolist() == [3.0, 6.0]


def test_without_cloudpickle_the_error_says_what_to_do(monkeypatch):
    monkeypatch.setitem(sys.modules, "cloudpickle", None)
    with pytest.raises(
        asp.ParameterError, match=r"function: cannot be sent .* install cloudpickle"
    ):
        asp.sweep(lambda a: a, {"a": [1.0]})


@pytest.mark.parametrize("executor", [None, ThreadPoolExecutor(1)], ids=["own", "threads"])
def test_workers_use_one_thread(executor):
    with pytest.MonkeyPatch.context() as patch:
        patch.delenv("OPENBLAS_NUM_THREADS", raising=False)
        chart = asp.sweep(surroundings, {"a": [1.0, 2.0]}, executor=executor)
        assert "OPENBLAS_NUM_THREADS" not in os.environ
    assert (chart.threads == 1).all()
    if executor is None:
        assert (chart.blas == 1).all()
        assert (chart.process != os.getpid()).all()
    assert threads_to_use() == available_cores()
    with one_of_many(), one_of_many():
        assert threads_to_use() == 1


@pytest.mark.parametrize("executor", [own, a_function, loky], ids=lambda one: one.__name__)
def test_a_worker_that_dies_costs_its_chunk(request, tmp_path, executor):
    if executor is loky:
        found = pytest.importorskip("loky")
        workers = lambda: found.get_reusable_executor(max_workers=2)  # noqa: E731
    else:
        workers = executor(request)
    chart = asp.sweep(
        deadly,
        {"a": np.arange(20.0)},
        constants={"victim": 7.0},
        chunk=2,
        executor=workers,
        store=tmp_path / "x.zarr",
    )
    assert chart.status.values.tolist() == [1] * 6 + [2, 2] + [1] * 12
    assert "a worker process died at these points, twice" in chart.message[6].item()
    there = np.delete(np.arange(20.0), [6, 7])
    np.testing.assert_array_equal(chart.value.sel(a=there), there)


def test_a_worker_that_is_killed_from_outside_costs_nothing(tmp_path):
    chart = asp.sweep(
        deadly_once,
        {"a": np.arange(20.0)},
        constants={"victim": 7.0, "marker": os.fspath(tmp_path / "killed")},
        chunk=2,
    )
    assert (tmp_path / "killed").exists()
    np.testing.assert_array_equal(chart.value, np.arange(20.0))


def test_an_executor_that_breaks_and_cannot_be_made_again_ends_the_sweep(tmp_path):
    grid, constants = {"a": np.arange(20.0)}, {"victim": 17.0}
    options = {"store": tmp_path / "x.zarr", "chunk": 2, "constants": constants}
    context = multiprocessing.get_context("spawn")
    with (
        ProcessPoolExecutor(1, mp_context=context) as pool,
        pytest.raises(asp.SweepError, match="worker processes of the executor have died"),
    ):
        asp.sweep(deadly, grid, executor=pool, **options)
    done = asp.sweep_status(tmp_path / "x.zarr").done
    assert 0 < done < 20
    assert int((asp.sweep(deadly, grid, **options).status == 1).sum()) == 18


def test_pools_that_fork_are_refused_by_name():
    if "fork" not in multiprocessing.get_all_start_methods():
        pytest.skip("this system does not fork")
    with (
        ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("fork")) as pool,
        pytest.raises(asp.ParameterError, match=r"executor: must not be a .* forks"),
    ):
        asp.sweep(deadly, {"a": [1.0]}, constants={"victim": 0.0}, executor=pool)


def run(script, *arguments, **options):
    return subprocess.run(
        [sys.executable, script, *arguments],
        capture_output=True,
        text=True,
        timeout=120,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
        **options,
    )


SCRIPT = """
import asperity as asp

def double(a):
    return 2.0 * a

{guard}
    print(asp.sweep(double, {{"a": [1.0, 2.0]}}).value.values.tolist())
"""


def test_functions_of_a_script(tmp_path):
    (tmp_path / "script.py").write_text(SCRIPT.format(guard='if __name__ == "__main__":'))
    done = run(tmp_path / "script.py")
    assert done.stdout.strip() == "[2.0, 4.0]", done.stderr


def test_a_script_without_a_guard_is_told(tmp_path):
    (tmp_path / "script.py").write_text(SCRIPT.format(guard="if True:"))
    done = run(tmp_path / "script.py")
    assert done.returncode == 1
    assert 'put its code behind if __name__ == "__main__":' in done.stderr.splitlines()[-1]


INTERRUPTED = textwrap.dedent("""
    import sys, tempfile
    sys.path.insert(0, {tests!r})
    import asperity as asp
    import numpy as np
    from sweep_functions import slow
    store = {store!r}
    started = []
    def report(done, whole):
        if done and not started:
            started.append(done)
            print("ready", flush=True)
    try:
        asp.sweep(slow, {{"a": np.arange(5000.0)}}, store=store, chunk=5, progress=report)
    except asp.errors.SweepInterrupted as stopped:
        print("interrupted", flush=True)
        assert int((stopped.dataset.status == 1).sum()) == stopped.done > 0
        raise SystemExit(42)
""")


@pytest.mark.skipif(os.name == "nt", reason="sends SIGINT")
def test_ctrl_c_ends_a_sweep_at_once_and_leaves_a_good_store(tmp_path):
    store = tmp_path / "x.zarr"
    found = run_interrupted(INTERRUPTED.format(tests=os.fspath(TESTS), store=os.fspath(store)))
    assert found.lines == ["interrupted"]
    assert found.code == 42, found.errors
    status = asp.sweep_status(store)
    assert 0 < status.done < 5000
    with xarray.open_zarr(store, chunks=None) as chart:
        there = chart.status.values == 1
        np.testing.assert_array_equal(chart.value.values[there], np.arange(5000.0)[there])


class KilledWorker(Exception):
    """As dask says of a task whose workers have died, while others go on."""


class Losing(ThreadPoolExecutor):
    """An executor that loses its second task."""

    tasks = 0

    def submit(self, function, /, *arguments, **options):
        self.tasks += 1
        if self.tasks != 2:
            return super().submit(function, *arguments, **options)
        lost = Future()
        lost.set_exception(KilledWorker("three times"))
        return lost


def test_a_task_that_a_cluster_gives_up_is_a_failure():
    chart = asp.sweep(lambda a: 2.0 * a, {"a": [1.0, 2.0, 3.0]}, chunk=1, executor=Losing(1))
    assert chart.status.values.tolist() == [1, 2, 1]
    assert chart.message[1] == "KilledWorker: three times"


ORPHANS = """
import os, sys, time
sys.path.insert(0, {tests!r})
import asperity as asp
from asperity._base.pool import WorkerPool
from sweep_functions import slow

if __name__ == "__main__":
    pool = WorkerPool(2)
    workers = set()
    while len(workers) < 2:
        workers.add(pool.submit(os.getpid).result())
        pool.submit(slow, 0.0)
    print(*workers, flush=True)
    time.sleep(60.0)
"""


@pytest.mark.skipif(not Path("/proc").exists(), reason="looks for processes in /proc")
def test_workers_end_with_the_process_that_made_them(tmp_path):
    (tmp_path / "script.py").write_text(ORPHANS.format(tests=os.fspath(TESTS)))
    process = subprocess.Popen(
        [sys.executable, tmp_path / "script.py"], stdout=subprocess.PIPE, text=True
    )
    workers = process.stdout.readline().split()
    process.send_signal(signal.SIGKILL)
    process.communicate(timeout=60.0)
    assert len(workers) == 2
    patience = time.monotonic() + 30.0
    while any(Path("/proc", one, "cmdline").exists() for one in workers):
        assert time.monotonic() < patience, "workers live on"
        time.sleep(0.02)
