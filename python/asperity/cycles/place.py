"""The states on a section that keep doing what a motion does there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import asperity._core as _core
from asperity._base.arrays import Array
from asperity.runs.model import Model
from asperity.runs.motion import Motion
from asperity.runs.section import Section
from asperity.status import Phase

_CORRECTIONS = 3


@dataclass(frozen=True)
class Place:
    """A section, within the contacts that are closed or stick where a motion passes it.

    Differences of the return map have to stay within: states next to it would penetrate, fall onto
    the contact or begin to slip.
    """

    system: Model
    section: Section
    scale: Array
    """Size of each state component on the orbit."""
    phases: tuple[Phase, ...]

    @classmethod
    def of(cls, system: Model, section: Section, scale: Array, motion: Motion) -> Place:
        """Return the place where `motion` begins."""
        return cls(system, section, scale, tuple(Phase(int(p)) for p in motion.phase[0]))

    def tangents(self, state: Array) -> Array:
        """Return directions within the place, scaled: shape ``(2n, k)`` with k < 2n."""
        rows = self._constraints(state)[0] * self.scale
        _, values, right = np.linalg.svd(rows / np.linalg.norm(rows, axis=1)[:, None])
        rank = int((values > 1e-9 * values[0]).sum())
        return self.scale[:, None] * right[rank:].T

    def onto(self, state: Array) -> Array:
        """Return the nearest state of the place."""
        for _ in range(_CORRECTIONS):
            rows, defects = self._constraints(state)
            change = np.linalg.lstsq(rows * self.scale, -defects, rcond=None)[0]
            state = state + self.scale * change
        return state

    def _constraints(self, state: Array) -> tuple[Array, Array]:
        """Return the gradients of what has to vanish, and its values."""
        n = len(state) // 2
        q, u = state[:n].copy(), state[n:].copy()
        none = np.zeros(n)
        rows = [self.section.normal]
        defects = [float(self.section.normal @ state) - self.section.level]
        contacts = _core.evaluate(self.system._core, 0.0, q, u)["contacts"]
        for contact, phase in zip(contacts, self.phases, strict=True):
            if "normal" in contact and phase is not Phase.OPEN:
                normal = contact["normal"]
                rows += [np.concatenate([normal, none]), np.concatenate([none, normal])]
                defects += [float(contact["gap"]), float(normal @ u)]
            if phase is Phase.STICK:
                slip = contact["tangent"] @ u + contact["velocity"]
                rows += [np.concatenate([none, row]) for row in contact["tangent"]]
                defects += slip.tolist()
        return np.array(rows), np.array(defects)
