"""Gaps, limits and equalities at given coordinates, and the nearest coordinates where they hold."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from asperity._base.arrays import Array
from asperity.mujoco.guided import Guidance
from asperity.mujoco.model import RowsModel
from asperity.mujoco.rows import Reader
from asperity.solvers import Solver

if TYPE_CHECKING:
    import mujoco

_TOLERANCE = 1e-10
# Parts of a change, tried where the whole leads nowhere: the least makes 6 mrad of half a turn.
_WHOLE, _PARTS = (1.0,), tuple(0.5**k for k in range(10))
_NONE = np.zeros(0)


class Projector:
    """Coordinates ahead of a step, on data of its own.

    A projection is min ‖δ‖_M with g + J δ ≥ 0 for gaps and limits, = 0 for equalities, repeated, of
    rows that something can move.
    """

    def __init__(self, model: RowsModel, *, exact: float, solver: Solver | None) -> None:
        self._model, self._mj, self._exact = model, model.mj, exact
        self.data = model.mj.MjData(model.model)
        self.reader = Reader(model, None, solver)
        self.depth = self._worst = 0.0
        self._has_rows = False
        self._errors: Array
        m, types = model.model, model.mj.mjtJoint
        limited = np.flatnonzero(m.jnt_limited)
        turns = np.isin(m.jnt_type[limited], [types.mjJNT_HINGE, types.mjJNT_SLIDE])
        self._limited = m.jnt_qposadr[limited]
        margin = model.user.jnt_margin[limited] - exact
        self._least, self._most = (m.jnt_range[limited] + np.outer(margin, (1.0, -1.0))).T
        # Whether limits and gaps are known without rows.
        self._is_plain = bool(turns.all()) and not (m.neq or m.tendon_limited.any())

    def place(self, data: mujoco.MjData) -> None:
        """Find the rows at the coordinates of `data`, of mocap bodies that rest."""
        self.reader.guidance = None
        self._copy(data)
        self._find()

    def advance(self, data: mujoco.MjData, velocity: Array, time: float) -> None:
        """Find the rows where `data` is after a time with a velocity."""
        self._copy(data)
        self._mj.mj_integratePos(self._model.model, self.data.qpos, velocity, time)
        self._look()

    def violations(self, least: float) -> dict[str, float]:
        """Return by how much rows are violated, if by more than `least`."""
        if not self._has_rows:
            self._read()
        ahead, layout = self.data, self.reader.layout
        found: dict[str, float] = {}
        numbers = [*range(ahead.ne), *layout.unilateral.tolist()]
        sizes = [*self._errors.tolist(), *(-self.reader.stepper.gaps()).tolist()]
        for k, (row, size) in enumerate(zip(numbers, sizes, strict=True)):
            if size > least:
                contact = k - ahead.ne - layout.limits
                pair = layout.pairs[contact] if contact >= 0 else None
                name = self._model.item_name(ahead, row, pair)
                found[name] = max(size, found.get(name, 0.0))
        return found

    def settle(self, count: int) -> tuple[float, float]:
        """Project up to `count` times; return the largest violation before and after."""
        first, start = self._worst, self.data.qpos.copy()
        for parts in (_WHOLE, _PARTS):
            if parts is _PARTS and count:
                self.data.qpos[:] = start
                self._look()
            for _ in range(count):
                if self._worst <= self._exact or not self._move(parts):
                    break
            if self._worst <= self._exact:
                break
        return first, self._worst

    def level(self, velocity: Array) -> Array:
        """Return a velocity with that of equalities, which is zero unless mocap bodies move."""
        rows = np.arange(self.data.ne)
        before = self.reader.stepper.row_velocities(rows, velocity)
        self._factor()
        return velocity + self.reader.stepper.least_change(rows, before, _TOLERANCE)

    def rates(self, time: float) -> Array:
        """Return velocities in m/s or rad/s with which equalities came to where they are."""
        errors = self.data.efc_pos[: self.data.ne]
        return np.asarray(errors * self.reader.stepper.moves() / time)

    def guide(self, guidance: Guidance) -> None:
        """Have mocap bodies move where the rows are."""
        self.reader.guidance = guidance
        self.reader.drive(self.data)

    def energy(self, velocity: Array) -> Array:
        """Return potential and kinetic energy in J."""
        m, ahead = self._model.model, self.data
        ahead.qvel[:] = velocity
        self._mj.mj_makeM(m, ahead)
        self._mj.mj_energyPos(m, ahead)
        self._mj.mj_energyVel(m, ahead)
        return ahead.energy

    def _copy(self, data: mujoco.MjData) -> None:
        m, ahead = self._model.model, self.data
        ahead.qpos[:] = data.qpos
        if m.nmocap:
            ahead.mocap_pos[:], ahead.mocap_quat[:] = data.mocap_pos, data.mocap_quat
        if m.neq:
            ahead.eq_active[:] = data.eq_active

    def _find(self) -> None:
        m, ahead = self._model.model, self.data
        self._mj.mj_fwdKinematics(m, ahead)
        self._mj.mj_collision(m, ahead)
        self._model.complete(ahead)
        self._read()

    def _look(self) -> None:
        """Find the rows, unless no gap or limit is violated."""
        m, ahead = self._model.model, self.data
        self._mj.mj_fwdKinematics(m, ahead)
        self._mj.mj_collision(m, ahead)
        self._model.complete(ahead)
        if self._is_plain and self._holds():
            self.depth = self._worst = 0.0
            self._has_rows = False
        else:
            self._read()

    def _holds(self) -> bool:
        if len(self._limited):
            angles = self.data.qpos[self._limited]
            if (angles < self._least).any() or (angles > self._most).any():
                return False
        contacts, model = self.data.contact, self._model
        stepper = self.reader.stepper
        depth = stepper.depth(contacts.geom, contacts.dist, contacts.includemargin, model.detection)
        return depth <= self._exact

    def _read(self) -> None:
        m, ahead, self._has_rows = self._model.model, self.data, True
        self._mj.mj_makeConstraint(m, ahead)
        self.depth = self._worst = self.reader.read(ahead)
        self._errors = _NONE
        if ahead.ne:
            self._errors = np.abs(ahead.efc_pos[: ahead.ne]) * self.reader.stepper.moves()
            self._worst = max(self.depth, float(self._errors.max()))

    def _move(self, parts: tuple[float, ...]) -> bool:
        """Move towards where the linearised rows hold; return whether there is such a place.

        Violations decrease along the change at first: of the parts, the first that helps is taken.
        """
        ahead, worst, start = self.data, self._worst, self.data.qpos.copy()
        self._factor()
        # What is as near as the others are violated may close.
        equalities = ahead.efc_pos[: ahead.ne] if ahead.ne else _NONE
        change = self.reader.stepper.close(equalities, self._worst, _TOLERANCE)
        if not change.any():
            return False
        for part in parts:
            ahead.qpos[:] = start
            self._mj.mj_integratePos(self._model.model, ahead.qpos, change, part)
            self._look()
            if self._worst < worst:
                break
        return True

    def _factor(self) -> None:
        m, ahead = self._model.model, self.data
        self._mj.mj_makeM(m, ahead)
        self._mj.mj_factorM(m, ahead)
        self.reader.factor(ahead)
