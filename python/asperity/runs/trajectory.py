"""The outcome of a simulation."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import KW_ONLY
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity._base.arrays import Array
from asperity._base.result import counted
from asperity._base.value import AnyArray, Given, Positive, field, unchecked
from asperity.runs.model import Model
from asperity.runs.origin import Origin
from asperity.runs.run import AnyLabels, AnyPhases, Run
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
            if it is not known: after a cut or a divergence.
        labels: `Labels`, the names and units of coordinates, velocities and contacts.
        origin: `Origin`, the system and the options of the run; ``None`` if they are not known.

    >>> from asperity import FrictionLaw, SlidingPoint, simulate
    >>> block = SlidingPoint(1.0, law=FrictionLaw.isotropic(0.5), gravity=10.0)
    >>> run = simulate(block, dt=0.01, t_end=1.0, u0=[2.0, 0.0])
    >>> print(run.summary())
    The run went on to its end. It has 101 samples of 100 steps, up to t = 1 s.
    contact 0 stuck 61.0% and slipped 39.0% of the time.
    Contact problems took at most 1 iteration, with residuals up to 3.7e-17.
    >>> run.repeat() == run
    True
    """

    t: AnyArray
    q: AnyArray
    u: AnyArray
    slip: AnyArray
    force: AnyArray
    normal_force: AnyArray
    phase: AnyPhases
    iterations: Annotated[Given[ArrayLike, NDArray[np.int64]], unchecked]
    residual: AnyArray
    _: KW_ONLY
    status: Outcome
    dt: Positive
    steps: int
    ambiguous_steps: int
    failed_steps: int
    phase_counts: Annotated[Given[ArrayLike, NDArray[np.int64]], unchecked]
    end: Annotated[State | None, unchecked] = None
    labels: AnyLabels = field(default=None)
    origin: Annotated[Origin | None, unchecked] = None

    _series: ClassVar = {**Run._series, "iterations": np.int64, "residual": np.float64}

    def _complete(self, given: dict[str, Any]) -> None:
        super()._complete(given)
        given["phase_counts"] = np.asarray(given["phase_counts"], dtype=np.int64)

    def _extent(self) -> str:
        return f"{super()._extent()} of {counted(self.steps, 'step')}"

    @property
    def stick_fraction(self) -> Array:
        """Share of all steps, saved or not, in which each contact stuck; shape ``(n_contact,)``."""
        counted = np.maximum(self.phase_counts.sum(axis=1), 1)
        return self.phase_counts[:, Phase.STICK] / counted

    def _shares(self) -> Array:
        return self.phase_counts / max(self.steps, 1)

    def _sentences(self) -> Iterator[str]:
        yield from super()._sentences()
        if self.phase.shape[1] and len(self) > 1:
            most = counted(int(self.iterations[1:].max()), "iteration")
            yield (
                f"Contact problems took at most {most}, with residuals up to "
                f"{np.nanmax(self.residual[1:]):.2g}."
            )
        if self.failed_steps:
            steps = counted(self.failed_steps, "step")
            yield f"In {steps} the contact problem was not solved to the tolerance."
        if self.ambiguous_steps:
            yield (
                f"In {counted(self.ambiguous_steps, 'step')} a contact had several solutions; the "
                "one was taken that continues its state."
            )

    def _facts(self) -> dict[str, str | int | float]:
        return {
            **super()._facts(),
            "dt": self.dt,
            "ambiguous_steps": self.ambiguous_steps,
            "failed_steps": self.failed_steps,
        }

    def repeat(self, *, system: Model | None = None) -> Trajectory:
        """Make the run again, the whole of it if this is a slice.

        The same version of asperity gives the same bits.

        Args:
            system: what to simulate with the same options, as with another law; default the
                run's own. It has to be given for a run from a file that could not hold it.

        Raises:
            ParameterError: if the run has no options or no system.
        """
        from asperity.runs.time_stepping import simulate

        own, options = self._again(system)
        return simulate(own, **options)

    def slice(self, t0: float, t1: float) -> Trajectory:
        """Return the samples with t0 ≤ t ≤ t1; counts and status remain those of the whole run."""
        series = self._between(t0, t1)
        return self.replace(**series, end=self.end if series["t"][-1] == self.t[-1] else None)
