"""`asperity squeal --engine slepc`: eigenvalues by SLEPc in two processes of another Python.

Without slepc4py these tests are skipped; docs/howto/squeal.md says how it is installed.
"""

import json
import os
import shlex
import shutil
import subprocess
from glob import glob

import asperity as asp
import numpy as np
import pytest
from asperity import predict
from asperity.commands.main import main
from asperity.steady_sliding.sparse.nearest import nearest
from asperity.steady_sliding.sparse.slepc import nearest_by_slepc
from brake_pads import pad_system

EXTENDED = asp.FrictionLaw(asp.Ellipse(0.6, 0.3, angle=0.9), asp.Ellipse(0.5, 0.3))


@pytest.fixture
def slepc(monkeypatch):
    """Where nothing is set, look for what Debian installs."""
    for name in ("petsc", "slepc"):
        found = sorted(glob(f"/usr/lib/{name}dir/{name}*/*-complex"))
        if found and f"{name.upper()}_DIR" not in os.environ:
            monkeypatch.setenv(f"{name.upper()}_DIR", found[-1])
    if "ASPERITY_SLEPC" not in os.environ:
        monkeypatch.setenv("ASPERITY_SLEPC", "mpiexec --oversubscribe -n 2 /usr/bin/python3")
    for name in ("OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM"):
        monkeypatch.setenv(name, "1")
    command = shlex.split(os.environ["ASPERITY_SLEPC"])
    if shutil.which(command[0]) is None:
        pytest.skip(f"{command[0]} is not installed")
    ready = subprocess.run([command[-1], "-c", "import slepc4py"], capture_output=True, check=False)
    if ready.returncode:
        pytest.skip(f"{command[-1]} has no slepc4py")


@pytest.mark.parametrize(
    ("cells", "contacts"),
    [((6, 4, 2), None), pytest.param((33, 17, 10), 200, marks=pytest.mark.long)],
)
def test_two_processes_find_the_same_eigenvalues(slepc, cells, contacts):
    system = pad_system(cells, EXTENDED, phi=0.5, contacts=contacts)
    pencil = asp.stability(system, near=2e4, count=1).small_motions.pencil
    shift = 2j * np.pi * 3e3
    ours, radius = nearest(pencil, shift, 20)
    found, reach = nearest_by_slepc(pencil, shift, 20)
    assert reach == pytest.approx(radius, rel=1e-8)
    assert found.backward_errors.max() <= 1e-12
    apart = np.abs(found.values[:, None] - ours.values)
    assert (apart.min(axis=0) <= 1e-8 * np.abs(ours.values)).all()
    order = apart.argmin(axis=0)
    assert len(set(order)) == 20
    np.testing.assert_array_equal(found.sign_is_certain[order], ours.sign_is_certain)
    alike = np.abs(np.sum(found.modes[:, order].conj() * ours.modes, axis=0))
    np.testing.assert_allclose(alike, 1.0, rtol=1e-8)


def test_the_command_says_the_same_by_either_engine(slepc, tmp_path, capsys):
    example = predict.write_example("squeal", tmp_path)[0]
    text = example.read_text().replace("certify = true", "certify = false\ncount = 30")
    example.write_text(text.replace("friction = [0.5, 1.0]", "friction = 1.0"))
    said = []
    for options in ([], ["--engine", "slepc"]):
        assert main(["squeal", str(example), "--json", *options]) == 0
        said.append(json.loads(capsys.readouterr().out))
    ours, found = (np.array(one["modes"]) for one in said)
    assert said[0]["verdict"] == said[1]["verdict"]
    np.testing.assert_allclose(found[:, 2], ours[:, 2], rtol=1e-8)
    np.testing.assert_allclose(found[:, 3], ours[:, 3], atol=1e-8 * 2.0 * np.pi * ours[:, 2].max())


@pytest.mark.parametrize(
    ("command", "why"),
    [
        ("no-such-mpiexec -n 2 python3", "no-such-mpiexec"),
        ("python3 -c 'import slepc4py_missing'", "No module named 'slepc4py_missing'"),
    ],
)
def test_what_does_not_run_is_named(command, why, tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("ASPERITY_SLEPC", command)
    example = predict.write_example("squeal", tmp_path)[0]
    assert main(["squeal", str(example), "--engine", "slepc"]) == 2
    said = capsys.readouterr().err
    assert why in said
    assert "ASPERITY_SLEPC holds the command" in said
    with pytest.raises(asp.ParameterError, match="must be 'slepc'"):
        predict.describe_squeal(example, engine="arpack")
