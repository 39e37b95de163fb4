"""Sphinx: names in backticks become links, formulas are text, nothing comes from outside."""

from __future__ import annotations

import inspect
import re
from typing import Any

from docutils import nodes
from formulas import formula
from sphinx import addnodes
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment
from sphinx.util import logging
from sphinx.util.inspect import stringify_signature
from words import PACKAGE

_log = logging.getLogger(__name__)


def _inline_formula(self: Any, node: nodes.math) -> None:
    try:
        self.body.append(f'<em class="formula">{formula(node.astext())}</em>')
    except ValueError as error:
        _log.warning("%s", error, location=node)
    raise nodes.SkipNode


def _displayed_formula(self: Any, node: nodes.math_block) -> None:
    try:
        self.body.append(f'<p class="formula"><em>{formula(node.astext())}</em></p>')
    except ValueError as error:
        _log.warning("%s", error, location=node)
    raise nodes.SkipNode


def name_role(
    name: str, rawtext: str, text: str, lineno: int, inliner: Any, *_: Any
) -> tuple[list[nodes.Node], list[nodes.system_message]]:
    """Link what is a public name; everything else in backticks is code."""
    env: BuildEnvironment = inliner.document.settings.env
    inside = env.ref_context.get("py:class") or ""
    module = env.ref_context.get("py:module") or ""
    inside = f"{module}.{inside}" if module and inside else inside
    path = PACKAGE.resolve(text, inside)
    code = nodes.literal(rawtext, text)
    if path is None and PACKAGE.dangles(text):
        _log.warning("%r is no public name", text, location=(env.docname, lineno))
    if path is None or path == inside:
        return [code], []
    link = addnodes.pending_xref(
        rawtext, code, refdomain="py", reftype="obj", reftarget=path, refexplicit=True
    )
    link["refdoc"] = env.docname
    return [link], []


def public_target(
    app: Sphinx, env: BuildEnvironment, node: addnodes.pending_xref, inner: nodes.TextElement
) -> nodes.Node | None:
    """Resolve annotations, which name things as the sources import them.

    What has no page is text: names of the package that users do not import, and variables of types.
    Of other projects everything must be in the inventories.
    """
    if node.get("refdomain") != "py":
        return None
    target = node["reftarget"]
    path = PACKAGE.resolve(target)
    objects = env.domains.python_domain.objects
    if path is not None:
        if path not in objects:
            return None
        found = objects[path]
        return domain_link(app, node, inner, found.docname, found.node_id, path)
    last = target.rpartition(".")[2]
    if last in _ELSEWHERE:
        node["reftarget"] = _ELSEWHERE[last]
        return None
    if target.startswith("np."):
        node["reftarget"] = f"numpy.{target.removeprefix('np.')}"
        return None
    return None if target.partition(".")[0] in _PROJECTS else inner


def domain_link(
    app: Sphinx, node: nodes.Node, inner: nodes.Node, document: str, anchor: str, title: str
) -> nodes.reference:
    """Return a link to an object of the reference."""
    from sphinx.util.nodes import make_refnode

    return make_refnode(app.builder, node["refdoc"], document, anchor, [inner], title)


_PROJECTS = ("matplotlib", "numpy", "pandas", "scipy", "xarray")
_ELSEWHERE = {
    "ArrayLike": "numpy.typing.ArrayLike",
    "NDArray": "numpy.typing.NDArray",
    "Axes": "matplotlib.axes.Axes",
    "Figure": "matplotlib.figure.Figure",
    "Dataset": "xarray.Dataset",
    "Callable": "collections.abc.Callable",
    "Iterable": "collections.abc.Iterable",
    "Iterator": "collections.abc.Iterator",
    "Mapping": "collections.abc.Mapping",
    "Sequence": "collections.abc.Sequence",
    "Executor": "concurrent.futures.Executor",
    "AbstractContextManager": "contextlib.AbstractContextManager",
    "IntEnum": "enum.IntEnum",
    "IntFlag": "enum.IntFlag",
    "StrEnum": "enum.StrEnum",
    "PathLike": "os.PathLike",
    "Path": "pathlib.Path",
}
"""Where other projects describe what the sources import by its last name."""


def written_signature(
    app: Sphinx, what: str, name: str, value: Any, options: Any, given: str, returned: str
) -> tuple[str, str] | None:
    """Return signatures with annotations as they are written: an alias says more than its parts."""
    del app, options, given, returned
    if what not in ("class", "exception", "function", "method"):
        return None
    try:
        signature = inspect.signature(value)
    except (TypeError, ValueError):
        return None
    if what == "method":
        signature = _without_self(signature)
    text = stringify_signature(signature, show_return_annotation=False)
    result = signature.return_annotation
    if what in ("class", "exception") or result is inspect.Signature.empty:
        return text, ""
    return text, result if isinstance(result, str) else inspect.formatannotation(result)


def _without_self(signature: inspect.Signature) -> inspect.Signature:
    given = list(signature.parameters.values())
    if given and given[0].name in ("self", "cls"):
        given = given[1:]
    return signature.replace(parameters=given)


def public_bases(app: Sphinx, name: str, value: type, unused: Any, bases: list[Any]) -> None:
    """Leave out bases that only share code."""
    del app, name, unused
    path = PACKAGE.by_home.get(f"{value.__module__}.{value.__qualname__}")
    if path is not None:
        bases[:] = PACKAGE.bases(PACKAGE.by_path[path]) or bases


def plain_bars(
    app: Sphinx, what: str, name: str, value: Any, options: Any, lines: list[str]
) -> None:
    """Let bars be absolute values, and equations of [WL19] lead to their index.

    reStructuredText takes bars for substitutions.
    """
    del app, what, name, value, options
    for i, line in enumerate(lines):
        if not line.lstrip().startswith((">>>", "...")):
            parts = re.split(r"(``.*?``|`[^`]*`)", line)
            parts[::2] = [part.replace("|", r"\|") for part in parts[::2]]
            lines[i] = "".join(parts)
        if "[WL19]" in line:
            head, mark, rest = lines[i].partition("[WL19]")
            lines[i] = head + mark + re.sub(r"\((\d+)\)", _to_index, rest)


def sentence_first(
    app: Sphinx, what: str, name: str, value: Any, options: Any, lines: list[str]
) -> None:
    """Keep Napoleon from taking what stands before a colon for the type of a property."""
    del app, name, value, options
    if what == "property":
        # An empty comment: it drops empty lines.
        lines[:0] = ["..", ""]


def _to_index(match: re.Match[str]) -> str:
    known = int(match[1]) in PACKAGE.equations
    return f":ref:`({match[1]}) <eq-{match[1]}>`" if known else match[0]


def no_part_alone(app: Sphinx, doctree: nodes.document) -> None:
    """Say how scripts of the paper are run, in place of downloads: they import their neighbours."""
    name = app.env.docname
    if not name.startswith("paper/"):
        return
    for node in [*doctree.findall(nodes.Element)]:
        classes = node.get("classes", [])
        if "sphx-glr-download-link-note" in classes:
            node.parent.remove(node)
        elif "sphx-glr-footer" in classes:
            command = f"python -m {name.replace('/', '.')}"
            words = nodes.paragraph()
            words += nodes.Text("The script needs modules of the repository: ")
            words += nodes.literal(text=command)
            words += nodes.Text(" in ")
            words += nodes.literal(text="examples/")
            words += nodes.Text(" runs it.")
            whole = node.get("classes").count("sphx-glr-footer-gallery")
            node.parent.replace(node, [] if whole else [words])


def setup(app: Sphinx) -> dict[str, Any]:
    """Register all of it."""
    app.setup_extension("sphinx.ext.autodoc")
    app.add_role("name", name_role)
    app.connect("missing-reference", public_target, priority=100)
    app.connect("autodoc-process-signature", written_signature)
    app.connect("autodoc-process-bases", public_bases)
    # After the labels within what is taken out have been read.
    app.connect("doctree-read", no_part_alone, priority=900)
    app.connect("autodoc-process-docstring", plain_bars)
    app.connect("autodoc-process-docstring", sentence_first, priority=400)
    app.add_html_math_renderer("unicode", (_inline_formula, None), (_displayed_formula, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True, "version": "1"}
