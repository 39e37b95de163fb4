"""Eigenvalues near a point by SLEPc, in processes of another Python."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import tempfile
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from asperity.errors import ConvergenceError, ParameterError
from asperity.steady_sliding.linearised.pencil import Complex
from asperity.steady_sliding.sparse import slepc_script
from asperity.steady_sliding.sparse.nearest import EXACT, Pairs, rayleigh, with_errors
from asperity.steady_sliding.sparse.pencil import SparsePencil

VARIABLE = "ASPERITY_SLEPC"
"""Holds the command that starts Python with slepc4py, under MPI."""
_COMMAND = "mpiexec -n 2 python3"


def nearest_by_slepc(pencil: SparsePencil, shift: complex, count: int) -> tuple[Pairs, float]:
    """Return what `nearest` does, found by SLEPc's TOAR; the left eigenvectors likewise.

    Raises:
        ParameterError: if SLEPc does not run.
        ConvergenceError: if pairs do not reach a backward error of 1e-12, or are too few.
    """
    count = min(count, pencil.most)
    values, modes = _found(pencil, shift, count)
    values = rayleigh(pencil, values, modes)
    errors = pencil.backward_errors(values, modes)
    if not (errors <= EXACT).all():
        raise ConvergenceError(
            f"SLEPc found eigenvalues near {shift:.6g} 1/s with a backward error of "
            f"{errors.max():.2g} only",
            residual=float(errors.max()),
        )
    pairs = Pairs(values, modes, errors, np.full(count, np.nan))
    pairs = with_errors(pencil, pairs, partial(_found, pencil.transposed, shift, count))
    return pairs, float(np.abs(values - shift).max(initial=0.0))


def _found(pencil: SparsePencil, shift: complex, count: int) -> tuple[Complex, Complex]:
    """Return the eigenvalues nearest to a shift, and modes, one column each."""
    command = shlex.split(os.environ.get(VARIABLE, _COMMAND))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        script = shutil.copy(slepc_script.__file__, folder)
        parts: dict[str, Any] = {"shift": shift, "count": count}
        for part in ("mass", "damping", "stiffness"):
            rows = getattr(pencil, part).tocsr()
            parts |= {f"{part}_{one}": getattr(rows, one) for one in ("indptr", "indices", "data")}
        np.savez(folder / "pencil.npz", **parts)
        try:
            done = subprocess.run([*command, script, name], capture_output=True, text=True)
        except OSError as error:
            raise _absent(str(error)) from None
        if done.returncode or not (folder / "found.npz").exists():
            lines = [one.strip() for one in done.stderr.splitlines() if any(map(str.isalpha, one))]
            said = [one for one in lines if "Error" in one or "slepc4py" in one]
            raise _absent((said[-1:] or lines[:1] or [f"exit code {done.returncode}"])[0])
        with np.load(folder / "found.npz") as found:
            values, modes = found["values"], found["modes"].T
    if len(values) < count:
        raise ConvergenceError(f"SLEPc found {len(values)} of {count} eigenvalues near {shift:.6g}")
    order = np.argsort(np.abs(values - shift))[:count]
    return values[order], modes[:, order] / np.linalg.norm(modes[:, order], axis=0)


def _absent(why: str) -> ParameterError:
    return ParameterError(
        "engine",
        f"slepc does not run: {why}; {VARIABLE} holds the command that starts a Python with "
        f"slepc4py, by default {_COMMAND}",
    )
