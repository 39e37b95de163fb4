"""What a release stands on: versions and addresses that agree, extras, complete archives."""

import ast
import importlib.util
import re
import shlex
import shutil
import subprocess
import sys
import tarfile
import tomllib
from pathlib import Path

import asperity as asp
import pytest
from asperity.commands.main import main

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
CARGO = tomllib.loads((ROOT / "Cargo.toml").read_text(encoding="utf-8"))["workspace"]
WORKFLOWS = [ROOT / ".github" / "workflows" / name for name in ("ci.yml", "release.yml")]


def _load(name):
    spec = importlib.util.spec_from_file_location(name, ROOT / "packaging" / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


release = _load("release")
check_install = _load("check_install")


@pytest.fixture
def copy(tmp_path):
    """The files of the repository that a release changes."""
    for name in {*release.ADDRESSED, "CHANGELOG.md", "Cargo.lock"}:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    return tmp_path


def contents(folder):
    files = (path for path in folder.rglob("*") if path.is_file())
    return {path.relative_to(folder): path.read_bytes() for path in files}


def test_all_places_state_one_version():
    assert release.current(ROOT) == asp.__version__
    assert len(release.versions(ROOT)) == 7


def test_a_new_version_is_written_to_all_places(copy, capsys):
    before = release.notes(copy, "Unreleased")
    assert release.main(["--root", str(copy), "bump", "9.8.7", "--date", "2027-01-02"]) == 0
    assert set(release.versions(copy).values()) == {"9.8.7"}
    assert "date-released: 2027-01-02\n" in (copy / "CITATION.cff").read_text(encoding="utf-8")
    assert release.notes(copy, "9.8.7") == before
    assert not release.notes(copy, "Unreleased").strip()
    release.check(copy, "v9.8.7")
    assert "git tag v9.8.7" in capsys.readouterr().out
    # There is one date, that of the last version.
    with (copy / "CHANGELOG.md").open("r+", encoding="utf-8") as file:
        text = file.read().replace("## [Unreleased]\n", "## [Unreleased]\n\n- A change.\n")
        file.seek(0)
        file.write(text)
    assert release.main(["--root", str(copy), "bump", "9.9.0"]) == 0
    assert (copy / "CITATION.cff").read_text(encoding="utf-8").count("date-released") == 1


@pytest.mark.parametrize(
    ("version", "message"),
    [
        ("0.0.9", "must be later than"),
        (asp.__version__, "must be later than"),
        ("1.0", "1.2.3"),
        ("v1.0.0", "1.2.3"),
    ],
)
def test_versions_that_are_none_are_refused(copy, version, message, capsys):
    before = contents(copy)
    assert release.main(["--root", str(copy), "bump", version]) == 1
    assert message in capsys.readouterr().err
    assert contents(copy) == before


def test_a_release_without_changes_is_refused(copy, capsys):
    assert release.main(["--root", str(copy), "bump", "9.8.7"]) == 0
    assert release.main(["--root", str(copy), "bump", "9.8.8"]) == 1
    assert "[Unreleased] of CHANGELOG.md is empty" in capsys.readouterr().err


def test_a_release_takes_over_what_its_candidates_brought(copy):
    log = copy / "CHANGELOG.md"
    head, tail = log.read_text(encoding="utf-8").split("## [Unreleased]\n")
    older = tail[tail.index("\n## [") :]
    older_than = [older]
    texts = [
        "\nOf all.\n\n### Added\n\n- One.\n\n### Fixed\n\n- Two.\n",
        "\n### Fixed\n\n- Three.\n",
        "",
    ]
    for version, text in zip(("9.8.0-rc.1", "9.8.0-rc.2", "9.8.0"), texts, strict=True):
        log.write_text(f"{head}## [Unreleased]\n{text}{older_than[-1]}", encoding="utf-8")
        bump = ["--root", str(copy), "bump", version, "--date", "2027-01-02"]
        assert release.main(bump) == 0
        older_than.append(log.read_text(encoding="utf-8").split("## [Unreleased]\n")[1])
    assert release.notes(copy, "9.8.0") == (
        "Of all.\n\n### Fixed\n\n- Three.\n\n- Two.\n\n### Added\n\n- One.\n"
    )
    assert "-rc." not in log.read_text(encoding="utf-8")
    assert log.read_text(encoding="utf-8").endswith(older)
    # The next one needs a change again.
    assert release.main(["--root", str(copy), "bump", "9.8.1"]) == 1


@pytest.mark.parametrize("name", ["Cargo.toml", "Cargo.lock", "CITATION.cff"])
def test_places_that_disagree_are_named(copy, name, capsys):
    text = (copy / name).read_text(encoding="utf-8")
    place = re.search(rf'version(: | = "){re.escape(asp.__version__)}', text)
    changed = text[: place.start()] + place[0].replace(asp.__version__, "9.0.0")
    (copy / name).write_text(changed + text[place.end() :], encoding="utf-8")
    for verb in (["bump", "9.8.7"], ["check", f"v{asp.__version__}"]):
        assert release.main(["--root", str(copy), *verb]) == 1
        assert f"  {name}" in capsys.readouterr().err


def test_addresses_of_the_project_agree():
    """Every address of the project begins with one of those in pyproject.toml."""
    urls = PROJECT["urls"]
    repository, site = urls["Repository"], urls["Homepage"]
    raw = repository.replace("github.com", "raw.githubusercontent.com")
    owner, name = repository.split("/")[-2:]
    assert CARGO["package"]["repository"] == repository
    assert CARGO["package"]["homepage"] == site
    for file in release.ADDRESSED:
        text = (ROOT / file).read_text(encoding="utf-8")
        for address in re.findall(r"https://[^\s\"')\]>,`]+", text):
            if owner in address or address.endswith(f"/{name}"):
                assert address.startswith((repository, site, raw)), (file, address)


def test_addresses_are_changed_together(copy, capsys):
    new = ("https://friction.example/asperity", "https://github.com/somebody/friction")
    before = contents(copy)
    assert release.main(["--root", str(copy), "address", *new, "--dry-run"]) == 0
    assert contents(copy) == before
    assert (
        "https://raw.githubusercontent.com/somebody/friction/main/docs" in capsys.readouterr().out
    )
    assert release.main(["--root", str(copy), "address", *new]) == 0
    old = PROJECT["urls"]["Repository"].split("/")[-2]
    for name in release.ADDRESSED:
        assert old not in (copy / name).read_text(encoding="utf-8"), name
    host = "https://friction.example"
    assert release.main(["--root", str(copy), "address", host, new[1]]) == 0
    assert f'Homepage = "{host}"' in (copy / "pyproject.toml").read_text(encoding="utf-8")


def test_pictures_and_links_of_the_readme_are_found_from_everywhere():
    """Registries show the page, too: they do not have the repository beside it."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    urls = PROJECT["urls"]["Repository"]
    raw = urls.replace("github.com", "raw.githubusercontent.com") + "/main/"
    pictures = re.findall(r"!\[[^\]]*\]\(([^)]*)\)", text)
    assert pictures
    for address in pictures:
        assert address.startswith(raw)
        assert (ROOT / address.removeprefix(raw)).is_file()
    pages = dict(re.findall(r"^\[(.+?)\]: (\S+)$", text, re.M))
    assert len(pages) > 20
    for label, address in pages.items():
        assert f"[{label}]" in text.replace(f"[{label}]: ", "")
        assert (ROOT / address.removeprefix(f"{urls}/blob/main/")).exists()
    for label, address in re.findall(r"(?<!!)\[([^\]]+)\]\(([^)]*)\)", text):
        assert address.startswith(("https://", "#")), label
    plain = re.sub("```.*?```", "", text, flags=re.DOTALL)
    named = re.findall(r"(?<![\w!])\[([^\]]+)\](?![:(])", plain)
    assert set(named) - {"WL19", *PROJECT["optional-dependencies"]} <= set(pages)


def test_extras_are_there_and_hold_each_other():
    extras = PROJECT["optional-dependencies"]
    assert {"all", "data", "docs", "plot", "report", "sweep", "tables", "test", "video"} <= set(
        extras
    )
    # Whoever takes all of them can do all that the package can.
    parts = re.search(r"asperity\[(.*)\]", extras["all"][-1])[1].split(",")
    assert {"all", "docs", "test", "dev"}.isdisjoint(parts)
    assert set(parts) | {"all", "docs", "test", "dev"} == set(extras)
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert {f"`asperity[{one}]`" for one in {"all", *parts}} <= set(
        re.findall(r"`asperity\[\w+\]`", readme)
    )


def test_extras_that_messages_name_are_there():
    """What the package says is missing, an extra of that name installs."""
    named = set()
    for path in (ROOT / "python" / "asperity").rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        named |= set(re.findall(r"asperity\[([a-z]+)\]", text))
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "library":
                given = [k.value for k in node.keywords if k.arg == "extra"] or node.args[:1]
                named |= {one.value for one in given if isinstance(one, ast.Constant)}
    assert {"plot", "sweep"} <= named
    assert named <= set(PROJECT["optional-dependencies"])


def test_versions_of_python_and_rust_agree():
    python = re.findall(r":: Python :: (3\.\d+)", "\n".join(PROJECT["classifiers"]))
    assert PROJECT["requires-python"] == f">={python[0]}"
    ci = WORKFLOWS[0].read_text(encoding="utf-8")
    assert f"python: {python}".replace("'", '"') in ci
    assert f'rust: "{CARGO["package"]["rust-version"]}"' in ci
    binding = CARGO["dependencies"]["pyo3"]["features"]
    assert f"abi3-py{python[0].replace('.', '')}" in binding
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert f"Rust ≥ {CARGO['package']['rust-version']}" in readme
    assert f"Python ≥ {python[0]}" in readme
    recipe = (ROOT / "packaging" / "conda" / "recipe.yaml").read_text(encoding="utf-8")
    for requirement in [*PROJECT["dependencies"], f"python>={python[0]}"]:
        assert f"- {requirement.replace('>=', ' >=')}\n" in recipe


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.name)
def test_workflows_run_what_is_there(path):
    yaml = pytest.importorskip("yaml")
    jobs = yaml.safe_load(path.read_text(encoding="utf-8"))["jobs"]
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    lines = [step["run"] for job in jobs.values() for step in job["steps"] if "run" in step]
    assert len(lines) > 5
    for line in lines:
        for script in re.findall(r"packaging/\w+\.py", line):
            assert (ROOT / script).is_file()
        for target in re.findall(r"\bmake (\w+)", line):
            assert re.search(rf"^{target}:", makefile, re.M), target
        # What comes from outside is given as a variable: it cannot become a command.
        assert "${{" not in line
    for job in jobs.values():
        assert "timeout-minutes" in job
        needed = job.get("needs", [])
        assert set([needed] if isinstance(needed, str) else needed) <= set(jobs)


def test_crates_that_the_registry_has_are_left_out(capsys):
    crates = _load("publish_crates")
    version = CARGO["package"]["version"]
    lines = {
        "https://index.crates.io/as/pe/asperity-set": ["0.0.1", version],
        "https://index.crates.io/as/pe/asperity": ["0.0.1"],
    }

    def read(address):
        return "".join(f'{{"name": "x", "vers": "{one}"}}\n' for one in lines[address])

    assert crates.missing(version, read) == ["asperity"]
    assert crates.missing("9.8.7", read) == list(crates.CRATES)
    assert crates.missing("9.8.7", lambda _: "") == list(crates.CRATES)
    assert crates.main(["--dry-run"], read) == 0
    assert "--no-verify --package asperity\n" in capsys.readouterr().out
    assert crates.main([], lambda address: read(next(iter(lines)))) == 0
    assert "has all crates" in capsys.readouterr().out


def test_the_sdist_holds_all_that_the_repository_holds(tmp_path):
    """Its tests, documents and examples can be run from it."""
    maturin = shutil.which("maturin", path=str(Path(sys.executable).parent)) or shutil.which(
        "maturin"
    )
    if not ((ROOT / ".git").exists() and maturin and shutil.which("cargo")):
        pytest.skip("needs the repository, maturin and cargo")
    command = [maturin, "sdist", "--out", str(tmp_path)]
    subprocess.run(command, cwd=ROOT, check=True, capture_output=True, timeout=300)
    with tarfile.open(next(tmp_path.iterdir())) as archive:
        held = {name.split("/", 1)[1] for name in archive.getnames() if "/" in name}
    listed = subprocess.run(
        ["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True, text=True
    )
    kept = {name for name in listed.stdout.split("\0") if name and (ROOT / name).exists()}
    assert kept <= held
    assert held - kept == {"PKG-INFO"}


def test_the_first_commands_of_the_readme_lead_to_figures(tmp_path, monkeypatch, capsys):
    """Three lead to a figure, five from a CSV to the path under its law: one of them installs."""
    figure, own_file = check_install.first_commands((ROOT / "README.md").read_text("utf-8"))
    assert figure[0] == 'pip install "asperity[all]"'
    assert (len(figure), len(own_file)) == (3, 3)
    monkeypatch.chdir(tmp_path)
    assert main(shlex.split(figure[1])[1:]) == 0
    assert main(shlex.split(figure[2])[1:]) == 0
    assert (tmp_path / "slide" / "path" / "path.png").exists()
    exec(check_install.RECORD, {"__name__": "__main__"})
    codes = [main(shlex.split(command)[1:]) for command in own_file]
    # Guesses are to be looked over, and a law without a calibration is to be read with warnings.
    assert codes == [1, 1, 0], capsys.readouterr().err
    assert (tmp_path / "law" / "sets.png").exists()
    assert (tmp_path / "slide" / "measured" / "path.png").exists()
