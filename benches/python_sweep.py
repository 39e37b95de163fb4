"""Cost of `asp.sweep` per point, beside a bare pool of processes and a loop that writes.

Both call the same cheap function at the same points, in the same chunks of 500, by the same kind of
pool, and write two results into zarr arrays of the same chunks. Ratios are of the best of several
runs that take turns.
"""

import itertools
import multiprocessing
import resource
import shutil
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import asperity as asp
import numpy as np
import zarr
from report import ratio

WORKERS, CHUNK, TURNS = 2, 500, 3


def point(a, b):
    return {"sum": a + b, "product": a * b}


def computed(block):
    return [point(a, b) for a, b in itertools.product(*block)]


def grid(points):
    return {"a": np.arange(points // CHUNK) * 1.0, "b": np.linspace(0.0, 1.0, CHUNK)}


def bare(axes, path, pool):
    """Return seconds of a map over the chunks, and of writing what it returns."""
    start = time.perf_counter()
    a, b = axes.values()
    group = zarr.create_group(path)
    arrays = {
        name: group.create_array(
            name, shape=(len(a), len(b)), chunks=(1, CHUNK), dtype="f8", fill_value=np.nan
        )
        for name in ("sum", "product")
    }
    blocks = [([x], b.tolist()) for x in a.tolist()]
    for k, results in enumerate(pool.map(computed, blocks)):
        for name, array in arrays.items():
            array[k : k + 1, :] = np.array([[one[name] for one in results]])
    return time.perf_counter() - start


def swept(axes, path, pool):
    start = time.perf_counter()
    asp.sweep(point, axes, store=path, executor=pool, chunk=CHUNK)
    return time.perf_counter() - start


def compare(points):
    axes = grid(points)
    context = multiprocessing.get_context("forkserver")
    times = {bare: [], swept: []}
    with ProcessPoolExecutor(WORKERS, mp_context=context) as pool:
        # Imports and the start of processes are paid once, by neither.
        list(pool.map(computed, [([0.0], [0.0])] * 8))
        for _ in range(TURNS):
            for way, found in times.items():
                with tempfile.TemporaryDirectory() as folder:
                    found.append(way(axes, Path(folder, "store.zarr"), pool))
    plain, ours = (min(found) / points * 1e6 for found in times.values())
    print(f"{points} points, chunks of {CHUNK}, {WORKERS} processes, µs per point:")
    print(f"  map and writing {plain:.2f}, sweep {ours:.2f}: ratio {ours / plain:.2f} (bar 1.5)")
    ratio(
        "`asp.sweep` per point of a cheap function",
        ours / plain,
        "a bare map of a pool that writes the same arrays",
        "what statuses, failures and a store that can be gone on with cost",
    )


def many(points):
    """Say what a sweep of very many points leaves and takes."""
    folder = tempfile.mkdtemp()
    path = Path(folder, "store.zarr")
    axes = {"a": np.arange(1000.0), "b": np.linspace(0.0, 1.0, points // 1000)}
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    start = time.perf_counter()
    chart = asp.sweep(point, axes, store=path)
    seconds = time.perf_counter() - start
    after = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    files = sum(1 for one in path.rglob("*") if one.is_file())
    start = time.perf_counter()
    standing = asp.sweep_status(path)
    print(
        f"{points} points: {seconds:.0f} s, {files} files, memory grew by "
        f"{(after - before) / 1024:.0f} MB, status in {time.perf_counter() - start:.3f} s"
    )
    assert standing.done == points == int((chart["status"] == 1).sum())
    shutil.rmtree(folder)


if __name__ == "__main__":
    compare(300_000)
    for count in map(int, sys.argv[1:] or ("100000", "1000000")):
        many(count)
