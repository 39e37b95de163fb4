"""What the site is made of: names that become links, the index of equations, the check of links."""

import re
from pathlib import Path
from types import SimpleNamespace

import asperity as asp
import build
import links
import pytest
import words
from formulas import formula

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = words.PACKAGE


def test_every_public_name_has_a_page():
    names = set(asp.__all__) - {"__version__"}
    assert {f"asperity.{name}" for name in names} <= set(PACKAGE.by_path)
    for room in ("identify", "mechanisms", "plot", "predict", "problems", "track"):
        assert any(name.room == room for name in PACKAGE.names)
    assert len(PACKAGE.by_path) == len(PACKAGE.names)


def test_members_are_on_the_page_of_the_class_that_has_them():
    members = {path: PACKAGE.members(PACKAGE.by_path[f"asperity.{path}"]) for path in
               ("Ellipse", "StarSet", "FrictionLaw", "Trajectory")}  # fmt: skip
    assert "from_intercepts" in members["Ellipse"]
    assert "gauge" not in members["Ellipse"]
    assert {"gauge", "project", "normal_cone"} <= set(members["StarSet"])
    assert {"force", "is_dissipative"} <= set(members["FrictionLaw"])
    assert {"summary", "to_pandas"} <= set(members["Trajectory"])


@pytest.mark.parametrize(
    ("text", "inside", "path"),
    [
        ("FrictionLaw", "", "asperity.FrictionLaw"),
        ("asp.FrictionLaw.force", "", "asperity.FrictionLaw.force"),
        ("force", "asperity.FrictionLaw", "asperity.FrictionLaw.force"),
        ("Ellipse.gauge", "", "asperity.StarSet.gauge"),
        ("identify.fit_law", "", "asperity.identify.fit_law"),
        ("fit_law()", "", "asperity.identify.fit_law"),
        ("asperity.law.friction.FrictionLaw", "", "asperity.FrictionLaw"),
        ("Phase.STICK", "", "asperity.Phase"),
        ("RawData.normal_load", "", "asperity.identify.RawData"),
        ("Phase.nothing", "", None),
        ("force", "", None),
        ("numpy.ndarray", "", None),
        ("Bands", "", "asperity.identify.Bands"),
    ],
)
def test_words_in_backticks_are_resolved(text, inside, path):
    assert PACKAGE.resolve(text, inside) == path


def test_no_public_name_means_two_things():
    assert [name for name, paths in PACKAGE.by_last.items() if len(paths) > 1] == []


def test_names_that_dangle_are_told():
    assert not PACKAGE.dangles("FrictionLaw.force")
    assert not PACKAGE.dangles("D")
    assert not PACKAGE.dangles("alpha_min")
    assert PACKAGE.dangles("FrictionLaws")
    assert PACKAGE.dangles("FrictionLaw.forces")


def test_no_docstring_names_what_is_not_public():
    found = []
    for path, text in PACKAGE.docstrings():
        words_of_it = re.findall(r"(?<!`)`([^`]+)`(?!`)", text)
        found += [f"{path}: {word}" for word in words_of_it if PACKAGE.dangles(word)]
    assert not found


@pytest.mark.parametrize(
    ("text", "numbers"),
    [
        ("Reference: [WL19] (34).", {34}),
        ("Reference: [WL19] §4.1, (77), (79)–(81).", {77, 79, 80, 81}),
        ("as in [WL19] Fig. 12, (9). Two (3) of them.", {9}),
        ("Reference: [WL19] Def. 2, 3.", set()),
        ("(12) without a source", set()),
    ],
)
def test_citations_are_read(text, numbers):
    assert words.cited(text) == numbers


def test_equations_lead_to_names_and_back():
    index = PACKAGE.equations
    assert len(index) > 50
    assert "asperity.StarSet.tangent_cone" in index[10]
    assert ":name:`Ellipse`" in build.equations()
    page = build.notation((ROOT / "NOTATION.md").read_text(encoding="utf-8"))
    assert "{name}`StarSet.gauge`" in page
    assert "[(88)](#eq-88)" in page
    assert page.count("{name}`") > 100


def test_links_to_scripts_lead_to_the_gallery():
    page = build._linked("see [it](../examples/charts/basins_of_attraction.py) and [x](y.md)")
    assert page == "see [it](/gallery/charts/basins_of_attraction.rst) and [x](y.md)"


def test_scripts_that_do_not_run_alone_are_no_downloads():
    """The figures of the paper import modules that lie beside them."""
    pytest.importorskip("sphinx")
    import extension
    from docutils import nodes
    from docutils.utils import new_document

    for name, offered in (("paper/laws/fig01", False), ("gallery/laws/spinning_disk", True)):
        page = new_document(name)
        page += nodes.note("", classes=["sphx-glr-download-link-note"])
        footer = nodes.container(classes=["sphx-glr-footer", "sphx-glr-footer-example"])
        footer += nodes.paragraph(text="Download Python source code")
        page += footer
        extension.no_part_alone(SimpleNamespace(env=SimpleNamespace(docname=name)), page)
        assert ("Download" in page.astext()) is offered
        assert bool([*page.findall(nodes.note)]) is offered
        assert ("python -m paper.laws.fig01" in page.astext()) is not offered


def test_the_front_page_leads_to_every_tutorial():
    front = (ROOT / "site" / "pages" / "index.md").read_text(encoding="utf-8")
    tutorials = sorted((ROOT / "docs" / "tutorials").glob("*.md"))
    assert len(tutorials) == 3
    assert all(f"[](docs/tutorials/{page.name})" in front for page in tutorials)


def test_bad_links_are_found(tmp_path):
    (tmp_path / "a.html").write_text(
        '<p id="here"><a href="b.html#there">good</a><a href="b.html#nowhere">bad</a>'
        '<a href="c.html">bad</a><a href="https://example.org">outside, followed by people</a>'
        '<a href="#here">good</a><img src="https://example.org/x.png"><img src="x.png">'
        '<link rel="canonical" href="https://example.org"><script src="//example.org/x.js">'
        "</script>",
        encoding="utf-8",
    )
    (tmp_path / "b.html").write_text('<p id="there">', encoding="utf-8")
    (tmp_path / "x.css").write_text("a { background: url('https://example.org/y.png') }")
    found = links.problems(tmp_path)
    assert len(found) == 6
    expected = [
        "b.html#nowhere has no such place",
        "c.html leads nowhere",
        "loads https://example.org/x.png",
        "x.png leads nowhere",
        "loads //example.org/x.js",
        "x.css: loads https",
    ]
    for problem in expected:
        assert any(problem in one for one in found), problem


@pytest.mark.parametrize(
    ("latex", "text"),
    [
        (r"R\dot\varphi", "Rφ̇"),
        (r"\sqrt{0.5/0.3}", "√(0.5/0.3)"),
        (r"\mathrm{diag}(0.5, 0.3)", "diag(0.5, 0.3)"),
        (r"R\omega_0^{2}", "Rω<sub>0</sub><sup>2</sup>"),
        (r"\frac{1}{2} \lambda_{N} \leq 3", "(1)/(2) λ<sub>N</sub> ≤3"),
    ],
)
def test_formulas_are_text(latex, text):
    assert formula(latex) == text
    with pytest.raises(ValueError, match="not known"):
        formula(r"\nothing")
