"""The command ``asperity sweep``: axes, stores, how far they are, errors in one line."""

import os
import subprocess
import sys

import numpy as np
import pytest
from asperity.commands.main import main

pytest.importorskip("zarr")
xarray = pytest.importorskip("xarray")

FILE = """
def point(phi, mu, rng=None):
    if mu > 0.25 and phi > 3.0:
        raise ValueError("no such place")
    return {"sum": phi + mu, "noise": 0.0 if rng is None else rng.normal()}
"""


@pytest.fixture
def chart(tmp_path, monkeypatch):
    """Each test has a module of its own, which others do not find among those that are loaded."""
    name = f"chart_{os.path.basename(tmp_path)}".replace("-", "_")
    (tmp_path / f"{name}.py").write_text(FILE)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path])
    return f"{name}.py"


def test_a_function_of_a_file_over_a_grid(chart, tmp_path, capsys):
    grid = ["--grid", "phi=0:180:5deg", "mu=0.2,0.3"]
    command = ["sweep", f"{chart}:point", *grid, "--store", "x.zarr", "--units", "sum=1"]
    assert main([*command, "--seed", "3", "--chunk", "4"]) == 1
    assert "Of 10 points 9 are done, 1 failed, 0 are missing: 100.0%." in capsys.readouterr().out
    with xarray.open_zarr(tmp_path / "x.zarr", chunks=None) as found:
        phi = np.linspace(0.0, np.pi, 5)
        np.testing.assert_allclose(found.phi, phi, rtol=1e-15)
        assert found.phi.attrs["units"] == "rad"
        assert found["sum"].attrs["units"] == "1"
        np.testing.assert_allclose(found["sum"][:4], np.add.outer(phi, [0.2, 0.3])[:4])
        assert found.status.values.ravel().tolist() == [1] * 9 + [2]
        assert len(np.unique(found.noise.values[:4])) == 8
    assert main(["sweep", "--status", "--store", "x.zarr"]) == 1
    assert "9 are done" in capsys.readouterr().out
    # The file is mended, which is another function.
    assert main([*command, "--seed", "4"]) == 2
    assert "asperity: --store: x.zarr holds another sweep" in capsys.readouterr().err
    assert main([*command, "--seed", "3", "--again"]) == 1


def test_a_cluster_by_its_address(chart, tmp_path):
    distributed = pytest.importorskip("distributed", reason="dask's scheduler")
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, processes=True, dashboard_address=None
    ) as cluster:
        grid = ["--grid", "phi=1,2", "mu=0.1", "--store", "x.zarr"]
        place = ["--scheduler", cluster.scheduler_address]
        done = subprocess.run(
            [sys.executable, "-m", "asperity", "sweep", f"{chart}:point", *grid, *place],
            capture_output=True,
            text=True,
            timeout=120,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
        )
    assert done.returncode == 0, done.stderr
    assert "Of 2 points 2 are done" in done.stdout


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--store", "x.zarr"], "function: must be given as FILE.py:FUNCTION, or --status"),
        (["chart.py", "--store", "x.zarr"], "function: must be given as FILE.py:FUNCTION"),
        (["none.py:point", "--store", "x"], "function: must be in a file, none.py is none"),
        (["{}:pint", "--store", "x"], "which has no 'pint'"),
        (["{}:point", "--store", "x"], "--grid: must hold values by names"),
        (["{}:point", "--store", "x", "--grid", "phi"], "--grid: must be given as NAME=..."),
        (["{}:point", "--store", "x", "--grid", "phi=0:1"], "--grid: must be FIRST:LAST:COUNT"),
        (["{}:point", "--store", "x", "--grid", "phi=0:1:0"], "--grid: must have values"),
        (["{}:point", "--store", "x", "--grid", "phi=1m,2s"], "--grid: must be FIRST:LAST:COUNT"),
        *(
            (["{}:point", "--store", "x", "--grid", f"phi={bad}"], "--grid: must be FIRST:LAST")
            for bad in ("nan", "1,-inf", "0.1,O.2", "O.2", "l.5", "1/3", "0.1.2", "1_0", "--2")
        ),
        (["{}:point", "--store", "x", "--grid", "phi=1", "mu=1", "--units", "x"], "--units: must"),
        (["--status", "--store", "nothing.zarr"], "--store: must hold a sweep"),
    ],
)
def test_what_is_wrong_is_said_in_a_line(chart, arguments, words, capsys):
    assert main(["sweep", *(one.format(chart) for one in arguments)]) == 2
    error = capsys.readouterr().err
    assert error.startswith("asperity: ")
    assert words in error
    assert error.count("\n") == 1


def test_without_libraries_the_line_says_what_installs_them(chart, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "zarr", None)
    call = ["sweep", f"{chart}:point", "--grid", "phi=1", "mu=1", "--store", "x.zarr"]
    assert main(call) == 2
    assert capsys.readouterr().err == 'asperity: zarr is missing: pip install "asperity[sweep]"\n'
    monkeypatch.setitem(sys.modules, "distributed", None)
    assert main([*call, "--scheduler", "tcp://nowhere:1"]) == 2
    expected = "asperity: distributed is missing: pip install distributed\n"
    assert capsys.readouterr().err == expected


def test_files_that_hide_other_modules_are_refused(tmp_path, monkeypatch, capsys):
    (tmp_path / "json.py").write_text(FILE)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path])
    assert main(["sweep", "json.py:point", "--grid", "phi=1", "mu=1", "--store", "x.zarr"]) == 2
    assert "function: must be in a file of another name" in capsys.readouterr().err
