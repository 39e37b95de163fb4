"""Check a wheel or a source distribution as a user gets it: in an empty environment.

    python packaging/check_install.py dist/asperity-*.whl
    python packaging/check_install.py dist/asperity-*.whl --tests . --pytest="-k law"
    python packaging/check_install.py dist/asperity-*.tar.gz --tests

It makes an environment, installs the artefact, imports it far from the repository, and lets
``asperity demo`` compare its numbers. For a wheel there is no cargo on the path. With ``--tests``
it runs the tests of a folder, by default of the source distribution itself, on what is installed.
Exit code 0 if all of it is good.
"""

from __future__ import annotations

import argparse
import os
import shlex
import shutil
import subprocess
import sys
import tarfile
import tempfile
import venv
from collections.abc import Mapping, Sequence
from pathlib import Path

IMPORT = """
import pathlib, sys
import asperity as asp
assert pathlib.Path(asp.__file__).is_relative_to(sys.prefix), asp.__file__
law = asp.FrictionLaw(asp.Ellipse(0.54, 0.46), asp.Ellipse(1.8, 1.2))
assert law.force([1.0, 0.0], normal_force=9.3)[0] < 0.0
print("imported", asp.__version__, "on Python", sys.version.split()[0], sys.platform)
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Check one artefact; return the exit code."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("artefact", type=Path, nargs="+", help="a wheel or a .tar.gz")
    parser.add_argument("--extra", default="plot", help="of the package, to install with it")
    parser.add_argument(
        "--tests", nargs="?", const="", help="run the tests of this folder, or of the .tar.gz"
    )
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
        _check(artefact, Path(scratch), options)
    print(f"{artefact.name} is good")
    return 0


def _check(artefact: Path, scratch: Path, options: argparse.Namespace) -> None:
    built = artefact.suffix == ".whl"
    place = scratch / "environment"
    venv.create(place, with_pip=True)
    scripts = place / ("Scripts" if os.name == "nt" else "bin")
    python = scripts / Path(sys.executable).name
    if not python.exists():
        python = scripts / ("python.exe" if os.name == "nt" else "python")
    environment = _environment(scripts, without_rust=built)
    extra = "test" if options.tests is not None else options.extra * (not options.no_demo)
    run = [str(python), "-m", "pip", "install", "--disable-pip-version-check", "--quiet"]
    _run([*run, f"{artefact}[{extra}]" if extra else str(artefact)], scratch, environment)
    _run([str(python), "-c", IMPORT], scratch, environment)
    demo = (options.demo or scratch / "demo").resolve()
    asperity = shutil.which("asperity", path=str(scripts))
    assert asperity, "the command was not installed"
    _run([asperity, "info"], scratch, environment)
    if not options.no_demo:
        _run([asperity, "demo", "--out", str(demo)], scratch, environment)
        written = ("fig17.png", "fig27.csv", "roundtrip.png")
        missing = [name for name in written if not (demo / name).exists()]
        assert not missing, f"the demo has not written {missing}"
    if options.tests is not None:
        folder = Path(options.tests).resolve() if options.tests else _unpacked(artefact, scratch)
        words = ["-m", "pytest", "--numprocesses", "auto", "--dist", "loadscope"]
        # Tests read and write their own files as Python 3.15 does on every system. That the package
        # names its encodings is a test of its own.
        environment = {**environment, "PYTHONUTF8": "1"}
        _run([str(python), *words, *shlex.split(options.pytest)], folder, environment)


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
