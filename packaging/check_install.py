"""Check a wheel or a source distribution as a user gets it: in an empty environment.

    python packaging/check_install.py dist/asperity-*.whl
    python packaging/check_install.py dist/asperity-*.whl --newcomer --tutorials
    python packaging/check_install.py dist/asperity-*.whl --tests . --pytest="-k law"
    python packaging/check_install.py dist/asperity-*.whl --tests dist/asperity-*.tar.gz
    python packaging/check_install.py dist/asperity-*.tar.gz --tests

It makes an environment, installs the artefact, imports it far from the repository, and lets
``asperity demo`` compare its numbers. For a wheel there is no cargo on the path. With ``--tests``
it runs the tests of a folder or of a source distribution, by default of the artefact itself, on
what is installed; with ``--tutorials`` the blocks of the tutorials. With ``--newcomer`` it types
what the README says under "Try it", in another empty environment, and prints what that took.
Exit code 0 if all of it is good.
"""

from __future__ import annotations

import argparse
import os
import re
import shlex
import shutil
import subprocess
import sys
import tarfile
import tempfile
import time
import venv
from collections.abc import Mapping, Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
IMPORT = """
import pathlib, sys
import asperity as asp
assert pathlib.Path(asp.__file__).is_relative_to(sys.prefix), asp.__file__
law = asp.FrictionLaw(asp.Ellipse(0.54, 0.46), asp.Ellipse(1.8, 1.2))
assert law.force([1.0, 0.0], normal_force=9.3)[0] < 0.0
print("imported", asp.__version__, "on Python", sys.version.split()[0], sys.platform)
"""

RECORD = """
import shutil
import asperity as asp
from asperity import identify
law = asp.FrictionLaw(asp.Superellipse(0.537, 0.457, 2.94), asp.Superellipse(1.84, 1.19, 2.51))
identify.VirtualTribometer(law, normal_force=9.3, turns=5, seed=1).write("campaign")
shutil.copy("campaign/run_1.csv", "record.csv")
"""
"""A record such as a newcomer may bring: without its calibration."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Check one artefact; return the exit code."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("artefact", type=Path, nargs="+", help="a wheel or a .tar.gz")
    parser.add_argument("--extra", default="plot", help="of the package, to install with it")
    parser.add_argument(
        "--tests", nargs="?", const="", help="run the tests of this folder or .tar.gz"
    )
    parser.add_argument("--tutorials", action="store_true", help="run the tutorials")
    parser.add_argument("--newcomer", action="store_true", help="type what the README says")
    parser.add_argument("--pytest", default="", help="options of pytest, in one text")
    parser.add_argument("--demo", type=Path, help="keep what the demo writes here")
    parser.add_argument(
        "--no-demo",
        action="store_true",
        help="import only, where there is no matplotlib to install",
    )
    options = parser.parse_args(arguments)
    if len(options.artefact) > 1:
        parser.error(f"one artefact at a time, got {', '.join(map(str, options.artefact))}")
    artefact = options.artefact[0].resolve(strict=True)
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as scratch:
        # Tests that begin as the administrator may go on as a user, who reads what is installed.
        Path(scratch).chmod(0o755)
        _check(artefact, Path(scratch), options)
        if options.newcomer:
            _newcomer(artefact, Path(scratch))
    print(f"{artefact.name} is good")
    return 0


def _check(artefact: Path, scratch: Path, options: argparse.Namespace) -> None:
    python, environment = _made(scratch / "environment", without_rust=artefact.suffix == ".whl")
    extra = "test" if options.tests is not None else options.extra * (not options.no_demo)
    run = [str(python), "-m", "pip", "install", "--disable-pip-version-check", "--quiet"]
    _run([*run, f"{artefact}[{extra}]" if extra else str(artefact)], scratch, environment)
    _run([str(python), "-c", IMPORT], scratch, environment)
    demo = (options.demo or scratch / "demo").resolve()
    asperity = shutil.which("asperity", path=str(python.parent))
    assert asperity, "the command was not installed"
    _run([asperity, "info"], scratch, environment)
    if not options.no_demo:
        _run([asperity, "demo", "--out", str(demo)], scratch, environment)
        written = ("fig17.png", "fig27.csv", "roundtrip.png")
        missing = [name for name in written if not (demo / name).exists()]
        assert not missing, f"the demo has not written {missing}"
    # Tests read and write their own files as Python 3.15 does on every system. That the package
    # names its encodings is a test of its own.
    environment = {**environment, "PYTHONUTF8": "1"}
    if options.tutorials:
        pages = sorted((ROOT / "docs" / "tutorials").glob("*.md"))
        assert len(pages) >= 3, "the tutorials are not beside this script"
        (scratch / "tutorials").mkdir()
        words = [str(ROOT / "tests" / "pages.py"), *map(str, pages)]
        _run([str(python), *words], scratch / "tutorials", {**environment, "MPLBACKEND": "Agg"})
    if options.tests is not None:
        given = Path(options.tests).resolve() if options.tests else artefact
        folder = given if given.is_dir() else _unpacked(given, scratch)
        words = ["-m", "pytest", "--numprocesses", "auto", "--dist", "loadscope"]
        _run([str(python), *words, *shlex.split(options.pytest)], folder, environment)


def first_commands(readme: str) -> list[list[str]]:
    """Return the blocks of commands that the README offers first: to a figure, then from a CSV."""
    part = readme.split("\n## Try it\n", 1)[1].split("\nFrom source", 1)[0]
    blocks = re.findall(r"(?:^    \S.*\n)+", part, re.M)
    return [[line.strip() for line in block.splitlines()] for block in blocks]


def _newcomer(artefact: Path, scratch: Path) -> None:
    """Type the first commands of the README in an empty environment, and time them."""
    python, environment = _made(scratch / "newcomer", without_rust=True)
    folder = scratch / "own"
    folder.mkdir()
    figure, own_file = first_commands((ROOT / "README.md").read_text(encoding="utf-8"))
    # Of the figure's commands the second one makes the scenario, which the file's path takes, too.
    assert len(figure) <= 3, figure
    assert len(own_file) + 2 <= 5, own_file
    print(f"+ with {artefact.name} for the name of the package:")
    total = _typed(figure, artefact, folder, environment)
    assert list((folder / "slide").rglob("*.png")), "no figure was drawn"
    print(f"  {total:6.1f} s to the first figure")
    _run([str(python), "-c", RECORD], folder, environment)
    total = _typed(own_file, artefact, folder, environment)
    drawn = [list((folder / place).glob("*.png")) for place in ("law", "slide/measured")]
    assert all(drawn), "a figure is missing"
    print(f"  {total:6.1f} s more from a CSV to its law and the path under it")


def _typed(
    commands: Sequence[str], artefact: Path, folder: Path, environment: Mapping[str, str]
) -> float:
    """Run commands; return the time that all of them took."""
    total = 0.0
    for command in commands:
        words = [one.replace("asperity[", f"{artefact}[") for one in shlex.split(command)]
        words[0] = shutil.which(words[0], path=environment["PATH"]) or words[0]
        start = time.perf_counter()
        done = subprocess.run(words, cwd=folder, env=environment, capture_output=True, text=True)
        seconds = time.perf_counter() - start
        # Exit code 1: guesses to be looked over, a law without a calibration.
        allowed = (0, 1) if "identify" in words else (0,)
        assert done.returncode in allowed, f"{command}\n{done.stdout}\n{done.stderr}"
        print(f"  {seconds:6.1f} s  {command}", flush=True)
        total += seconds
    return total


def _made(place: Path, *, without_rust: bool) -> tuple[Path, Mapping[str, str]]:
    """Make an empty environment; return its Python, and variables in which only it is found."""
    venv.create(place, with_pip=True)
    scripts = place / ("Scripts" if os.name == "nt" else "bin")
    python = scripts / Path(sys.executable).name
    if not python.exists():
        python = scripts / ("python.exe" if os.name == "nt" else "python")
    return python, _environment(scripts, without_rust=without_rust)


def _environment(scripts: Path, *, without_rust: bool) -> Mapping[str, str]:
    """Return variables in which only the environment's own Python packages are found."""
    foreign = ("PYTHON", "VIRTUAL_ENV", *(("CARGO", "RUST") if without_rust else ()))
    kept = {name: value for name, value in os.environ.items() if not name.startswith(foreign)}
    places = kept.get("PATH", "").split(os.pathsep)
    if without_rust:
        places = [one for one in places if not shutil.which("cargo", path=one)]
    kept["PATH"] = os.pathsep.join([str(scripts), *places])
    assert not without_rust or not shutil.which("cargo", path=kept["PATH"])
    return kept


def _unpacked(artefact: Path, scratch: Path) -> Path:
    with tarfile.open(artefact) as archive:
        archive.extractall(scratch / "source", filter="data")
    (folder,) = (scratch / "source").iterdir()
    return folder


def _run(command: Sequence[str], folder: Path, environment: Mapping[str, str]) -> None:
    print("+", *command, flush=True)
    subprocess.run(command, cwd=folder, env=environment, check=True)


if __name__ == "__main__":
    sys.exit(main())
