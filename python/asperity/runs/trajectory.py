"""The outcome of a simulation."""

from __future__ import annotations

import os
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.tables import aligned
from asperity.runs import trajectory_file
from asperity.runs.run import Run
from asperity.runs.state import State
from asperity.status import Outcome, Phase


class Trajectory(Run):
    """States, forces and phases over time; all arrays are read-only.

    Sample 0 is the initial state: its forces and residual are NaN, its phases `Phase.NONE`. Slip,
    force and phase of a later sample are those of the step that ends there; forces are percussions
    divided by Δt. Where contacts differ in dimension, missing components are NaN.

    Attributes:
        t: time in s, shape ``(n_t,)``.
        q: coordinates, shape ``(n_t, n)``; of rigid bodies in space 7 per body.
        u: velocities, shape ``(n_t, n)``; of rigid bodies in space 6 per body.
        slip: relative velocities γ in m/s, shape ``(n_t, n_contact, p)``.
        force: friction forces λ on the body in N, shape ``(n_t, n_contact, p)``.
        normal_force: λ_N in N, shape ``(n_t, n_contact)``.
        phase: `Phase` as integers, shape ``(n_t, n_contact)``.
        iterations: of the contact solver, shape ``(n_t,)``.
        residual: natural-map residual of each step's contact problem, shape ``(n_t,)``.
        status: how the run ended; steps that were recorded as failed do not end it.
        dt: step Δt in s.
        steps: number of steps done.
        ambiguous_steps: number of steps in which a contact had several solutions.
        failed_steps: number of steps that did not converge.
        phase_counts: number of steps open, sticking, slipping, shape ``(n_contact, 3)``.
        end: the `State` at the last sample, from which `simulate` goes on with ``start=``; ``None``
            if it is not known: after a cut, a divergence, or in a file of an earlier version.
    """

    iterations: NDArray[np.int64]
    residual: Array
    dt: float
    ambiguous_steps: int
    failed_steps: int
    phase_counts: NDArray[np.int64]
    end: State | None

    _series: ClassVar = {**Run._series, "iterations": np.int64, "residual": np.float64}

    def __init__(
        self,
        t: ArrayLike,
        q: ArrayLike,
        u: ArrayLike,
        slip: ArrayLike,
        force: ArrayLike,
        normal_force: ArrayLike,
        phase: ArrayLike,
        iterations: ArrayLike,
        residual: ArrayLike,
        *,
        status: Outcome,
        dt: float,
        steps: int,
        ambiguous_steps: int,
        failed_steps: int,
        phase_counts: ArrayLike,
        end: State | None = None,
    ) -> None:
        self._set(
            **self._frozen(t, q, u, slip, force, normal_force, phase, iterations, residual),
            status=Outcome(status),
            dt=float(dt),
            steps=int(steps),
            ambiguous_steps=int(ambiguous_steps),
            failed_steps=int(failed_steps),
            phase_counts=arrays.read_only(np.asarray(phase_counts, dtype=np.int64)),
            end=end,
        )

    def _extent(self) -> str:
        return f"{len(self)} samples of {self.steps} steps"

    @property
    def stick_fraction(self) -> Array:
        """Share of all steps, saved or not, in which each contact stuck; shape ``(n_contact,)``."""
        counted = np.maximum(self.phase_counts.sum(axis=1), 1)
        fraction: Array = self.phase_counts[:, Phase.STICK] / counted
        return fraction

    def summary(self) -> str:
        """Return a few lines of text on the run."""
        lines = [
            ("status", str(self.status)),
            ("time", f"{self.t[0]:.9g} to {self.t[-1]:.9g} s"),
            ("steps", f"{self.steps} of {self.dt:.9g} s, {len(self)} samples kept"),
            ("coordinates", str(self.q.shape[1])),
            ("ambiguous steps", str(self.ambiguous_steps)),
            ("failed steps", str(self.failed_steps)),
        ]
        if len(self) > 1:
            lines.append(("iterations", f"at most {self.iterations[1:].max()}"))
            lines.append(("residual", f"at most {np.nanmax(self.residual[1:]):.3g}"))
        for contact, counts in enumerate(self.phase_counts / max(self.steps, 1)):
            shares = (f"{Phase(i).name.lower()} {share:.1%}" for i, share in enumerate(counts))
            lines.append((f"contact {contact}", ", ".join(shares)))
        return aligned(lines)

    def slice(self, t0: float, t1: float) -> Trajectory:
        """Return the samples with t0 ≤ t ≤ t1; counts and status remain those of the whole run."""
        series = self._between(t0, t1)
        return self.replace(**series, end=self.end if series["t"][-1] == self.t[-1] else None)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write a NumPy ``.npz`` file without pickled objects, under exactly this name.

        The file replaces an older one only when it is complete.
        """
        contents = {name: value for name, value in self._parameters.items() if name != "end"}
        if self.end is not None:
            contents |= self.end._arrays()
        trajectory_file.save(contents, path)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Trajectory:
        """Read a file written by `save`.

        Raises:
            ParameterError: naming the field that is missing, damaged or does not fit the others;
                or ``path``, if the file is something else.
            FileNotFoundError: if there is none.
        """
        contents = trajectory_file.load(path)
        return cls(end=State._from_arrays(contents), **contents)
