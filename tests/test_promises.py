"""Every promise of docs/promises.md is held by tests that exist and run."""

import ast
import re
import tomllib
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PAGE = (ROOT / "docs" / "promises.md").read_text(encoding="utf-8")
ROWS = [
    line.strip("| ").split(" | ")
    for line in PAGE.splitlines()
    if line.startswith("| ") and not line.startswith("| promise ")
]
NAMED = re.compile(r"`([\w./]+\.(?:py|rs))::(\w+)`")
TESTS = sorted({found for _, tests in ROWS for found in NAMED.findall(tests)})
ONLY_POSIX = ('os.name == "nt"', "needs processes and limits of POSIX", "a timer of POSIX")

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
# What the tests of an extra need: `make test` installs all of them.
LIBRARIES = {
    re.match(r"[\w-]+", one)[0]
    for group in PROJECT["optional-dependencies"].values()
    for one in group
}


@cache
def source(name):
    path = ROOT / name if "/" in name else ROOT / "tests" / name
    return path.read_text(encoding="utf-8")


def skips_of(file, name):
    """Return what may leave a test of Python out, as it is written; None without such a test."""
    module = ast.parse(source(file))
    tests = [one for one in module.body if isinstance(one, ast.FunctionDef) and one.name == name]
    if not tests:
        return None
    (test,) = tests
    doors = [one for one in module.body if isinstance(one, ast.Expr | ast.Assign)]
    marks = [one for one in doors if re.search("importorskip|pytestmark", ast.unparse(one))]
    texts = [ast.unparse(one) for one in (*marks, *test.decorator_list)]
    # Single variants of a test may be long or left out, not the test.
    found = [one for one in texts if re.match(r"pytest\.mark\.(skip|xfail|long)", one)]
    found += [one for one in texts if "importorskip" in one or "pytestmark" in one]
    found += [one for one in ast.unparse(test).splitlines() if "pytest.skip(" in one]
    # Python prints texts between single quotes.
    return [one.replace("'", '"') for one in found]


def is_test_of_rust(file, name):
    lines = source(file).splitlines()
    places = [i for i, line in enumerate(lines) if re.match(rf"\s*fn {name}\(", line)]
    if len(places) != 1:
        return False
    attributes = []
    for line in reversed(lines[: places[0]]):
        if not line.strip().startswith(("#[", "///")):
            break
        attributes.append(line.strip())
    return "#[test]" in attributes and not any("ignore" in one for one in attributes)


@pytest.mark.parametrize(("file", "name"), TESTS, ids=[name for _, name in TESTS])
def test_what_holds_a_promise_is_a_test_that_runs(file, name):
    if file.endswith(".rs"):
        assert is_test_of_rust(file, name)
        return
    skips = skips_of(file, name)
    assert skips is not None
    assert name.startswith("test_")
    left_out = [one for one in skips if not is_of_an_extra(one)]
    assert [one for one in left_out if not any(words in one for words in ONLY_POSIX)] == []
    if left_out:
        rows = [promise for promise, tests in ROWS if f"`{file}::{name}`" in tests]
        assert all("(POSIX)" in promise for promise in rows)


def is_of_an_extra(skip):
    needed = re.fullmatch(r'(?:\w+ = )?pytest\.importorskip\("(\w+)"\)', skip)
    return needed is not None and needed[1] in LIBRARIES


def test_every_promise_has_a_test():
    assert len(ROWS) > 30
    assert [promise for promise, tests in ROWS if not NAMED.search(tests)] == []
    # Everything between backticks beside a promise is a test.
    words = [one for _, tests in ROWS for one in re.findall("`[^`]+`", tests)]
    assert [one for one in words if not NAMED.fullmatch(one)] == []


@pytest.mark.parametrize(
    ("code", "runs"),
    [
        ("def test_it():\n    assert True", True),
        ("@pytest.mark.long\ndef test_it():\n    assert True", False),
        ("@pytest.mark.skip(reason='no')\ndef test_it():\n    assert True", False),
        ("@pytest.mark.xfail\ndef test_it():\n    assert True", False),
        ("def test_it():\n    pytest.skip('no')", False),
        ("pytestmark = pytest.mark.long\ndef test_it():\n    assert True", False),
        ("pytest.importorskip('yaml')\ndef test_it():\n    assert True", False),
        ("def test_other():\n    assert True", False),
    ],
)
def test_what_does_not_run_is_noticed(code, runs, monkeypatch):
    monkeypatch.setitem(globals(), "source", lambda name: code)
    assert (skips_of("test_x.py", "test_it") == []) is runs


@pytest.mark.parametrize(
    ("code", "runs"),
    [
        ("#[test]\nfn it() {", True),
        ("/// why\n#[test]\nfn it() {", True),
        ("#[test]\n#[ignore]\nfn it() {", False),
        ("fn it() {", False),
        ("#[test]\nfn other() {", False),
    ],
)
def test_what_does_not_run_in_rust_is_noticed(code, runs, monkeypatch):
    monkeypatch.setitem(globals(), "source", lambda name: code)
    assert is_test_of_rust("x.rs", "it") is runs


def test_warnings_of_deprecation_are_errors(pytestconfig):
    assert "error::DeprecationWarning" in pytestconfig.getini("filterwarnings")
