"""The command line: exit codes, files, no traceback for a user's error."""

import os
import subprocess
import sys

import asperity as asp
import pytest
from asperity.commands import demo
from asperity.commands.main import main
from asperity.demo import Check


def run(*arguments):
    return subprocess.run(
        [sys.executable, "-m", "asperity", *arguments],
        capture_output=True,
        text=True,
        check=False,
        timeout=600,
    )


@pytest.mark.skipif(os.name == "nt", reason="a pipe that closes is an error of its own there")
def test_readers_that_have_seen_enough_end_the_command(tmp_path):
    asp.FrictionLaw.isotropic(0.5).save(tmp_path / "law.toml")
    command = [sys.executable, "-m", "asperity", "law", str(tmp_path / "law.toml")]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        process.stdout.close()
        said = process.stderr.read()
        assert process.wait(60) == 141
    assert said == b""


def test_demo_writes_figures_and_tables_and_passes(tmp_path):
    out = tmp_path / "new" / "demo"
    done = run("demo", "--out", str(out))
    assert done.returncode == 0, done.stdout + done.stderr
    assert sorted(file.name for file in out.iterdir()) == [
        "fig17.csv",
        "fig17.png",
        "fig27.csv",
        "fig27.png",
        "roundtrip.csv",
        "roundtrip.png",
    ]
    for name in ("fig17.png", "fig27.png", "roundtrip.png"):
        assert (out / name).read_bytes().startswith(b"\x89PNG")
    for words in ("Fig. 17 period", "28.703", "order in dt", "round trip tracking", "0 off"):
        assert words in done.stdout
    assert "t [s]" in (out / "fig27.csv").read_text().splitlines()[0]


def test_a_check_that_is_off_exits_with_1(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(demo, "compute", lambda folder: [Check("period", 28.703, 28.6, 0.02)])
    assert main(["demo", "--out", str(tmp_path)]) == 1
    assert "OFF" in capsys.readouterr().out


def test_user_errors_exit_with_2_and_one_line(tmp_path):
    file = tmp_path / "file"
    file.write_text("")
    done = run("demo", "--out", str(file / "below"))
    assert done.returncode == 2
    assert done.stderr.startswith("asperity: ")
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize("arguments", [[], ["demo"], ["figures"]])
def test_wrong_usage_exits_with_2(arguments):
    done = run(*arguments)
    assert done.returncode == 2
    assert "usage: asperity" in done.stderr


def test_help_and_versions():
    assert "demo" in run("--help").stdout
    assert "example: asperity demo --out" in run("demo", "--help").stdout
    assert run("--version").stdout.strip() == f"asperity {asp.__version__}"
    info = run("info")
    assert info.returncode == 0
    assert "numpy" in info.stdout
    assert "build" in info.stdout


@pytest.mark.parametrize("verb", ["identify", "law"])
def test_help_explains_the_sets_of_a_law(verb, capsys):
    with pytest.raises(SystemExit) as ended:
        main([verb, "--help"])
    assert ended.value.code == 0
    text = " ".join(capsys.readouterr().out.split())
    for words in (
        "outline is the friction coefficient over the direction of the force",
        "the direction set D",
        "the friction force is turned",
    ):
        assert words in text
    assert "BIC" not in text or "by BIC, the Bayesian information criterion" in text
