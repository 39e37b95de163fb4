"""docs/performance.md is what `make bench` writes, of all benches that there are."""

import importlib.util
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
SPEC = importlib.util.spec_from_file_location("performance", ROOT / "benches" / "performance.py")
performance = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(performance)

PAGE = (ROOT / "docs" / "performance.md").read_text(encoding="utf-8")
ROWS = [
    [cell.strip() for cell in line.strip("|").split("|")]
    for line in PAGE.splitlines()
    if line.startswith("|") and not line.startswith(("| what |", "|---"))
]
BENCHES = sorted(performance.commands())


@pytest.fixture
def kept(tmp_path, monkeypatch):
    """Outputs of all benches, as they would be in out/bench."""
    folder = tmp_path / "bench"
    folder.mkdir()
    for number, name in enumerate(BENCHES):
        line = f"ratio\tcase of {name}\t{number}.5\ta floor\twhat it costs"
        (folder / f"{name}.txt").write_text(
            f"measured\tMeasured here.\na table\n{line}\n", encoding="utf-8"
        )
    monkeypatch.setattr(performance, "KEPT", folder)
    monkeypatch.setattr(performance, "machine", lambda: "Measured here.\n")
    return folder


def test_every_bench_has_a_subject():
    named = [name for names in performance.SUBJECTS.values() for name in names]
    assert sorted(named) == BENCHES
    in_rust = {path.stem for path in (ROOT / "benches").glob("*.rs")} - {"report"}
    assert in_rust == {name for name in BENCHES if not name.startswith("python_")}


@pytest.mark.parametrize("name", BENCHES)
def test_every_bench_reports_ratios(name):
    text = (ROOT / performance.source(name)).read_text(encoding="utf-8")
    assert "report::ratio(" in text or re.search("^from report import ratio", text, re.M)


def test_the_page_names_the_benches_that_there_are():
    assert {row[-1] for row in ROWS} == {f"`{performance.source(name)}`" for name in BENCHES}
    for case, ratio, beside, meaning, _ in ROWS:
        assert all((case, beside, meaning))
        assert float(ratio) > 0.0
    # Nothing else is counted twice, or left from another form of the page.
    assert len({row[0] for row in ROWS}) == len(ROWS)
    found = {name: [] for name in BENCHES}
    for case, ratio, beside, meaning, file in ROWS:
        name = Path(file.strip("`")).stem
        found[name].append(performance.Ratio(case, float(ratio), beside, meaning))
    where = re.search(r"^Measured on .*\n", PAGE, re.M)[0]
    assert performance.page(found, where) == PAGE


def test_the_page_is_written_from_what_benches_print(kept, tmp_path):
    page = tmp_path / "page.md"
    assert performance.main(["--only", "--out", str(page)]) == 0
    text = page.read_text(encoding="utf-8")
    for number, name in enumerate(BENCHES):
        file = performance.source(name)
        assert f"| case of {name} | {number}.5 | a floor | what it costs | `{file}` |" in text
    assert "Measured here." in text


def test_a_bench_that_is_missing_leaves_the_page(kept, tmp_path, capsys):
    page = tmp_path / "page.md"
    page.write_text("before", encoding="utf-8")
    (kept / f"{BENCHES[0]}.txt").unlink()
    assert performance.main(["--only", "--out", str(page)]) == 1
    assert BENCHES[0] in capsys.readouterr().err
    assert page.read_text(encoding="utf-8") == "before"


def test_benches_of_another_day_are_not_said_to_be_of_today(kept, tmp_path, capsys):
    file = kept / f"{BENCHES[0]}.txt"
    file.write_text(file.read_text(encoding="utf-8").replace("here", "there"), encoding="utf-8")
    assert performance.main(["--only", "--out", str(tmp_path / "page.md")]) == 1
    assert BENCHES[0] in capsys.readouterr().err
    assert not (tmp_path / "page.md").exists()


def test_a_bench_that_fails_is_not_kept(kept, monkeypatch):
    command = [performance.sys.executable, "-c", "print('half a table'); raise SystemExit(3)"]
    with pytest.raises(performance.subprocess.CalledProcessError):
        performance.run(BENCHES[0], command)
    assert "half a table" not in (kept / f"{BENCHES[0]}.txt").read_text(encoding="utf-8")


def test_every_page_is_in_a_list_of_the_site():
    lists = "\n".join(
        path.read_text(encoding="utf-8") for path in (ROOT / "site" / "pages").glob("*.md")
    )
    pages = [path.relative_to(ROOT).with_suffix("") for path in (ROOT / "docs").rglob("*.md")]
    assert [page.as_posix() for page in pages if f"{page.as_posix()}\n" not in lists] == []
