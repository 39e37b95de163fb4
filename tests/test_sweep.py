"""Sweeps: labels, what functions may return, failures, seeds, stores that are gone on with."""

import enum
import functools
import itertools
import json
import shutil
import subprocess
import sys
import threading
import warnings
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import asperity as asp
import numpy as np
import pytest
from asperity.sweeps import labelled_sweep
from asperity.sweeps.grid import Chunks, chunk_shape
from sweep_functions import GRID, SEED, reference, several

pytest.importorskip("zarr")
xarray = pytest.importorskip("xarray")

THREADS = ThreadPoolExecutor(2)


def swept(function, grid, **options):
    return asp.sweep(function, grid, **{"executor": THREADS, **options})


def plus(a, b=1.0):
    return a + b


def noisy(a, b, rng):
    del a, b
    return rng.normal()


def assert_equal(dataset, found):
    for name, values in found.items():
        assert dataset[name].dtype == values.dtype, name
        np.testing.assert_array_equal(dataset[name], values, err_msg=name)


@pytest.mark.parametrize("chunk", ["auto", 1, 4, 1000])
@pytest.mark.parametrize("place", [None, "chart.zarr"])
def test_results_are_those_of_a_loop(tmp_path, chunk, place):
    store = None if place is None else tmp_path / "new" / place
    chart = swept(several, GRID, seed=SEED, chunk=chunk, store=store)
    assert_equal(chart, reference())
    assert chart.product.dims == ("a", "b")
    assert chart.drawn.dims == ("a", "b", "drawn_0")
    for name, values in GRID.items():
        np.testing.assert_array_equal(chart[name], values)
    failed = chart.message.where(chart.status == 2, drop=True)
    assert failed.values.tolist() == [["ValueError: too much: 2.0"]]
    assert (failed.a.item(), failed.b.item()) == (2.0, 4.0)
    assert (chart.message == "").sum() == chart.status.size - 1


def test_labels_units_and_meanings():
    mu = xarray.DataArray([0.2, 0.3], dims="b", attrs={"units": "1"})
    chart = swept(several, {"a": [0.5, 1.5], "b": mu}, seed=0, units={"product": "N", "a": "m"})
    assert chart.a.attrs["units"] == "m"
    assert chart.b.attrs["units"] == "1"
    assert chart["product"].attrs["units"] == "N"
    assert chart.phase.attrs["flag_values"] == [-128, -1, 0, 1, 2]
    assert chart.phase.attrs["flag_meanings"] == "no_result none open stick slip"
    assert chart.large.attrs["flag_meanings"] == "no_result false true"
    assert chart.status.attrs["flag_meanings"] == "missing done failed"
    assert chart.attrs["function"] == "sweep_functions.several"
    assert chart.attrs["asperity"] == asp.__version__
    assert chart.attrs["seed"] == 0
    assert len(chart.attrs["fingerprint"]) == 64


@pytest.mark.parametrize(
    ("value", "kind", "expected"),
    [
        (2, "f8", 2.0),
        (np.float32(0.5), "f8", 0.5),
        (1.0 + 2.0j, "c16", 1.0 + 2.0j),
        (True, "i1", 1),
        (np.bool_(False), "i1", 0),
        (asp.Phase.OPEN, "i1", 0),
        (asp.Outcome.AT_REST, "i1", 1),
        (np.array([[1, 2]]), "f8", [[1.0, 2.0]]),
        (np.array([True, False]), "i1", [1, 0]),
        ([0.1, 0.2], "f8", [0.1, 0.2]),
    ],
    ids=repr,
)
def test_a_single_value_of_any_kind(tmp_path, value, kind, expected):
    def function(a):
        if a == 2.0:
            raise RuntimeError
        return value

    for store in (None, tmp_path / "x.zarr"):
        chart = swept(function, {"a": [1.0, 2.0]}, store=store)
        assert chart.value.dtype == np.dtype(kind)
        np.testing.assert_array_equal(chart.value[0], expected)
        nothing = -128 if kind == "i1" else np.nan
        np.testing.assert_array_equal(chart.value[1].values.real, np.full(np.shape(value), nothing))
        assert chart.message[1] == "RuntimeError"


@pytest.mark.parametrize("value", ["unstable", None, object(), [[1.0], [1.0, 2.0]], {}, {1: 2.0}])
def test_what_no_array_can_hold_is_a_failure(value):
    chart = swept(lambda a: value, {"a": [1.0, 2.0]})
    assert chart.status.values.tolist() == [2, 2]
    assert "must" in str(chart.message[0].item()) or "inhomogeneous" in str(chart.message[0].item())


@pytest.mark.parametrize("name", ["status", "message", "a", "two words"])
def test_results_need_names_that_are_free(name):
    chart = swept(lambda a: {name: a}, {"a": [1.0]})
    assert chart.status.values.tolist() == [2]
    assert name in str(chart.message[0].item())


DIFFERENT = {
    1.0: lambda: {"x": 1.0},
    2.0: lambda: {"x": 1.0, "y": 2.0},
    3.0: lambda: {"x": [1.0, 2.0]},
    4.0: lambda: {"x": True},
    5.0: lambda: {"x": 7},
    6.0: lambda: {"y": 1.0},
}


@pytest.mark.parametrize("chunk", [1, 2, 6])
def test_the_first_good_result_says_what_there_is(chunk):
    def function(a):
        return DIFFERENT[a]()

    chart = swept(function, {"a": list(DIFFERENT)}, chunk=chunk)
    assert chart.status.values.tolist() == [1, 2, 2, 2, 1, 2]
    assert chart.x.values.tolist()[4] == 7.0
    messages = chart.message.values.tolist()
    assert "must return x as before, got x, y" in messages[1]
    assert "shape (2,)" in messages[2]
    assert "false, true" in messages[3]
    assert "must return x as before, got y" in messages[5]


class Unspeakable(Exception):
    def __str__(self):
        raise RuntimeError("no words")


class Unreadable:
    def __array__(self, dtype=None, copy=None):
        raise RuntimeError("no array")


Many = enum.Enum("Many", [f"m{k}" for k in range(300)])
Known = enum.Enum("Known", ["A", "a", "two words"])
Mixed = enum.Flag("Mixed", ["LEFT", "RIGHT"])


def troublesome(a):
    """A result at zero and seven, and at each other point another trouble."""
    if a == 1.0:
        raise Unspeakable
    return {
        0.0: 1.0,
        2.0: {"a_b": 2.0},
        3.0: lambda: 0,
        4.0: Unreadable(),
        5.0: Many.m1,
        6.0: Mixed.LEFT | Mixed.RIGHT,
        7.0: 7.0,
    }[a]


@pytest.mark.parametrize("first", [0, 1])
def test_a_bad_point_is_a_failure_and_never_the_end(tmp_path, first):
    points = np.arange(float(first), 8.0)
    for options in ({"executor": None}, {"executor": THREADS, "store": tmp_path / "x.zarr"}):
        chart = asp.sweep(troublesome, {"a": points}, chunk=8, **options)
        messages = chart.message.sel(a=points[1:]).values.tolist()
        if first == 0:
            assert chart.status.values.tolist() == [1, *[2] * 6, 1]
            assert chart.value.sel(a=[0.0, 7.0]).values.tolist() == [1.0, 7.0]
            assert messages[0] == "Unspeakable"
            assert "must return value as before" in messages[1]
            messages = messages[1:]
        else:
            # What comes first counts.
            assert chart.status.values.tolist() == [2, 1, *[2] * 5]
        assert messages[1].startswith("TypeError: value: must be a number")
        assert messages[2] == "RuntimeError: no array"
        assert "at most 128, got <Many.m1: 2> of Many, which has 300" in messages[3]
        assert "of Mixed, which has 2" in messages[4]


def test_enumerators_with_names_that_are_nearly_alike(tmp_path):
    for store in (tmp_path / "x.zarr", tmp_path / "x.zarr"):
        grid = {"k": [0, 1, 2]}
        chart = swept(lambda k: list(Known)[int(k)], grid, store=store)
        # Their own numbers.
        assert chart.value.values.tolist() == [1, 2, 3]
        assert chart.value.attrs["flag_meanings"] == "no_result a a two_words"


@pytest.mark.parametrize("chunk", [1, 3])
def test_the_first_in_the_order_of_points_counts_not_in_that_of_time(chunk):
    import time

    def function(a):
        if a < 4.0:
            # Later points are done long before this one.
            time.sleep(0.05)
            raise ValueError("nothing here")
        if a == 4.0:
            time.sleep(0.05)
            return {"first": 1.0}
        return {"second": 2.0}

    chart = swept(function, {"a": np.arange(10.0)}, chunk=chunk, executor=ThreadPoolExecutor(4))
    assert set(chart.data_vars) == {"first", "status", "message"}
    assert chart.status.values.tolist() == [2] * 4 + [1] + [2] * 5


def test_nothing_but_failures_is_a_result_too(tmp_path):
    def function(a):
        raise ValueError("never")

    for store in (None, tmp_path / "x.zarr"):
        with pytest.warns(RuntimeWarning, match=r"at all 2 points, the first .* ValueError: never"):
            chart = swept(function, {"a": [1.0, 2.0]}, store=store)
        assert chart.status.values.tolist() == [2, 2]
        assert set(chart.data_vars) == {"status", "message"}


def test_a_failure_may_end_the_sweep(tmp_path):
    store = tmp_path / "x.zarr"
    options = {"seed": SEED, "store": store, "chunk": 9}
    with pytest.raises(asp.SweepError, match=r"at a = 2.0, b = 4.0: ValueError: too much") as e:
        swept(several, GRID, on_failure="raise", **options)
    assert e.value.point == {"a": 2.0, "b": 4.0}
    assert "sweep_functions.py" in e.value.traceback
    # The chunk is not committed: it fails again, and is a failure for who records them.
    with pytest.raises(asp.SweepError):
        swept(several, GRID, on_failure="raise", **options)
    assert_equal(swept(several, GRID, **options), reference())
    with pytest.raises(asp.SweepError):
        swept(several, GRID, on_failure="raise", **options)


def test_texts_are_values_too(tmp_path):
    def function(name, a):
        return len(name) * a

    for store in (None, tmp_path / "x.zarr"):
        chart = swept(function, {"name": ["oak", "steel"], "a": [1, 2]}, store=store)
        assert chart.value.sel(name="steel").values.tolist() == [5.0, 10.0]
    assert swept(function, {"name": np.array(["oak"]), "a": [1]}, constants={}).value.item() == 3.0


def outer(phi, zeta, scale):
    assert np.ndim(phi) == 1
    assert np.ndim(zeta) == 0
    return {"outer": scale * phi * zeta, "pairs": np.stack([phi, phi + zeta], axis=-1)}


@pytest.mark.parametrize("place", [None, "x.zarr"])
def test_whole_axes_for_functions_that_take_arrays(tmp_path, place):
    phi, zeta, scale = np.linspace(0.0, 1.0, 5), np.arange(7.0), np.array([1.0, 3.0])
    grid = {"zeta": zeta, "phi": phi, "scale": scale}
    store = None if place is None else tmp_path / place
    chart = swept(outer, grid, vector="phi", store=store, chunk=3)
    assert chart.outer.dims == ("zeta", "phi", "scale")
    assert chart.status.dims == ("zeta", "scale")
    expected = zeta[:, None, None] * phi[:, None] * scale
    np.testing.assert_array_equal(chart.outer, expected)
    np.testing.assert_array_equal(chart.pairs.sel(zeta=2.0, scale=3.0)[:, 1], phi + 2.0)


def test_all_axes_may_be_whole(tmp_path):
    def function(a, b):
        return np.add.outer(a, b)

    grid = {"a": [1.0, 2.0], "b": [10.0, 20.0, 30.0]}
    for store in (None, tmp_path / "x.zarr", tmp_path / "x.zarr"):
        chart = swept(function, grid, vector=("a", "b"), store=store)
        assert chart.value.values.tolist() == [[11.0, 21.0, 31.0], [12.0, 22.0, 32.0]]
    assert asp.sweep_status(tmp_path / "x.zarr").done == 1


def test_results_without_the_whole_axis_are_failures():
    chart = swept(lambda a: float(a.sum()), {"a": [1.0, 2.0]}, vector="a")
    assert "must begin with the shape (2,)" in str(chart.message.item())


def test_further_arguments():
    law = asp.FrictionLaw.isotropic(0.3)

    def function(a, law, factor):
        return factor * a * law.reservoir.radius(0.0)

    chart = swept(function, {"a": [1.0]}, constants={"law": law, "factor": 2.0})
    assert chart.value.item() == 0.6
    bound = functools.partial(function, law=law, factor=3.0)
    assert abs(swept(bound, {"a": [1.0]}).value.item() - 0.9) < 1e-15


def test_random_numbers_depend_on_the_seed_and_the_values_only():
    grid = {"a": [1.0, 2.0, 3.0], "b": [0.0, 0.5]}
    chart = swept(noisy, grid, seed=1)
    assert len(np.unique(chart.value)) == 6
    larger = swept(noisy, {"b": [9.0, 0.5, -0.0], "a": [3, 7, 2, 1]}, seed=1, chunk=2)
    for a in grid["a"]:
        for b in grid["b"]:
            assert chart.value.sel(a=a, b=b) == larger.value.sel(a=a, b=b)
    assert not (swept(noisy, grid, seed=2).value == chart.value).any()


def test_neighbours_in_seed_and_value_have_independent_numbers():
    grid = {"a": np.arange(200.0), "b": [0.0, 1.0]}
    one, two = (swept(noisy, grid, seed=seed).value.values for seed in (0, 1))
    for x, y in ((one[:, 0], one[:, 1]), (one[:, 0], two[:, 0]), (one[1:, 0], one[:-1, 0])):
        # Four standard deviations of the correlation of two hundred pairs.
        assert abs(np.corrcoef(x, y)[0, 1]) < 4.0 / np.sqrt(200.0)
    assert abs(one.mean()) < 4.0 / np.sqrt(one.size)


def interrupted_after(points):
    def report(done, _):
        if done >= points:
            raise KeyboardInterrupt

    return report


def test_a_sweep_goes_on_where_it_was(tmp_path):
    store, calls = tmp_path / "x.zarr", []

    def function(a, b, rng):
        calls.append((a, b))
        return several(a, b, rng)

    options = {"seed": SEED, "store": store, "chunk": 3}
    with pytest.raises(asp.errors.SweepInterrupted) as stopped:
        swept(function, GRID, progress=interrupted_after(30), **options)
    part = stopped.value
    assert 30 <= part.done < part.points == 117
    assert int((part.dataset.status != 0).sum()) == part.done
    assert f"interrupted at {part.done} of 117 points" in str(part)
    found, known = reference(), part.dataset.load()
    for name, values in found.items():
        there = known.status.values > 0
        np.testing.assert_array_equal(known[name].values[there], values[there])
    done = {(a, b) for i, a in enumerate(GRID["a"]) for j, b in enumerate(GRID["b"])
            if known.status.values[i, j]}  # fmt: skip
    calls.clear()
    assert_equal(swept(function, GRID, **options), found)
    assert len(calls) == len(set(calls)) == 117 - len(done)
    assert not done & set(calls)
    calls.clear()
    # All is there: nothing is computed, not even workers are asked.
    assert_equal(swept(function, GRID, **{**options, "executor": Unusable()}), found)
    assert not calls


class Unusable(ThreadPoolExecutor):
    def submit(self, *_, **__):
        raise AssertionError("nothing is to be computed")


def test_what_is_in_memory_is_returned_when_it_is_interrupted():
    with pytest.raises(asp.errors.SweepInterrupted) as stopped:
        swept(several, GRID, seed=SEED, chunk=3, progress=interrupted_after(30))
    assert int((stopped.value.dataset.status != 0).sum()) == stopped.value.done >= 30


def two_fails(a):
    if a == 2.0:
        raise ValueError("too much")
    return {"double": 2.0 * a}


def interrupted_in_a_commit(store, after):
    """Sweep, with Ctrl-C after so many lines of what commits chunks; None if there are fewer."""
    package, lines = Path(asp.__file__).parent, 0

    def within_a_commit(frame):
        while frame is not None and frame.f_code.co_name != "commit":
            frame = frame.f_back
        return frame is not None

    def line(frame, event, _):
        nonlocal lines
        if event == "line":
            lines += 1
            if lines == after + 1:
                raise KeyboardInterrupt
        return line

    def call(frame, *_):
        own = Path(frame.f_code.co_filename).is_relative_to(package)
        return line if own and within_a_commit(frame) else None

    sys.settrace(call)
    try:
        swept(two_fails, {"a": [1.0, 2.0, 3.0]}, chunk=2, store=store)
    except asp.errors.SweepInterrupted as stopped:
        return stopped
    finally:
        sys.settrace(None)
    return None


@pytest.mark.parametrize(("place", "step"), [(None, 1), ("x.zarr", 3)])
def test_ctrl_c_at_any_line_of_a_commit_leaves_what_it_says(tmp_path, place, step):
    """What is written and what is counted are the same, wherever Ctrl-C comes between them."""
    counts = []
    for after in itertools.count(step=step):
        store = None if place is None else tmp_path / str(after) / place
        stopped = interrupted_in_a_commit(store, after)
        if stopped is None:
            break
        known = stopped.dataset.load()
        counts.append(stopped.done)
        assert int((known.status != 0).sum()) == stopped.done, after
        assert ((known.message != "") == (known.status == 2)).all(), after
        if "double" in known:
            there = known.status.values == 1
            np.testing.assert_array_equal(known.double[there], 2.0 * known.a[there])
            assert np.isnan(known.double.values[~there & (known.status.values == 2)]).all()
        if store is not None:
            assert asp.sweep_status(store).done == int((known.status == 1).sum())
        if store is not None and after % 10 == 0:
            again = swept(two_fails, {"a": [1.0, 2.0, 3.0]}, chunk=2, store=store)
            assert again.status.values.tolist() == [1, 2, 1]
            assert again.message.values.tolist() == ["", "ValueError: too much", ""]
    assert len(counts) > 30
    assert set(counts) >= {0, 2}


def test_failed_points_are_computed_again_if_asked(tmp_path):
    broken = tmp_path / "broken"
    broken.touch()
    calls = []

    def function(a, b):
        calls.append((a, b))
        if broken.exists() and a == b:
            raise OSError("no connection")
        return {"sum": [a + b, a - b]}

    grid, options = {"a": [1.0, 2.0, 3.0], "b": [1.0, 2.0, 3.0]}, {"chunk": 6}
    for store in (tmp_path / "x.zarr",):
        assert (swept(function, grid, store=store, **options).status == 2).sum() == 3
        broken.unlink()
        calls.clear()
        assert (swept(function, grid, store=store, **options).status == 2).sum() == 3
        assert not calls
        chart = swept(function, grid, store=store, resume="failed", **options)
        assert sorted(calls) == [(1.0, 1.0), (2.0, 2.0), (3.0, 3.0)]
        assert (chart.status == 1).all()
        assert (chart.message == "").all()
        expected = np.array([[[a + b, a - b] for b in grid["b"]] for a in grid["a"]])
        np.testing.assert_array_equal(chart["sum"], expected)


def test_the_status_of_a_chunk_is_written_after_all_that_it_vouches_for(tmp_path, monkeypatch):
    from asperity.sweeps.folder import Folder

    store, written, put = tmp_path / "x.zarr", [], Folder._put

    def noted(self, name, *arguments):
        known = (store / "failures.jsonl").exists() and (store / "failures.jsonl").read_text()
        written.append((name, bool(known)))
        put(self, name, *arguments)

    monkeypatch.setattr(Folder, "_put", noted)
    swept(several, GRID, seed=SEED, store=store, chunk=9, executor=ThreadPoolExecutor(1))
    names = [name for name, _ in written]
    assert names == ["product", "drawn", "phase", "large", "status"] * 13
    # The last chunk has a point that failed.
    assert written[-1] == ("status", True)
    assert written[-2] == ("large", False)


def test_a_store_can_be_watched_while_it_grows(tmp_path):
    store, seen = tmp_path / "x.zarr", []

    def look(done, whole):
        with xarray.open_zarr(store, chunks=None) as chart:
            known = chart.status.values == 1
            assert int((chart.status.values != 0).sum()) == done
            if done:
                expected = np.add.outer(GRID["a"], GRID["b"])[known]
                np.testing.assert_array_equal(chart.value.values[known], expected)
                assert np.isnan(chart.value.values[~known]).all()
        status = asp.sweep_status(store)
        assert (status.done, status.points, status.failed) == (done, whole, 0)
        assert status.missing == whole - done
        assert status.missing > 0 or status.seconds_left == 0.0
        seen.append(status)

    swept(plus, GRID, store=store, chunk=20, progress=look)
    assert len(seen) > 3
    assert "is" in seen[0].summary()
    assert seen[-2].seconds_left > 0.0
    assert "the rest takes" in seen[-2].summary()


def other(a, b=1.0):
    return a - b


CHANGES = {
    "axis a: 13 values there, 12 here": {"grid": {**GRID, "a": GRID["a"][:12]}},
    "axis b: 0.0 there, 1.0 here": {"grid": {**GRID, "b": GRID["b"] + 1.0}},
    "the axes": {"grid": {"a": GRID["a"]}},
    "unit of a: None there, m here": {"units": {"a": "m"}},
    "function: test_sweep.plus there, test_sweep.other here": {"function": other},
    "constants: c=1.0 there, c=2.0 here": {"constants": {"c": 2.0}},
    "vector: ": {"vector": "b"},
}


def with_constant(a, b, c):
    return a + b + c


@pytest.mark.parametrize("words", CHANGES)
def test_a_store_of_something_else_is_refused_and_says_what_differs(tmp_path, words):
    change = CHANGES[words]
    call = {"function": plus, "grid": GRID, "store": tmp_path / "x.zarr"}
    if "constants" in change:
        call.update(function=with_constant, constants={"c": 1.0})
    before = swept(**call).load()
    with pytest.raises(asp.ParameterError) as refused:
        swept(**{**call, **change})
    assert refused.value.argument == "store"
    assert words in str(refused.value)
    xarray.testing.assert_identical(swept(**call).load(), before)


def test_another_version_source_or_seed_is_refused(tmp_path, monkeypatch):
    store = tmp_path / "x.zarr"
    swept(noisy, GRID, seed=1, store=store)
    with pytest.raises(asp.ParameterError, match="seed: 1 there, 2 here"):
        swept(noisy, GRID, seed=2, store=store)
    series = asp.__version__.rsplit(".", 1)[0]
    monkeypatch.setattr(labelled_sweep, "__version__", f"{series}.99")
    swept(noisy, GRID, seed=1, store=store)
    monkeypatch.setattr(labelled_sweep, "__version__", "9.9")
    with pytest.raises(asp.ParameterError, match=r"asperity: .* there, 9.9 here"):
        swept(noisy, GRID, seed=1, store=store)


MODEL = """
K = 2.0


def helper(x):
    return K * x


def point(x):
    return helper(x)
"""


def test_all_of_the_file_of_the_function_counts_but_not_its_comments(tmp_path, caplog):
    caplog.set_level("INFO", "asperity")

    def resumed(text):
        (tmp_path / "model.py").write_text(text)
        space = {"__name__": "model"}
        exec(compile(text, str(tmp_path / "model.py"), "exec"), space)
        return swept(space["point"], {"x": [1.0, 2.0]}, store=tmp_path / "x.zarr")

    assert resumed(MODEL).value.values.tolist() == [2.0, 4.0]
    assert not caplog.messages
    commented = MODEL.replace("2.0", "2.0  # N").replace(":\n", ':\n    """Same."""\n')
    assert resumed(f'"""Model."""\n{commented}').value.values.tolist() == [2.0, 4.0]
    assert "of 2 points, 2 are taken from the store" in caplog.messages[0]
    for change in (("2.0", "9.0"), ("K * x", "K + x"), ("return helper", "return -helper")):
        with pytest.raises(asp.ParameterError, match=r"source: \w+ there, \w+ here \(the function"):
            resumed(MODEL.replace(*change))


def test_functions_of_one_file_and_name_are_told_apart(tmp_path):
    for k, function in enumerate((lambda a: a, lambda a: 2.0 * a)):
        call = (function, {"a": [1.0]})
        if k:
            with pytest.raises(asp.ParameterError, match="source"):
                swept(*call, store=tmp_path / "x.zarr")
        else:
            swept(*call, store=tmp_path / "x.zarr")


def test_units_are_of_axes_and_results(tmp_path):
    for _ in range(2):
        for store in (None, tmp_path / "x.zarr"):
            with pytest.raises(asp.ParameterError, match=r"units: 'vale' .*did you mean 'value'"):
                swept(plus, GRID, store=store, units={"vale": "N"})
        # The second time the store has results.
        swept(plus, GRID, store=tmp_path / "x.zarr")


def test_equal_constants_are_the_same_in_every_process():
    script = (
        "import asperity as asp, numpy as np\n"
        "from asperity.sweeps.identity import identity_of\n"
        "law = asp.FrictionLaw(asp.Ellipse(0.6, 0.3), asp.Disk(0.3))\n"
        "names = {'x', 'yy', 'zzz'}\n"
        "values = dict(law=law, x=np.arange(2000.0), t=(1, [2.0, {'k': None}]), s=names, f=max)\n"
        "print(identity_of(len, values)['constants'])\n"
    )
    found = {
        subprocess.run(
            [sys.executable, "-c", script],
            capture_output=True,
            text=True,
            check=True,
            timeout=120,
            env={"PYTHONHASHSEED": str(k), "PYTHONPATH": ":".join(sys.path)},
        ).stdout
        for k in range(2)
    }
    assert len(found) == 1
    one, two = (asp.FrictionLaw(asp.Ellipse(0.6, b), asp.Disk(0.3)) for b in (0.3, 0.2))
    from asperity.sweeps.identity import identity_of

    assert identity_of(len, {"law": one}) != identity_of(len, {"law": two})


def enclosing(k):
    def function(a):
        return k * a

    return function


def by_default(k):
    def function(a, k=k):
        return k * a

    return function


def by_keyword(k):
    def function(a, *, k=k):
        return k * a

    return function


def by_another(k):
    inner = enclosing(k)

    def function(a):
        return inner(a)

    return function


def cached(k):
    return functools.cache(enclosing(k))


@pytest.mark.parametrize("make", [enclosing, by_default, by_keyword, by_another, cached])
def test_what_a_function_encloses_or_has_by_default_belongs_to_it(tmp_path, make):
    store = tmp_path / "x.zarr"
    swept(make(2.0), {"a": [1.0]}, store=store)
    with pytest.raises(asp.ParameterError, match=r"(closure: \w+|defaults: k)="):
        swept(make(3.0), {"a": [1.0]}, store=store)
    assert swept(make(2.0), {"a": [1.0]}, store=store).value.item() == 2.0


def test_a_function_may_call_itself_and_use_modules(tmp_path):
    import math

    def factorial(a):
        return 1.0 if a < 1.0 else a * factorial(a - 1.0) * math.cos(0.0)

    for _ in range(2):
        assert swept(factorial, {"a": [3.0]}, store=tmp_path / "x.zarr").value.item() == 6.0


def test_what_cannot_be_compared_is_refused_by_name_for_a_store_only(tmp_path):
    lock = threading.Lock()

    def function(a):
        with lock:
            return a

    assert swept(function, {"a": [3.0]}).value.item() == 3.0
    with pytest.raises(asp.ParameterError, match=r"enclosed variable lock is of class _thread"):
        swept(function, {"a": [3.0]}, store=tmp_path / "x.zarr")
    assert swept(lambda a, b: a, {"a": [3.0]}, constants={"b": lock}).value.item() == 3.0
    with pytest.raises(asp.ParameterError, match=r"constants: .* the constant b is of class _thr"):
        swept(lambda a, b: a, {"a": [3.0]}, constants={"b": lock}, store=tmp_path / "x.zarr")
    assert not (tmp_path / "x.zarr").exists()


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ([[1], 2], [[1, 2]]),
        (((1, 2), 3), ((1, 2, 3),)),
        ({"a": {"b": 1}, "c": 2}, {"a": {"b": 1, "c": 2}}),
        ([{1}, 2], [{1, 2}]),
        (asp.Ellipse(0.6, 0.3).support, asp.Ellipse(0.6, 0.2).support),
    ],
    ids=str,
)
def test_constants_that_differ_in_structure_or_owner_are_told_apart(one, other):
    from asperity.sweeps.identity import identity_of

    assert identity_of(len, {"c": one}) == identity_of(len, {"c": one})
    assert identity_of(len, {"c": one}) != identity_of(len, {"c": other})


@pytest.mark.parametrize(
    ("argument", "arguments"),
    [
        ("function", {"function": 3}),
        ("grid", {"grid": {}}),
        ("grid", {"grid": [1.0]}),
        ("grid", {"grid": {"c": [1.0]}}),
        ("grid", {"grid": {"status": [1.0]}}),
        ("grid['a']", {"grid": {"a": []}}),
        ("grid['a']", {"grid": {"a": 1.0}}),
        ("grid['a']", {"grid": {"a": [1.0, np.nan]}}),
        ("grid['a']", {"grid": {"a": [1.0, 1.0]}}),
        ("grid['a']", {"grid": {"a": [[1.0]]}}),
        ("grid['a']", {"grid": {"a": ["x", "x"]}}),
        ("grid['a']", {"grid": {"a": [None]}}),
        ("grid", {"grid": {"b": [1.0]}}),
        ("executor", {"executor": 3}),
        ("executor", {"executor": lambda: 3}),
        ("chunk", {"chunk": 0}),
        ("chunk", {"chunk": "many"}),
        ("on_failure", {"on_failure": "ignore"}),
        ("seed", {"seed": -1}),
        ("seed", {"seed": 1}),
        ("seed", {"function": noisy, "grid": {"a": [1.0], "b": [1.0]}}),
        ("resume", {"resume": "yes"}),
        ("progress", {"progress": 3}),
        ("constants", {"constants": {"c": 1.0}}),
        ("constants", {"constants": {"a": 1.0}}),
        ("constants", {"constants": 1.0}),
        ("units", {"units": "m"}),
        ("units", {"units": {"a": 1.0}}),
        ("vector", {"vector": "c"}),
        ("vector", {"vector": 1.0}),
    ],
)
def test_arguments_are_refused_by_name(argument, arguments):
    with pytest.raises(asp.ParameterError) as refused:
        swept(**{"function": plus, "grid": {"a": [1.0]}, **arguments})
    assert refused.value.argument == argument


def test_what_is_no_store_is_refused(tmp_path):
    (tmp_path / "file").write_text("mine")
    (tmp_path / "folder").mkdir()
    import zarr

    zarr.create_group(tmp_path / "other.zarr")
    for name in ("file", "folder", "other.zarr"):
        with pytest.raises(asp.ParameterError, match=f"store: must .*{name}"):
            swept(plus, {"a": [1.0]}, store=tmp_path / name)
    for name in ("file", "folder", "nothing"):
        with pytest.raises(asp.ParameterError, match=f"store: must hold a sweep.*{name}"):
            asp.sweep_status(tmp_path / name)
    assert (tmp_path / "file").read_text() == "mine"
    swept(plus, {"a": [1.0]}, store=tmp_path / "x.zarr")
    with pytest.raises(asp.ParameterError, match="store: must be new with resume=False"):
        swept(plus, {"a": [1.0]}, store=tmp_path / "x.zarr", resume=False)


@pytest.mark.filterwarnings("ignore:the store .* has missing or damaged results:RuntimeWarning")
def test_damaged_stores_are_refused_or_read(tmp_path):
    whole = tmp_path / "whole.zarr"
    swept(several, GRID, seed=SEED, chunk=30, store=whole)
    files = sorted(one.relative_to(whole) for one in whole.rglob("*") if one.is_file())
    assert len(files) > 30
    refused = []
    for k, name in enumerate(files):
        for damage in (lambda old: old[: len(old) // 2], lambda old: bytes(len(old)) + b"{"):
            if k % 3 and name.name not in ("zarr.json", "failures.jsonl", "session.json"):
                continue
            broken = tmp_path / "broken.zarr"
            shutil.copytree(whole, broken)
            (broken / name).write_bytes(damage((whole / name).read_bytes()))
            try:
                swept(several, GRID, seed=SEED, chunk=30, store=broken)
                asp.sweep_status(broken)
            except asp.AsperityError as error:
                refused.append(str(error))
            shutil.rmtree(broken)
    assert len(refused) >= 4
    assert all(text.startswith("store: ") for text in refused)


def test_results_that_are_lost_are_named_and_computed_again(tmp_path):
    store, calls = tmp_path / "x.zarr", []

    def function(a, b, rng):
        calls.append((a, b))
        return several(a, b, rng)

    options = {"seed": SEED, "chunk": 9, "store": store}
    swept(function, GRID, **options)
    calls.clear()
    # The last chunk has a point that failed.
    (store / "product" / "c.0.0").unlink()
    (store / "drawn" / "c.12.0.0").write_bytes(b"short")
    with pytest.warns(RuntimeWarning, match=r"drawn/c\.12\.0\.0, product/c\.0\.0; their points"):
        chart = swept(function, GRID, **options)
    assert_equal(chart, reference())
    assert len(calls) == 9 + 9
    assert {a for a, _ in calls} == {GRID["a"][0], GRID["a"][-1]}
    # What the function encloses must be what it was.
    calls.clear()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert_equal(swept(function, GRID, **{**options, "executor": Unusable()}), reference())


def test_results_without_any_number_can_be_stored(tmp_path):
    def function(a):
        return {"none": np.zeros((2, 0)), "one": a}

    for store in (None, tmp_path / "x.zarr", tmp_path / "x.zarr"):
        chart = swept(function, {"a": [1.0, 2.0, 3.0]}, store=store)
        assert chart.none.shape == (3, 2, 0)
        assert chart.one.values.tolist() == [1.0, 2.0, 3.0]
        assert (chart.status == 1).all()


def test_no_two_dimensions_have_one_name(tmp_path):
    def function(a_0):
        return {"a": np.array([1.0, 2.0]), "b": np.array([a_0]), "b_0": a_0}

    for store in (None, tmp_path / "x.zarr", tmp_path / "x.zarr"):
        chart = swept(function, {"a_0": [3.0, 4.0, 5.0]}, store=store)
        assert chart.a.dims == ("a_0", "a_0_")
        assert chart.b.dims == ("a_0", "b_0_")
        assert chart.a.shape == (3, 2)
        assert chart.b_0.values.tolist() == [3.0, 4.0, 5.0]


@pytest.mark.parametrize("damage", [b"\1\1\1\1\1\1\1", b"\1", b"\1\1\7\0", b"\1\1\1\1"])
def test_a_status_of_more_or_other_points_than_there_are_is_refused(tmp_path, damage):
    store = tmp_path / "x.zarr"
    swept(plus, {"a": [1.0, 2.0, 3.0]}, store=store, chunk=2)
    for file in (store / "status").glob("c*"):
        # Of the second chunk one point lies beyond the grid.
        file.write_bytes(damage[: len(damage) // 2] if len(damage) == 4 else damage)
    if damage == b"\1\1\7\0":
        (store / "status" / "c.1").write_bytes(damage[2:])
    with pytest.raises(asp.ParameterError, match=r"store: must hold a sweep, .* is damaged"):
        asp.sweep_status(store)


@pytest.mark.parametrize("store", ["", 3, b"x"])
def test_a_store_needs_a_name(store):
    with pytest.raises(asp.ParameterError, match="store: must name a folder"):
        swept(plus, {"a": [1.0]}, store=store)
    with pytest.raises(asp.ParameterError, match="store: must name a folder"):
        asp.sweep_status(store)


def test_messages_are_lines_of_json(tmp_path):
    store = tmp_path / "x.zarr"
    swept(several, GRID, seed=SEED, store=store)
    lines = (store / "failures.jsonl").read_text().split("\n")
    [line] = [json.loads(text) for text in lines if text]
    assert line["index"] == [12, 4]
    assert line["point"] == {"a": 2.0, "b": 4.0}
    assert line["error"] == "ValueError"
    assert line["message"] == "ValueError: too much: 2.0"
    assert "Traceback" in line["traceback"]


@pytest.mark.parametrize("shape", [(1,), (7,), (100, 51), (3, 5, 7), (2, 100, 3), ()])
@pytest.mark.parametrize("points", [1, 4, 500, 10**6])
def test_chunks_cover_the_grid_once(shape, points):
    size = chunk_shape(shape, points)
    chunks = Chunks(shape, size)
    seen = np.zeros(shape, int)
    for block in chunks:
        seen[block] += 1
    assert (seen == 1).all()
    assert np.prod(size) <= points
    assert len(list(chunks)) == len(chunks)


def test_without_the_extra_the_error_says_what_to_install(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "zarr", None)
    with pytest.raises(ModuleNotFoundError, match=r'pip install "asperity\[sweep\]"'):
        swept(plus, {"a": [1.0]}, store=tmp_path / "x.zarr")
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(ModuleNotFoundError, match=r'pip install "asperity\[sweep\]"'):
        swept(plus, {"a": [1.0]})


def test_progress_counts_points():
    heard = []
    swept(plus, GRID, chunk=50, progress=lambda done, whole: heard.append((done, whole)))
    assert heard[0] == (0, 117)
    assert heard[-1] == (117, 117)
    assert heard == sorted(heard)
