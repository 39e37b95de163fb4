"""Build the site: pages, gallery and reference in out/site, without a network.

    python site/build.py [--out out/site] [--no-rust]

What Sphinx reads is put together in a folder beside the result: the documentation, the examples,
and the pages of the reference, which are made from the public names. What has not changed is not
built again, and no example is run again. Warnings are errors; at the end every link within the site
must lead somewhere, and no page may load anything from outside.
"""

from __future__ import annotations

import argparse
import importlib
import inspect
import os
import re
import shutil
import subprocess
import sys
import time
import zlib
from collections.abc import Iterator, Sequence
from pathlib import Path

import links
from words import PACKAGE, SUBPACKAGES

SITE = Path(__file__).resolve().parent
ROOT = SITE.parent
ROOT_PAGES = ("ARCHITECTURE.md", "CHANGELOG.md", "CONTRIBUTING.md", "NOTATION.md", "RELEASING.md")
FILES = ("REFERENCES.bib", "CITATION.cff")
EXAMPLE = re.compile(r"\]\((?:\.\./)*examples/([\w/]+)\.py\)")
"""Links to scripts, which have pages in the gallery."""
CRATES = ("asperity-set", "asperity")
_SET = "asperity_set"


def main(arguments: Sequence[str] | None = None) -> int:
    """Build; return the exit code."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "site")
    parser.add_argument("--no-rust", action="store_true", help="leave out the pages of the crates")
    parser.add_argument("--jobs", default="auto", help="processes of Sphinx")
    options = parser.parse_args(arguments)
    start = time.perf_counter()
    out = options.out.resolve()
    source = out.parent / f"{out.name}-source"
    stage(source, rust=not options.no_rust)
    words = [sys.executable, "-m", "sphinx", "--builder", "html", "--fail-on-warning"]
    words += ["--quiet", "--jobs", options.jobs, "--doctree-dir", str(source / ".doctrees")]
    places = [str(SITE), str(ROOT / "examples"), os.environ.get("PYTHONPATH", "")]
    path = os.pathsep.join(filter(None, places))
    environment = {**os.environ, "PYTHONPATH": path, "OMP_NUM_THREADS": "1"}
    code = subprocess.run([*words, str(source), str(out)], env=environment, check=False).returncode
    if code:
        return code
    if not options.no_rust:
        rust(out / "rust")
    found = links.problems(out)
    print("\n".join(found[:50]), file=sys.stderr)
    print(f"{out}: {len(found)} bad links; {time.perf_counter() - start:.0f} s")
    return 1 if found else 0


def stage(source: Path, *, rust: bool) -> None:
    """Put together what Sphinx reads; files that are the same keep their times."""
    wanted = dict(pages(rust=rust))
    for name, content in wanted.items():
        _write(source / name, content)
    # Of what Sphinx and its extensions have written here, what belongs to something that is gone.
    for folder in ("docs", "scripts", "reference"):
        for path in sorted((source / folder).rglob("*"), reverse=True):
            name = path.relative_to(source).as_posix()
            made = name.startswith("reference/names/")
            if path.is_file() and name not in wanted and not made:
                path.unlink()
    kept = {name.path for name in PACKAGE.names}
    for path in (source / "reference" / "names").glob("*.rst"):
        if path.stem not in kept:
            path.unlink()


def pages(*, rust: bool) -> Iterator[tuple[str, bytes]]:
    """Yield every file that Sphinx reads, by its place."""
    yield "conf.py", (SITE / "conf.py").read_bytes()
    for path in sorted((SITE / "pages").rglob("*")):
        if path.is_file():
            yield path.relative_to(SITE / "pages").as_posix(), path.read_bytes()
    for name in ROOT_PAGES:
        text = _linked((ROOT / name).read_text(encoding="utf-8"))
        yield name, (notation(text) if name == "NOTATION.md" else text).encode()
    for name in FILES:
        yield name, (ROOT / name).read_bytes()
    for path in sorted((ROOT / "docs").rglob("*")):
        name = path.relative_to(ROOT).as_posix()
        if path.suffix == ".md":
            yield name, _linked(path.read_text(encoding="utf-8")).encode()
        elif path.suffix in (".png", ".svg"):
            yield name, path.read_bytes()
    yield from scripts()
    # Pages offer the examples in Rust as files.
    for path in sorted((ROOT / "examples").glob("*.rs")):
        yield path.relative_to(ROOT).as_posix(), path.read_bytes()
    for path in sorted((SITE / "inventories").glob("*.txt")):
        yield f"inventories/{path.stem}.inv", inventory(path.read_text(encoding="utf-8"))
    yield "reference/index.rst", contents(rust=rust).encode()
    yield "reference/equations.rst", equations().encode()
    for subpackage in SUBPACKAGES:
        yield f"reference/{subpackage}.rst", reference(subpackage).encode()


def scripts() -> Iterator[tuple[str, bytes]]:
    """Yield the examples: those of the paper are a gallery of their own."""
    examples = ROOT / "examples"
    for path in sorted(examples.rglob("*")):
        inside = path.relative_to(examples)
        if path.suffix not in (".py", ".rst", ".csv", ".toml") or "__pycache__" in inside.parts:
            continue
        if inside.parts[0] == "paper" and path.suffix == ".py" and path.stem[:3] != "fig":
            # What the figures share is imported from where it is.
            continue
        gallery = "" if inside.parts[0] == "paper" else "gallery/"
        yield f"scripts/{gallery}{inside.as_posix()}", path.read_bytes()


def contents(*, rust: bool) -> str:
    """Return the front page of the reference."""
    lines = [_title("Reference", "="), "What a program in Python imports, by subpackage.", ""]
    if rust:
        # Sphinx does not know these pages: they come when it is done.
        pages = (f'<a href="../rust/{name}/index.html">{name}</a>' for name in ("asperity", _SET))
        lines += [".. raw:: html", "", f"   <p>The crates in Rust: {', '.join(pages)}.</p>", ""]
    lines += [":doc:`equations` leads from equations of [WL19] to names, :doc:`/NOTATION` from"]
    lines += ["symbols.", ""]
    lines += [
        ".. toctree::",
        "   :maxdepth: 1",
        "",
        *(f"   {subpackage}" for subpackage in SUBPACKAGES),
    ]
    lines += ["   equations", ""]
    lines += [_title("What all values have in common", "-")]
    lines += [
        "Sets, laws, systems, solvers and results are values: they cannot be changed, are equal if",
        "all that they hold is equal, print as the call that makes them, and can be pickled.",
        "",
        ".. automethod:: asperity._base.value.Value.replace",
        "",
    ]
    return "\n".join(lines)


def reference(subpackage: str) -> str:
    """Return the page of a subpackage, with a table of its names."""
    names = [name for name in PACKAGE.names if name.subpackage == subpackage]
    said = inspect.getdoc(importlib.import_module(f"asperity.{subpackage}")) or ""
    # A directive for modules would be taken by autosummary for where the names below are.
    lines = [_title(SUBPACKAGES[subpackage], "="), said, ""]
    for title, group in (
        ("Classes", [name for name in names if name.is_class]),
        ("Functions", [name for name in names if not name.is_class]),
    ):
        if group:
            lines += [_title(title, "-")]
            lines += [".. autosummary::", "   :toctree: names", ""]
            lines += [*(f"   ~{name.path}" for name in group), ""]
    return "\n".join(lines)


def equations() -> str:
    """Return the index from the equations of the paper to what states or uses them."""
    lines = [_title("Equations", "="), "Which function belongs to which equation of [WL19], as its"]
    lines += ["description says; :doc:`/NOTATION` leads from symbols to names.", ""]
    lines += [".. list-table::", "   :header-rows: 1", "   :widths: 10 90", ""]
    lines += ["   * - equation", "     - stated or used by"]
    for number, paths in PACKAGE.equations.items():
        names = ", ".join(f":name:`{path.removeprefix('asperity.')}`" for path in paths)
        lines += [f"   * - .. _eq-{number}:", "", f"       \\({number})", f"     - {names}"]
    return "\n".join([*lines, ""])


def notation(text: str) -> str:
    """Link names and equations of the tables of symbols."""
    known = PACKAGE.equations
    classes = [name.path for name in PACKAGE.names if name.is_class]

    def name(match: re.Match[str]) -> str:
        word = match[1]
        path = PACKAGE.resolve(word)
        if path is None:
            # A method is said without its class where only one class has it.
            owners = {PACKAGE.resolve(word, inside) for inside in classes} - {None}
            path = owners.pop() if len(owners) == 1 else None
        return match[0] if path is None else "{name}`" + path.removeprefix("asperity.") + "`"

    def equation(match: re.Match[str]) -> str:
        number = int(match[1])
        return f"[({number})](#eq-{number})" if number in known else match[0]

    lines, column = [], None
    for line in text.splitlines():
        cells = re.split(r"(?<!\\)\|", line)
        if line.startswith("|") and " Python " in cells:
            column = cells.index(" Python ")
        elif not line.startswith("|"):
            column = None
        elif column is not None and len(cells) > column + 2:
            cells[column] = re.sub(r"`([\w.]+)`", name, cells[column])
            cells[-2] = re.sub(r"\((\d+)\)", equation, cells[-2])
            line = "|".join(cells)
        lines.append(line)
    return "\n".join([*lines, ""])


def rust(out: Path) -> None:
    """Put the pages of the crates beside the others."""
    target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "site"
    words = ["cargo", "doc", "--no-deps", "--locked", "--quiet", "--features", "asperity/serde"]
    words += [word for crate in CRATES for word in ("--package", crate)]
    environment = {**os.environ, "RUSTDOCFLAGS": "-D warnings", "CARGO_TARGET_DIR": str(target)}
    subprocess.run(words, cwd=ROOT, env=environment, check=True)
    shutil.copytree(target / "doc", out, dirs_exist_ok=True)


def inventory(text: str) -> bytes:
    """Return what intersphinx reads, of lines such as ``numpy.ndarray py:class page.html#$``."""
    project, *lines = [line for line in text.splitlines() if line and not line.startswith("#")]
    head = f"# Sphinx inventory version 2\n# Project: {project}\n# Version: \n"
    head += "# The remainder of this file is compressed using zlib.\n"
    entries = []
    for line in lines:
        name, role, place = line.split()
        entries.append(f"{name} {role} 1 {place} -\n")
    return head.encode() + zlib.compress("".join(entries).encode(), 9)


def _linked(text: str) -> str:
    def page(match: re.Match[str]) -> str:
        place = match[1] if match[1].startswith("paper/") else f"gallery/{match[1]}"
        return f"](/{place}.rst)"

    return EXAMPLE.sub(page, text)


def _title(text: str, mark: str) -> str:
    return f"{text}\n{mark * len(text)}\n"


def _write(path: Path, content: bytes) -> None:
    if path.exists() and path.read_bytes() == content:
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content)


if __name__ == "__main__":
    sys.exit(main())
