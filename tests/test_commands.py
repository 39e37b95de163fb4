"""The command line: exit codes, files, no traceback for a user's error."""

import argparse
import itertools
import os
import re
import shutil
import subprocess
import sys

import asperity as asp
import numpy as np
import pytest
from asperity.commands import demo
from asperity.commands.main import _VERBS, main
from asperity.demo import Check
from asperity.identify import fit_law
from asperity.predict import write_example


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


def files_of(folder):
    """Return what files hold: archives also say when they were written."""
    found = {}
    for one in folder.iterdir():
        found[one.name] = one.read_bytes()
        if one.suffix == ".npz":
            with np.load(one) as archive:
                found[one.name] = {key: archive[key].tobytes() for key in archive}
    return found


def test_a_folder_holds_one_result(tmp_path, monkeypatch):
    """Written by A and then by B, it equals one that B alone has written, beside the user's own."""
    monkeypatch.setattr("asperity.plot.look.png", lambda figure, dpi: b"picture")
    phi = np.linspace(0.0, 6.0 * np.pi, 400, endpoint=False)
    ray = np.stack([np.cos(phi), np.sin(phi)], axis=-1)
    noise = 1e-3 * np.random.default_rng(1).normal(size=ray.shape)
    fit = fit_law((phi, 0.3 * ray + noise), reservoir="circle", direction="circle")
    fit.save_law(tmp_path / "fitted.toml")
    asp.FrictionLaw(asp.Ellipse(0.5, 0.4), asp.Ellipse(2.0, 1.0)).save(tmp_path / "other.toml")
    scenario = write_example("sliding point", tmp_path / "in")[0]
    changed = re.sub("samples = .*", "samples = 40", scenario.read_text())
    scenario.write_text(changed)
    model = write_example("squeal", tmp_path / "model")[0]
    model.write_text(model.read_text().replace("certify = true", "certify = false"))
    model = str(model)
    fitted, other = str(tmp_path / "fitted.toml"), str(tmp_path / "other.toml")
    again = str(shutil.copy(fitted, tmp_path / "again.toml"))
    commands = {
        "simulate": [
            [str(scenario), "--law", fitted],
            [str(scenario), "--law", fitted, "--bands"],
            [str(scenario), "--law", other, "--json"],
        ],
        "law": [[fitted], [other, "--json"]],
        "compare": [[fitted, again], [fitted, again, fitted, "--json"]],
        "stability": [[fitted], [other, "--json"]],
        "squeal": [[model, "--law", fitted], [model, "--law", other, "--json"]],
    }
    # Tests of faults write these one after the other; the last three have no such options.
    elsewhere = {"identify", "identify-paths", "track", "demo", "init", "export"}
    parsers = [verb.add(argparse.ArgumentParser().add_subparsers()) for verb in _VERBS]
    with_out = {one.prog.split()[-1] for one in parsers if "--out" in one.format_usage()}
    assert with_out == {*commands, *elsewhere}
    for verb, variants in commands.items():
        alone = []
        for k, variant in enumerate(variants):
            main([verb, *variant, "--out", str(tmp_path / verb / str(k))])
            alone.append(files_of(tmp_path / verb / str(k)))
        mixed = tmp_path / verb / "mixed"
        mixed.mkdir()
        (mixed / "mine.csv").write_text("mine")
        for first, last in itertools.permutations(range(len(variants)), 2):
            for name in files_of(tmp_path / verb / str(first)):
                shutil.copy(tmp_path / verb / str(first) / name, mixed)
            main([verb, *variants[last], "--out", str(mixed)])
            assert files_of(mixed) == {**alone[last], "mine.csv": b"mine"}


def test_results_of_two_commands_do_not_share_a_folder(tmp_path, capsys):
    """Both write report.html: the second one would take the place of the first."""
    law = tmp_path / "law.toml"
    asp.FrictionLaw(asp.Ellipse(0.5, 0.4), asp.Ellipse(2.0, 1.0)).save(law)
    out = tmp_path / "out"
    assert main(["law", str(law), "--out", str(out)]) == 0
    before = files_of(out)
    assert main(["stability", str(law), "--out", str(out)]) == 2
    assert "--out: holds report.html, of another command" in capsys.readouterr().err
    assert files_of(out) == before
    # After a kill between two files, the same command writes all of them again.
    for name in ("report.html", "sets.png"):
        (out / name).unlink()
    assert main(["law", str(law), "--out", str(out)]) == 0
    assert files_of(out) == before


@pytest.mark.skipif(os.name == "nt", reason="links take a permission there")
def test_what_is_read_is_not_replaced(tmp_path, capsys):
    law, link, problem = tmp_path / "law.toml", tmp_path / "link.toml", tmp_path / "one.npz"
    asp.FrictionLaw(asp.Ellipse(0.5, 0.4), asp.Ellipse(2.0, 1.0)).save(law)
    link.symlink_to(law)
    block = asp.ContactProblem(
        np.eye(3), free_velocity=[-1.0, 0.5, 3.0], laws=asp.FrictionLaw.isotropic(0.5)
    )
    block.save(problem)
    (tmp_path / "deeper").mkdir()
    spelt = tmp_path / "deeper" / ".." / "law.toml"

    def kept():
        return {name: (tmp_path / name).read_bytes() for name in ("law.toml", "one.npz")}

    before = kept()
    calls = [["export", law, "--to", "drake", "--out", one] for one in (law, link, spelt)]
    calls += [["export", link, "--to", "drake", "--out", law]]
    calls += [["solve", one, "--csv", problem] for one in (problem, tmp_path)]
    for call in calls:
        assert main([str(one) for one in call]) == 2
        assert "which is read" in capsys.readouterr().err, call
        assert kept() == before
    # Data under a name that the command writes, and images in the folder of the results.
    names = {"identify": "runs.csv", "identify-paths": "law.toml", "simulate": "results.csv",
             "law": "coefficients.csv", "compare": "comparison.csv", "stability": "growth.csv",
             "squeal": "modes.csv", "track": "path.csv"}  # fmt: skip
    for verb, name in names.items():
        out = tmp_path / verb
        out.mkdir()
        (out / name).write_bytes(law.read_bytes())
        config = ["--config", str(law)] if verb in ("identify", "identify-paths", "track") else []
        more = [str(law)] if verb == "compare" else []
        for folder in (out, out / ".." / verb):
            assert main([verb, str(out / name), *more, *config, "--out", str(folder)]) == 2
            assert f"--out: would replace {out / name}, which is read" in capsys.readouterr().err
        assert files_of(out) == {name: law.read_bytes()}
    assert main(["track", str(out), "--config", str(law), "--out", str(out)]) == 2
    assert f"--out: would replace {out}, which is read" in capsys.readouterr().err


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
