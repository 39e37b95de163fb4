"""What differs between systems: encodings, what a terminal can show, paths."""

import io
import os
import subprocess
import sys

import asperity as asp
import pytest
from asperity.commands.main import main

"""Names that NumPy 1.26, which will do, does not have."""


@pytest.fixture
def law(tmp_path):
    asp.FrictionLaw(asp.Ellipse(0.5, 0.3), asp.Ellipse(1.8, 1.2)).save(tmp_path / "law.toml")
    return tmp_path / "law.toml"


class Terminal(io.TextIOWrapper):
    def isatty(self):
        return True


@pytest.mark.parametrize("encoding", ["cp1252", "ascii", "utf-8"])
def test_pipes_and_files_get_utf_8(law, monkeypatch, encoding):
    monkeypatch.delenv("PYTHONIOENCODING", raising=False)
    written = io.BytesIO()
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(written, encoding=encoding))
    assert main(["law", str(law)]) == 0
    sys.stdout.flush()
    text = written.getvalue().decode("utf-8")
    assert "φ" in text or "°" in text or "≤" in text
    assert "?" not in text


@pytest.mark.parametrize("asked", [None, "ascii"])
def test_terminals_keep_their_encoding(law, monkeypatch, asked):
    """What it lacks is replaced; it was an error in the middle of the output."""
    written = io.BytesIO()
    kind = io.TextIOWrapper if asked else Terminal
    monkeypatch.setattr(sys, "stdout", kind(written, encoding="ascii"))
    monkeypatch.delenv("PYTHONIOENCODING", raising=False)
    if asked:
        monkeypatch.setenv("PYTHONIOENCODING", asked)
    assert main(["law", str(law)]) == 0
    sys.stdout.flush()
    text = written.getvalue().decode("ascii")
    assert "dissipative" in text
    assert "?" in text


def test_the_command_prints_where_nothing_but_ascii_is_known(law):
    """A process of its own, as a shell starts it."""
    environment = {**os.environ, "PYTHONIOENCODING": "ascii"}
    command = [sys.executable, "-m", "asperity", "law", os.fspath(law)]
    done = subprocess.run(command, env=environment, capture_output=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    assert b"dissipative" in done.stdout
