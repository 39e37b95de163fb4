"""Adhesion: of geoms, a force at every contact; by actuators, shared by what their body touches."""

from __future__ import annotations

from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np

from asperity._base.arrays import Array

if TYPE_CHECKING:
    import mujoco

    from asperity.mujoco.model import RowsModel


class Adhesion:
    """Forces of adhesion on a state.

    The force f of an actuator pulls along the mean of the normals of the contacts of its body,
    −f/n Σ J_N, that of geoms and pairs at every contact, −f J_N. MuJoCo takes every contact that
    it has found, which are many more here.
    """

    def __init__(self, rows: RowsModel, near: float) -> None:
        mj, m = rows.mj, rows.model
        kinds = m.actuator_trntype == mj.mjtTrn.mjTRN_BODY
        self._mj: ModuleType = mj
        self._rows, self._near = rows, near
        self._bodies: dict[int, int] = {
            actuator: int(m.actuator_trnid[actuator, 0])
            for actuator in np.flatnonzero(kinds).tolist()
        }
        self._moments = np.zeros((len(self._bodies), m.nv))
        self._is_any = bool(self._bodies or m.flg_adhesion)

    def __bool__(self) -> bool:
        return self._is_any

    def look(self, data: mujoco.MjData) -> None:
        """Find what bodies touch, up to gaps within which the user's model pulls."""
        m = self._rows.model
        self._moments[:] = 0.0
        touching = [
            (contact, bodies)
            for contact, bodies in zip(data.contact, m.geom_bodyid[data.contact.geom], strict=True)
            if contact.dist - contact.includemargin + self._rows.detection
            <= self._near + self._rows.gap(*contact.geom.tolist())
        ]
        if m.flg_adhesion:
            for contact, _ in touching:
                contact.adhesion = self._rows.adhesion(*contact.geom.tolist())
        for moment, body in zip(self._moments, self._bodies.values(), strict=True):
            own = [(contact, bodies) for contact, bodies in touching if body in bodies]
            for contact, (first, second) in own:
                moment -= self._normal(data, contact, int(second)) / len(own)
                moment += self._normal(data, contact, int(first)) / len(own)

    def correct(self, data: mujoco.MjData) -> None:
        """Put the forces of these contacts in the place of MuJoCo's."""
        for moment, actuator in zip(self._moments, self._bodies, strict=True):
            begin, count = data.moment_rowadr[actuator], data.moment_rownnz[actuator]
            columns = data.moment_colind[begin : begin + count]
            change = moment.copy()
            change[columns] -= data.actuator_moment.ravel()[begin : begin + count]
            data.qfrc_actuator[:] += data.actuator_force[actuator] * change

    def _normal(self, data: mujoco.MjData, contact: mujoco.MjContact, body: int) -> Array:
        """Return the row of the velocity of a body along the normal of a contact."""
        jacobian = np.zeros((3, self._rows.model.nv))
        self._mj.mj_jac(self._rows.model, data, jacobian, None, contact.pos, body)
        row: Array = contact.frame[:3] @ jacobian
        return row
