"""The rows of MuJoCo's limits and contacts, in steps of kinematic trees."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

import asperity._core as _core
from asperity.errors import ParameterError
from asperity.mujoco.guided import Guidance
from asperity.mujoco.laws import PairLaws
from asperity.mujoco.model import RowsModel
from asperity.solvers import Solver, chosen

if TYPE_CHECKING:
    from collections.abc import Sequence

    import mujoco

_NONE = np.zeros(0)


class Layout(NamedTuple):
    """What rows there are: those of equalities, dry joints, limits and contacts, in this order.

    `unilateral` are the rows of limits and the normal rows of contacts; `contacts` the numbers of
    contacts in MuJoCo's list, `pairs` their geoms.
    """

    begin: int
    limits: int
    unilateral: NDArray[np.int64]
    contacts: NDArray[np.int64]
    pairs: Sequence[tuple[int, int]]


class Reader:
    """Reads the rows that MuJoCo made; keeps what stays from one step to the next.

    Without laws, no contact has friction.
    """

    def __init__(self, model: RowsModel, laws: PairLaws | None, solver: Solver | None) -> None:
        self._model, self._laws, self._solver = model, laws, chosen(solver)
        m = model.model
        self._trees = (
            np.append(m.M_rowadr, len(m.M_colind)).astype(np.int64),
            m.M_colind.astype(np.int64),
            m.dof_treeid.astype(np.int64),
        )
        self._known = 0
        self._moves_surfaces = bool(m.flg_surfacevel)
        self.guidance: Guidance | None = None
        self._renew()

    def _renew(self) -> None:
        model, laws = self._model, None if self._laws is None else self._laws.laws
        self._known = 0 if laws is None else len(laws)
        geoms = (model.rank, model.is_fixed, model.is_plane, model.depth)
        self.stepper = _core.TreeStepper(
            None if laws is None else [law._core for law in laws],
            self._solver._core,
            *self._trees,
            list(zip(*(values.tolist() for values in geoms), strict=True)),
        )

    @property
    def layout(self) -> Layout:
        """What rows there are."""
        return Layout(*self.stepper.layout())

    def read(self, data: mujoco.MjData) -> float:
        """Take in all rows; return the largest depth of a limit or contact that something moves."""
        model, contacts = self._model, data.contact
        address, geoms, counts = contacts.efc_address, contacts.geom, (data.ne, data.nf, data.nl)
        if not self.stepper.is_listed(counts, address, geoms):
            self._list(data, contacts, counts, address, geoms)
        jacobian, sparsity = data.efc_J, None
        if model.is_sparse:
            sparsity = data.efc_J_rownnz, data.efc_J_rowadr, data.efc_J_colind
        else:
            jacobian = jacobian[: data.nefc * model.model.nv]
        stepper = self.stepper
        limits = data.efc_pos if counts[2] else _NONE
        dry = data.efc_frictionloss if counts[1] else _NONE
        depth = stepper.place(jacobian, sparsity, limits, contacts.dist, dry, model.dt)
        if self._laws is not None and self._laws.have_axes:
            factors = None
            if self._laws.have_factors:
                factors = self._laws.factors(data, self.layout.contacts, self.layout.pairs)
            stepper.turn(contacts.frame, data.geom_xmat, data.xmat, factors)
        if self._moves_surfaces or self.guidance is not None:
            self.drive(data)
        return depth

    def factor(self, data: mujoco.MjData) -> None:
        """Take in the factors of the mass matrix."""
        try:
            self.stepper.factor(data.qLD)
        except ParameterError as error:
            fastest = float(np.abs(data.qvel).max())
            raise ParameterError(
                "data",
                f"must have a positive definite mass matrix, it has none at {data.time:g} s, where "
                f"the largest velocity is {fastest:.3g}: try a smaller timestep",
            ) from error

    def drive(self, data: mujoco.MjData) -> None:
        """Take in the velocities of surfaces and of mocap bodies."""
        contacts, layout, driven = data.contact, self.layout, np.zeros(data.nefc)
        number, first = layout.contacts, layout.unilateral[layout.limits :]
        velocities, dimensions = np.zeros((len(number), 4)), contacts.dim[number]
        if self._moves_surfaces:
            velocities[:, 1:] = contacts.surfacevel[number]
        if self.guidance is not None:
            driven[: data.ne] = self.guidance.rates
            frames, hands = contacts.frame[number], self._model.hand[contacts.geom[number]]
            velocities += self.guidance.of_contacts(
                hands, contacts.pos[number], frames.reshape(-1, 3, 3)
            )
        for axis in range(4):
            has = dimensions > axis
            driven[first[has] + axis] = velocities[has, axis]
        self.stepper.drive(driven)

    def _list(
        self,
        data: mujoco.MjData,
        contacts: mujoco._structs._MjContactList,
        counts: tuple[int, int, int],
        address: NDArray[np.int32],
        geoms: NDArray[np.int32],
    ) -> None:
        model = self._model
        model.refuse_overflow(data)
        limits = None
        if counts[2] and model.have_margins:
            begin = counts[0] + counts[1]
            limits = model.limit_margins(data, np.arange(begin, begin + counts[2]))
        listed = (
            *(counts, address, geoms, contacts.includemargin, model.detection, limits),
            *(contacts.pos, data.geom_xpos, data.geom_xmat),
        )
        new = self.stepper.list(*listed)
        if new and self._laws is not None:
            friction = contacts.friction
            laws = {tuple(geoms[k].tolist()): friction[k] for k in new}
            found = {pair: self._laws.of_pair(pair, own) for pair, own in laws.items()}
            if len(self._laws.laws) > self._known:
                self._renew()
            for pair, law in found.items():
                self.stepper.learn(pair, law.number, law.restitution, law.axes, law.flat)
            self._list(data, contacts, counts, address, geoms)
