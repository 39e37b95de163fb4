"""What differs between systems: encodings, what a terminal can show, paths."""

import ast
import io
import os
import subprocess
import sys
from pathlib import Path

import asperity as asp
import pytest
from asperity import identify
from asperity.commands.main import main
from asperity.commands.options import quoted

ROOT = Path(__file__).resolve().parents[1]
FOLDERS = ("python", "examples", "docs", "packaging")
SOURCES = [path for folder in FOLDERS for path in sorted((ROOT / folder).rglob("*.py"))]
FILES = {"read_text", "write_text", "TextIOWrapper"}


def unnamed_encodings(path):
    """Return the lines that read or write text in whatever encoding the system prefers."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if not isinstance(node, ast.Call):
            continue
        name = getattr(node.func, "attr", getattr(node.func, "id", ""))
        named = {one.arg for one in node.keywords}
        if "encoding" in named or None in named:
            continue
        modes = [one.value for one in node.args if isinstance(one, ast.Constant)]
        modes += [one.value.value for one in node.keywords if one.arg == "mode"]
        text = not any(isinstance(mode, str) and "b" in mode for mode in modes)
        # Libraries open pictures, films and archives by the same name.
        owner = getattr(getattr(node.func, "value", None), "id", "")
        opens = name == "open" and owner not in {"av", "Image", "tarfile", "zipfile"}
        entries = isinstance(node.func, ast.Attribute) and owner == "" and path.stem == "archive"
        if name in FILES or (opens and text and not entries):
            yield f"{path.relative_to(ROOT)}:{node.lineno}"


def test_every_text_has_an_encoding():
    """On Windows it would be one without Greek letters otherwise."""
    assert len(SOURCES) > 200
    assert not [line for path in SOURCES for line in unnamed_encodings(path)]


NUMPY_2 = {"acos", "asin", "atan", "atan2", "bitwise_count", "concat", "cumulative_sum", "isdtype",
           "matrix_transpose", "permute_dims", "trapezoid", "unstack", "vecdot"}  # fmt: skip
"""Names that NumPy 1.26, which will do, does not have."""


def test_names_of_numpy_are_those_of_all_its_releases():
    found = {
        f"{path.relative_to(ROOT)}: {node.attr}"
        for path in SOURCES
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Attribute)
        and getattr(node.value, "id", "") == "np"
        and node.attr in NUMPY_2
    }
    assert not found


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


@pytest.mark.parametrize("suffix", [".csv", ".toml", ".xlsx"])
def test_folders_are_called_so_on_every_system(tmp_path, monkeypatch, suffix):
    """Windows does not permit to open them; Linux says what they are."""
    folder = tmp_path / f"record{suffix}"
    folder.mkdir()

    def not_permitted(self, *arguments, **keywords):
        raise PermissionError(13, "Permission denied", str(self))

    for name in ("open", "read_bytes"):
        monkeypatch.setattr(Path, name, not_permitted)
    with pytest.raises(asp.AsperityError, match="is a folder: name the file in it"):
        asp.FrictionLaw.load(folder) if suffix == ".toml" else identify.read_csv(folder)
    if suffix == ".csv":
        with pytest.raises(asp.AsperityError, match="is a folder: name the file in it"):
            identify.inspect_file(folder)


def test_paths_are_quoted_as_the_shell_takes_them(monkeypatch):
    place = Path("a folder") / "law.toml"
    monkeypatch.setattr("asperity.commands.options.os.name", "nt")
    assert quoted(place) == f'"{place}"'
    monkeypatch.undo()
    if os.name != "nt":
        assert quoted(place) == "'a folder/law.toml'"
