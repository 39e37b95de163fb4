"""Models of gymnasium and dm_control, where they are installed, step by step."""

import importlib.util
from pathlib import Path

import pytest

_BENCH = Path(__file__).parents[1] / "benches" / "mujoco_models.py"
_SPEC = importlib.util.spec_from_file_location("mujoco_models", _BENCH)
bench = importlib.util.module_from_spec(_SPEC)
_SPEC.loader.exec_module(bench)
FILES = [path for files in bench.paths().values() for path in files]
LARGEST = {"inverted_double_pendulum": 0.5, "finger": 2e-3}
"""Energy in J that steps of 10 ms gain: of swings that are fast for them, and of stiff dampers."""


@pytest.mark.long
@pytest.mark.skipif(not FILES, reason="needs gymnasium or dm_control")
@pytest.mark.parametrize("path", FILES, ids=lambda path: f"{path.parents[1].name} {path.stem}")
def test_models_run_with_rigid_contacts_and_without_energy_from_nowhere(path):
    found = bench.run(path, seconds=2.0, seed=0)
    assert found.residual < 1e-10
    assert found.depth < 0.1
    assert found.violation < 0.1
    assert found.largest <= LARGEST.get(path.stem, 0.0)
