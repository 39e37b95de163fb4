"""The examples in Python are scripts of a gallery: they run, print, and end in a picture.

Every public class is used in one of them, so that the reference can link to it.
"""

import ast
import contextlib
import functools
import importlib
import inspect
import io
import re
import runpy
import tempfile
import types
from pathlib import Path

import asperity as asp
import matplotlib.pyplot as plt
import pytest
from samples import public_of

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
FIGURES = sorted(EXAMPLES.glob("paper/*/fig*.py"))
SCRIPTS = [*(set(EXAMPLES.rglob("*.py")) - set(EXAMPLES.rglob("paper/**/*.py")))]
# They take data that are no part of the project: tests/test_measured_pushes.py runs them.
ON_DATA = set(EXAMPLES.rglob("measurements/*.py")) - set(EXAMPLES.rglob("paper/**/*.py"))
GALLERY = sorted(set(SCRIPTS) - ON_DATA)
CHARTS = EXAMPLES / "charts"
LINES = 40
SIZE = re.compile(r"^(SIZE\b.*? = )\d+", re.MULTILINE)
ROOMS = ("", ".identify", ".law", ".mechanisms", ".plot", ".predict", ".problems", ".track")


# Libraries of extras, without which a script is left out.
NEEDS = {
    "errors": ["xarray", "zarr"],
    "film_of_a_disk": ["av", "PIL"],
    "sweep_over_a_grid": ["xarray", "zarr"],
}


@functools.cache
def run(script):
    """Return the picture of a script, what it printed, and its variables at the end."""
    for library in NEEDS.get(script.stem, []):
        pytest.importorskip(library)
    text = script.read_text()
    # Charts take thousands of runs; a few show that the script works.
    text, found = SIZE.subn(r"\g<1>8", text)
    assert found or script.parent != CHARTS
    pictures, printed = [], io.StringIO()
    show, plt.show = plt.show, lambda: pictures.append(plt.gcf())
    plt.switch_backend("Agg")
    try:
        with tempfile.TemporaryDirectory() as folder:
            short, file = Path(folder) / script.name, io.BytesIO()
            short.write_text(text)
            with contextlib.redirect_stdout(printed):
                variables = runpy.run_path(str(short), run_name="__main__")
            (picture,) = pictures
            picture.savefig(file)
    finally:
        plt.show = show
        plt.close("all")
    return file.getvalue(), printed.getvalue(), variables


@pytest.mark.parametrize("script", GALLERY, ids=lambda path: path.stem)
def test_example(script):
    picture, printed, _ = run(script)
    assert picture.startswith(b"\x89PNG")
    assert printed


def used_classes(script):
    """Return the classes of what the names in a script stand for when it has ended.

    sphinx-gallery links these to the script: the class of a variable whose name or attributes are
    read, and the bases of a class that is called or whose methods and properties are.
    """
    variables, found = run(script)[2], set()
    tree = ast.parse(script.read_text())
    # sphinx-gallery takes ``a.b.c`` as a whole: ``a.b`` within it is no name of its own.
    inner = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Attribute)}
    for node in ast.walk(tree):
        if id(node) in inner:
            continue
        name, *attributes = dotted(node)
        if name not in variables:
            continue
        one, of_class = variables[name], False
        for attribute in attributes:
            if isinstance(getattr(type(one), attribute, None), property):
                of_class = True
                break
            following = getattr(one, attribute, None)
            if following is None or isinstance(following, types.MethodType):
                of_class = following is not None
                break
            one = following
        kind = one if inspect.isclass(one) else type(one)
        found.update(kind.__mro__ if of_class or kind is one else [kind])
    return found


def dotted(node):
    """Return the parts of a name with attributes, ``a.b.c``."""
    attributes = []
    while isinstance(node, ast.Attribute):
        attributes.insert(0, node.attr)
        node = node.value
    return (node.id, *attributes) if isinstance(node, ast.Name) else (None,)


def public_classes():
    """Return the classes among the public names of the package and of its rooms, by name."""
    rooms = [importlib.import_module(f"asperity{room}") for room in ROOMS]
    names = {
        f"{room.__name__}.{name}": one for room in rooms for name, one in public_of(room).items()
    }
    return {name: one for name, one in names.items() if inspect.isclass(one)}


def test_every_public_class_is_in_an_example():
    used = set().union(*map(used_classes, GALLERY))
    public = public_classes()
    assert len(public) > 150
    assert [name for name, one in public.items() if one not in used] == []


def test_classes_are_found_by_their_names():
    """An example that names neither a class nor a variable of it does not count."""
    used = used_classes(EXAMPLES / "laws" / "sliding_path.py")
    assert {asp.FrictionLaw, asp.SlidingPoint, asp.Superellipse, asp.StarSet} <= used
    assert asp.Ellipse not in used


@pytest.mark.parametrize("script", sorted(CHARTS.glob("*.py")), ids=lambda path: path.stem)
def test_charts_are_short(script):
    assert len(script.read_text().splitlines()) <= LINES


@pytest.mark.parametrize("script", [*sorted(SCRIPTS), *FIGURES], ids=lambda path: path.stem)
def test_examples_are_scripts_of_a_gallery(script):
    """A question as a title, what is learnt from it, and cells; every room has a header."""
    text = script.read_text()
    title, line, _, *rest = ast.get_docstring(ast.parse(text)).splitlines()
    assert set(line) == {"="}
    assert len(line) >= len(title)
    if script in FIGURES:
        assert "?" in " ".join(rest)
    else:
        assert title.endswith("?")
        assert "Learn" in " ".join(rest)
    assert re.search(r"^# %%$", text, re.MULTILINE)
    assert (script.parent / "GALLERY_HEADER.rst").exists()


def test_titles_are_different():
    titles = [
        ast.get_docstring(ast.parse(script.read_text())).splitlines()[0] for script in SCRIPTS
    ]
    assert len(set(titles)) == len(SCRIPTS) >= 24


def test_rooms_have_headers():
    rooms = {path.parent for path in [*SCRIPTS, *FIGURES]} | {EXAMPLES, EXAMPLES / "paper"}
    for room in rooms:
        title, line, *_ = (room / "GALLERY_HEADER.rst").read_text().splitlines()
        assert len(line) >= len(title)
