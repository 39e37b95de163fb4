"""The rows of MuJoCo's limits and contacts, in steps of kinematic trees."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

import asperity._core as _core
from asperity.contact import ContactStepper
from asperity.mujoco.laws import ContactLaw, PairLaws
from asperity.mujoco.model import RowsModel
from asperity.solvers import Solver, chosen

if TYPE_CHECKING:
    import mujoco

# Keys of contacts begin here, behind those of joints and limits.
_CONTACTS = 1 << 40
_POINTS = 1 << 20
_NONE = np.zeros(0)
# A direction of which no two corners of a box, or points of a grid, have the same coordinate.
_PLACE = np.array([1.0, np.sqrt(2.0), np.sqrt(3.0)])


@dataclass(slots=True)
class Layout:
    """What rows there are: those of equalities, dry joints, limits and contacts, in this order.

    `unilateral` are the rows of limits and the normal rows of contacts; `contacts` the numbers of
    contacts in MuJoCo's list, `geoms` their pairs, `laws` what they have.
    """

    begin: int
    limits: int
    unilateral: NDArray[np.int64]
    contacts: NDArray[np.int64]
    geoms: NDArray[np.int32]
    laws: list[ContactLaw]

    def pair(self, contact: int) -> tuple[int, int]:
        """Return the numbers of the geoms of a contact."""
        return int(self.geoms[contact, 0]), int(self.geoms[contact, 1])

    def pairs(self) -> list[tuple[int, int]]:
        """Return the numbers of the geoms of all contacts."""
        return [(one, other) for one, other in self.geoms.tolist()]


class Reader:
    """Reads the rows that MuJoCo made; keeps what stays from one step to the next.

    Without laws, no contact has friction.
    """

    def __init__(self, model: RowsModel, laws: PairLaws | None, solver: Solver | None) -> None:
        self._model, self._laws, self._solver = model, laws, chosen(solver)
        self._stays = False
        self.layout: Layout
        m = model.model
        self._trees = (
            np.append(m.M_rowadr, len(m.M_colind)).astype(np.int64),
            m.M_colind.astype(np.int64),
            m.dof_treeid.astype(np.int64),
        )
        self._known = 0
        self._renew()

    def _renew(self) -> None:
        laws = [] if self._laws is None else self._laws.laws
        self._known = len(laws)
        self.stepper = _core.TreeStepper(
            [law._core for law in laws], self._solver._core, *self._trees
        )

    def read(self, data: mujoco.MjData) -> float:
        """Take in all rows; return the largest depth of a limit or contact that something moves."""
        model, contacts = self._model, data.contact
        address, geoms, counts = contacts.efc_address, contacts.geom, (data.ne, data.nf, data.nl)
        if not (self._stays and self.stepper.is_listed(counts, address, geoms)):
            self._list(data, counts, address, geoms)
        jacobian, sparsity = data.efc_J, None
        if model.is_sparse:
            sparsity = data.efc_J_rownnz, data.efc_J_rowadr, data.efc_J_colind
        else:
            jacobian = jacobian[: data.nefc * model.model.nv]
        stepper = self.stepper
        limits = data.efc_pos if counts[2] else _NONE
        dry = data.efc_frictionloss if counts[1] else _NONE
        depth = stepper.place(jacobian, sparsity, limits, contacts.dist, dry, model.dt)
        if stepper.has_axes():
            stepper.turn(contacts.frame, data.geom_xmat, data.xmat)
        if model.model.flg_surfacevel and len(self.layout.contacts):
            stepper.move_surfaces(contacts.surfacevel)
        return depth

    def _list(
        self,
        data: mujoco.MjData,
        counts: tuple[int, int, int],
        address: NDArray[np.int32],
        geoms: NDArray[np.int32],
    ) -> None:
        model = self._model
        model.refuse_overflow(data)
        begin, limits = counts[0] + counts[1], counts[2]
        own = np.flatnonzero(address >= 0)
        pairs = geoms[own]
        rows = np.empty(limits + len(own), dtype=np.int64)
        rows[:limits], rows[limits:] = range(begin, begin + limits), address[own]
        kinds = np.full(len(rows), ContactStepper.FRICTIONLESS, dtype=np.int64)
        rest, keys, self._stays = np.zeros(len(rows)), np.arange(begin, begin + len(rows)), True
        if limits and model.have_margins:
            rest[:limits] = model.limit_margins(data, rows[:limits])
        found: list[ContactLaw] = []
        if len(own):
            rest[limits:] = data.contact.includemargin[own] - model.detection
            rest[limits:] -= model.depth[pairs].min(axis=1)
            if self._laws is not None:
                found = self._laws.of_contacts(pairs.tolist(), data.contact.friction, own)
                kinds[limits:] = [law.number for law in found]
                keys[limits:], self._stays = _keys(model, data, own, pairs)
                if len(self._laws.laws) > self._known:
                    self._renew()
        self.layout = Layout(begin, limits, rows, own, pairs, found)
        self.stepper.list(counts, address, geoms, own, rows, kinds, keys, rest)
        for k, law in enumerate(found):
            if law.axes is not None:
                axes = (law.axes.axis, law.axes.carrier, law.axes.is_reversed)
                self.stepper.carry(limits + k, *axes, law.radius)


def _keys(
    model: RowsModel, data: mujoco.MjData, contacts: NDArray[np.int64], geoms: NDArray[np.int32]
) -> tuple[NDArray[np.int64], bool]:
    """Return keys that do not depend on the order in which geoms and contacts are listed.

    Points of a pair are numbered by their places on the geom that moves; those on a plane are
    always in the same order, and their keys stay.
    """
    ranks = model.rank[geoms]
    pairs = ranks.min(axis=1) * len(model.rank) + ranks.max(axis=1)
    ordinal = np.zeros(len(pairs), dtype=np.int64)
    several = len(set(pairs.tolist())) < len(pairs)
    if several:
        first = geoms[:, 0]
        carrier = np.where(model.is_fixed[first], geoms[:, 1], first)
        axes = data.geom_xmat[carrier].reshape(-1, 3, 3) @ _PLACE
        position = data.contact.pos[contacts]
        place = ((position - data.geom_xpos[carrier]) * axes).sum(axis=1)
        order = np.lexsort((place, pairs))
        count = np.arange(len(pairs))
        is_first = np.diff(pairs[order], prepend=-1) != 0
        ordinal[order] = count - np.maximum.accumulate(np.where(is_first, count, 0))
    keys = _CONTACTS + pairs * _POINTS + ordinal
    return keys, not several or bool(model.is_plane[geoms].any(axis=1).all())
