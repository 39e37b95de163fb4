"""What a scene returns."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array
from asperity._base.value import Record
from asperity.contact import StepSolution
from asperity.law import FrictionLaw
from asperity.status import Phase


class SceneStep(NamedTuple):
    """What happened in a step.

    Attributes:
        solution: of the rows of the step; ``None`` if there were none.
        projected: largest violation of a gap, limit or equality that was projected away at the end
            of the step, in m or rad.
        violation: largest that is left, in m or rad.
    """

    solution: StepSolution | None
    projected: float
    violation: float


class Projection(NamedTuple):
    """Where a state was inadmissible, before it was projected.

    Attributes:
        violations: by how much every pair of geoms, limit or equality was violated, in m or rad.
        moved: largest change of a coordinate, in m or rad.
    """

    violations: Mapping[str, float]
    moved: float


class SceneContact(NamedTuple):
    """A contact in the last step.

    Attributes:
        geoms: names of the two.
        position: of the contact at the midpoint of the step, in m in the world, shape ``(3,)``.
        normal: from the first to the second geom, in the world, shape ``(3,)``.
        gap: there in m, negative inside each other.
        force: mean over the step, on the second geom, in N in the world, shape ``(3,)``.
        torque: mean of the drilling, on the second geom about the normal, in N m.
        phase: open, stick or slip.
        ambiguous: whether it had several solutions, the others held.
    """

    geoms: tuple[str, str]
    position: Array
    normal: Array
    gap: float
    force: Array
    torque: float
    phase: Phase
    ambiguous: bool


class SceneProblem(Record):
    """The rows of a step, as `ContactStepper.solve` takes them.

    Attributes:
        delassus: G in 1/kg, shape ``(rows, rows)``.
        free_velocity: b in m/s, shape ``(rows,)``.
        items: what the rows are, shape ``(items,)``.
        bounds: of dry joints in N s or N m s, shape ``(items,)``.
        keys: of the items, shape ``(items,)``.
        laws: those that items name by number.
        names: of the items.
    """

    delassus: Array
    free_velocity: Array
    items: NDArray[np.int64]
    bounds: Array
    keys: NDArray[np.int64]
    laws: tuple[FrictionLaw, ...]
    names: tuple[str, ...]


class SceneRun(NamedTuple):
    """Samples of a simulation, the first before the first step.

    Attributes:
        t: times in s, shape ``(samples,)``.
        kept: samples of the fields of ``MjData`` by name, each with shape ``(samples, ...)``.
        worst_residual: largest of all steps.
        worst_violation: largest that was left after a step, in m or rad.
    """

    t: Array
    kept: Mapping[str, Array]
    worst_residual: float
    worst_violation: float

    def __getattr__(self, name: str) -> Array:
        try:
            return self.kept[name]
        except KeyError:
            raise AttributeError(name) from None
