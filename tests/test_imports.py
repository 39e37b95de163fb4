"""What imports what."""

import ast
import importlib
import inspect
import pkgutil
import subprocess
import sys
from pathlib import Path

import asperity as asp
import asperity.demo
import pytest
from samples import public_of

PACKAGE = Path(asp.__file__).parent
LAYERS = [
    {"errors"},
    {"_base", "_core", "status"},
    {"sets", "sweeps"},
    {"law", "solvers"},
    {"contact", "system"},
    {"runs"},
    {"steady_sliding"},
    {"cycles"},
    {"ensemble"},
    {"identify", "mechanisms", "mujoco", "plot", "problems", "track"},
    {"demo", "predict"},
    {"commands"},
]
# Imported at first use.
LAZY = {"identify", "mechanisms", "mujoco", "plot", "predict", "problems", "track"}
RANK = {name: rank for rank, names in enumerate(LAYERS) for name in names}
# Parts of a folder in their order; its other files may use them all.
PARTS = {
    "identify": ["records", "forces", "models", "estimator", "evidence"],
    "identify/records": ["tables", "calibration", "record", "magnitudes", "sliding"],
    "identify/evidence": ["coefficient", "forces", "wrenches", "paths"],
    "steady_sliding": ["critical", "linearised"],
    "track": ["film", "image", "following"],
}
MAY_CALL_THE_CORE = {"sets", "law", "solvers", "contact", "system", "runs"}
MAY_CALL_THE_CORE |= {"steady_sliding", "cycles", "ensemble", "mujoco", "commands"}
MODULES = [path for path in PACKAGE.rglob("*.py") if path.name not in ("__main__.py",)]


def imported(path):
    """Return the modules of the package that a module imports at run time, as tuples of names."""
    found = set()
    tree = ast.parse(path.read_text())
    for node in ast.walk(tree):
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test):
            node.body = []
    for node in ast.walk(tree):
        names = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            names = [f"{node.module}.{alias.name}" for alias in node.names]
        pieces = (tuple(name.split(".")) for name in names)
        found |= {one[1:] for one in pieces if one[0] == "asperity" and len(one) > 1}
    return found


def test_imports_go_one_way():
    for path in MODULES:
        own = path.relative_to(PACKAGE).with_suffix("").parts[0]
        others = {names[0] for names in imported(path) - {("_core", "__version__")}} - {own}
        if own == "__init__":
            assert not others & {"plot", "problems", "identify", "demo", "commands"}
            continue
        assert own in RANK, path
        # Other names are those of the package itself, such as its version.
        for other in others & set(RANK):
            assert RANK[other] <= RANK[own], f"{path} imports {other}"
        assert own in MAY_CALL_THE_CORE or "_core" not in others, path


@pytest.mark.parametrize("folder", PARTS)
def test_parts_of_a_folder_go_one_way(folder):
    order, above = PARTS[folder], tuple(folder.split("/"))
    for rank, part in enumerate(order):
        paths = [*(PACKAGE / folder).glob(f"{part}.py"), *(PACKAGE / folder / part).rglob("*.py")]
        assert paths, part
        for path in paths:
            inside = {n[len(above) :] for n in imported(path) if n[: len(above)] == above}
            assert {n[0] for n in inside} <= set(order[: rank + 1]), path


PUBLIC = {"asperity", "asperity.demo", *(f"asperity.{name}" for name in LAZY)}
PUBLIC |= {f"asperity.demo.{module.name}" for module in pkgutil.iter_modules(asp.demo.__path__)}
EXAMPLES = PACKAGE.parents[1] / "examples"
SCRIPTS = [*EXAMPLES.rglob("*.py"), *(PACKAGE / "demo").glob("*.py")]


@pytest.mark.parametrize("folder", sorted({path.parent for path in SCRIPTS}), ids=lambda f: f.name)
def test_examples_and_the_demo_use_the_public_interface_only(folder):
    nodes = [n for path in folder.glob("*.py") for n in ast.walk(ast.parse(path.read_text()))]
    for node in nodes:
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
            assert {name for name in names if name.startswith("asperity")} <= PUBLIC
        elif isinstance(node, ast.ImportFrom) and node.module.startswith("asperity"):
            assert node.module in PUBLIC
            module = importlib.import_module(node.module)
            public = public_of(module)
            names = {alias.name for alias in node.names} - (LAZY if module is asp else set())
            assert names <= set(public) | ({"demo"} if module is asp else set())
            assert not any(name.startswith("_") for name in names)
        elif isinstance(node, ast.Attribute) and ast.unparse(node.value) == "asp":
            # Results that nobody constructs are in their subpackages only.
            assert node.attr in {*asp.__all__, *LAZY, *RANK}


def test_no_function_hides_a_module():
    """A folder or file of a function's name would be hidden by it, or hide it."""
    for module in pkgutil.walk_packages(asp.__path__, "asperity."):
        if module.name != "asperity.__main__":
            importlib.import_module(module.name)
    names = {path.stem for path in MODULES} | {path.parent.name for path in MODULES}
    modules = [asp, *(getattr(asp, name) for name in LAZY)]
    functions = {n for m in modules for n in m.__all__ if inspect.isfunction(getattr(m, n))}
    assert sorted(functions & names) == []
    for name, module in list(sys.modules.items()):
        above, _, last = name.rpartition(".")
        if above.startswith("asperity"):
            assert getattr(sys.modules[above], last) is module, name


def test_importing_the_package_is_light():
    script = (
        "import sys, asperity; "
        "heavy = {'distributed', 'jinja2', 'matplotlib', 'scipy', 'tqdm', 'xarray', 'zarr'}; "
        "print(sorted({m.split('.')[0] for m in sys.modules} & heavy))"
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


def test_public_names_exist_and_are_of_one_subpackage():
    assert len(set(asp.__all__)) == len(asp.__all__)
    assert all(hasattr(asp, name) for name in asp.__all__)
