"""What imports what."""

import ast
import subprocess
import sys
from pathlib import Path

import asperity as asp
import pytest

PACKAGE = Path(asp.__file__).parent
LAYERS = [
    {"errors", "_files", "_archive"},
    {"_arrays", "_value", "_progress", "status", "_core"},
    {"verdict", "rate"},
    {"sets"},
    {"law", "solvers"},
    {"contact", "system", "state"},
    {"trajectory", "_trajectory_file", "grading"},
    {"solve_files"},
    {"simulate", "integrate", "motion"},
    {"stability"},
    {"cycle", "track"},
    {"comparison"},
    {"identify", "mechanisms", "plot", "problems"},
    {"paper", "track_video", "identify_files"},
    {"cli"},
]
RANK = {name: rank for rank, names in enumerate(LAYERS) for name in names}
MAY_CALL_THE_CORE = {"sets", "law", "solvers", "contact", "system", "trajectory", "simulate"}
MAY_CALL_THE_CORE |= {"_trajectory_file", "integrate", "stability", "cycle", "cli"}
MODULES = [path for path in PACKAGE.rglob("*.py") if path.name not in ("__main__.py",)]


def part(dotted):
    """Return the part of the package a dotted name belongs to."""
    pieces = dotted.split(".")
    return pieces[1] if len(pieces) > 1 else None


def imported(path):
    """Return the parts a module imports at run time."""
    found = set()
    tree = ast.parse(path.read_text())
    for node in ast.walk(tree):
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test):
            node.body = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found |= {
                part(alias.name) for alias in node.names if alias.name.startswith("asperity.")
            }
        elif isinstance(node, ast.ImportFrom) and node.module == "asperity":
            found |= {alias.name for alias in node.names if alias.name in RANK}
        elif isinstance(node, ast.ImportFrom) and (node.module or "").startswith("asperity."):
            found.add(part(node.module))
    return found


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_imports_go_one_way(path):
    own = path.relative_to(PACKAGE).with_suffix("").parts[0]
    if own == "__init__":
        assert not imported(path) & {"plot", "problems", "paper", "cli"}
        return
    assert own in RANK
    for other in imported(path) - {own}:
        assert RANK[other] <= RANK[own], f"{own} imports {other}"
    if own not in MAY_CALL_THE_CORE:
        assert "_core" not in imported(path)


def test_importing_the_package_is_light():
    script = (
        "import sys, asperity; "
        "print(sorted({m.split('.')[0] for m in sys.modules} & {'matplotlib', 'scipy', 'tqdm'}))"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True, timeout=120
    )
    assert done.stdout.strip() == "[]"


def test_plot_is_imported_by_its_first_use():
    script = (
        "import asperity; asperity.plot.plot_set; import sys; assert 'matplotlib' in sys.modules"
    )
    subprocess.run([sys.executable, "-c", script], check=True, timeout=120)
    with pytest.raises(AttributeError, match="nothing"):
        _ = asp.nothing


def test_public_names_exist_and_are_sorted():
    assert asp.__all__ == sorted(asp.__all__)
    assert all(hasattr(asp, name) for name in asp.__all__)
