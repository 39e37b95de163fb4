"""What editors and type checkers see of the package."""

import os
import re
import subprocess
import sys
from pathlib import Path

import asperity as asp
import pytest
from samples import public_of

ROOT = Path(__file__).resolve().parents[1]


def home(kind):
    """Return where a class is that is in its subpackage only."""
    return f"asp.{kind.__module__.split('.')[1]}.{kind.__name__}"


LAZY = ("identify", "mechanisms", "mujoco", "plot", "predict", "problems", "track")
NAMES = [
    *(f"asp.{name}" if name in asp.__all__ else home(one) for name, one in public_of(asp).items()),
    *(f"asp.{part}.{name}" for part in LAZY for name in public_of(getattr(asp, part))),
]


def test_completion_shows_subpackages_and_public_names():
    assert {*LAZY, *asp.__all__} == set(dir(asp))


def test_nothing_public_is_of_any_type(tmp_path):
    """A name that is Any has no completion, no signature and no check in any editor."""
    pytest.importorskip("mypy")
    lines = ["import asperity as asp", *(f"reveal_type({name})" for name in NAMES)]
    (tmp_path / "user.py").write_text("\n".join(lines))
    # In the project's folder and by its configuration, so that mypy knows the package already.
    command = [sys.executable, "-m", "mypy", os.fspath(tmp_path / "user.py")]
    package = os.fspath(Path(asp.__file__).parents[1])
    done = subprocess.run(
        command,
        cwd=ROOT,
        env={**os.environ, "MYPYPATH": package},
        capture_output=True,
        text=True,
        timeout=600,
    )
    found = re.findall(r'user\.py:(\d+): note: Revealed type is "(.*)"', done.stdout)
    types = {NAMES[int(line) - 2]: kind for line, kind in found}
    assert types.keys() == set(NAMES), done.stdout + done.stderr
    assert [name for name, kind in types.items() if re.search(r"(^|-> )Any$", kind)] == []
