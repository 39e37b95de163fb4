"""The rows of MuJoCo's joints, limits and contacts, and the items that a step makes of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array
from asperity.contact import ContactStepper
from asperity.mujoco.laws import ContactLaw, PairLaws
from asperity.mujoco.model import RowsModel

if TYPE_CHECKING:
    import mujoco

LIMIT, JOINT, DRY = (
    ContactStepper.FRICTIONLESS,
    ContactStepper.BILATERAL,
    ContactStepper.DRY_FRICTION,
)
# Keys of contacts begin here, behind those of joints and limits.
_CONTACTS = 1 << 40
_POINTS = 1 << 20
# A direction of which no two corners of a box, or points of a grid, have the same coordinate.
_PLACE = np.array([1.0, np.sqrt(2.0), np.sqrt(3.0)])


@dataclass(slots=True)
class Layout:
    """What rows there are: those of equalities, dry joints, limits and contacts, in this order.

    `unilateral` are the rows of limits and the normal rows of contacts; `contacts` the numbers of
    contacts in MuJoCo's list, `geoms` their pairs. `rest` is the distance at which the unilateral
    rows rest.
    """

    equalities: int
    begin: int
    limits: int
    unilateral: NDArray[np.int64]
    contacts: NDArray[np.int64]
    geoms: NDArray[np.int64]
    pairs: list[tuple[int, int]]
    rest: Array
    items: dict[bytes, Items]
    keys: NDArray[np.int64] | None = None


@dataclass(slots=True)
class Rows:
    """All rows near a state, with the gaps of those that are unilateral."""

    layout: Layout
    matrix: Array
    gaps: Array


@dataclass(slots=True)
class Items:
    """Those that take part in a step: their rows among all, laws, and the axes of these."""

    index: NDArray[np.int64]
    kinds: NDArray[np.int64]
    keys: NDArray[np.int64]
    contacts: list[int]
    laws: list[ContactLaw]
    has_axes: bool
    pyramids: list[Pyramids] | None = None

    @property
    def joints(self) -> int:
        """Number of items before those of contacts."""
        return len(self.kinds) - len(self.contacts)

    def first_rows(self) -> NDArray[np.int64]:
        """Return the first of the own rows of each contact."""
        sizes = [1 + law.dimension for law in self.laws]
        return len(self.index) - np.cumsum(sizes[::-1])[::-1]


class Pyramids(NamedTuple):
    """Rows of contacts with as many edges: of the cones before, of the edges, and half of 1/μ."""

    cones: NDArray[np.int64]
    edges: NDArray[np.int64]
    half: Array


def pyramids_of(items: Items, data: mujoco.MjData, layout: Layout) -> list[Pyramids]:
    """Return where forces along the edges of pyramids are, from rows that are pyramids by now."""
    contacts, number = data.contact, layout.contacts[items.contacts]
    cones = layout.unilateral[layout.limits :][items.contacts]
    count, edges = contacts.dim[number] - 1, contacts.efc_address[number]
    found = []
    for one in set(count.tolist()):
        own, axis = count == one, np.arange(one)
        half = 0.5 / contacts.friction[number[own], :one]
        rows = cones[own, None] + np.arange(one + 1)
        found.append(Pyramids(rows, edges[own, None] + 2 * axis if one else edges[own], half))
    return found


class Turns:
    """Turns of the rows of a step, from MuJoCo's tangents to the axes of the laws."""

    def __init__(self, items: Items, data: mujoco.MjData, layout: Layout) -> None:
        self._turns = []
        if not items.has_axes:
            return
        frames = data.contact.frame
        for k, law, row in zip(items.contacts, items.laws, items.first_rows(), strict=True):
            if law.axes is not None:
                a, b, c, d = law.axes.turn(data, frames[layout.contacts[k]])
                turn = np.zeros((law.dimension, law.dimension))
                turn[:2, :2] = (a, b), (c, d)
                turn[2:, 2:] = law.radius
                self._turns.append((slice(row + 1, row + 1 + law.dimension), turn))

    def turn(self, rows: Array) -> None:
        """Turn rows of MuJoCo's tangents into those of the axes."""
        for own, turn in self._turns:
            rows[own] = turn @ rows[own]

    def turn_back(self, percussion: Array) -> Array:
        """Return percussions of the axes' rows as those of MuJoCo's rows."""
        turned = percussion.copy()
        for own, turn in self._turns:
            turned[own] = turn.T @ percussion[own]
        return turned


class Reader:
    """Reads the rows that MuJoCo made; keeps what stays from one step to the next."""

    def __init__(self, model: RowsModel) -> None:
        self._model = model
        self._identity: tuple[int, int, int, bytes, bytes] | None = None
        self._layout: Layout

    def read(self, data: mujoco.MjData) -> Rows:
        """Return all rows."""
        model, contacts = self._model, data.contact
        address, geoms, limits = contacts.efc_address, contacts.geom, data.nl
        identity = (data.ne, data.nf, limits, address.tobytes(), geoms.tobytes())
        if identity != self._identity:
            model.refuse_overflow(data)
            self._layout, self._identity = _layout(model, data, address, geoms), identity
        layout = self._layout
        nefc, nv = data.nefc, model.model.nv
        gaps = np.empty(len(layout.unilateral))
        if limits:
            gaps[:limits] = data.efc_pos[layout.begin : layout.begin + limits]
        if len(layout.contacts):
            distance = contacts.dist
            whole = len(distance) == len(layout.contacts)
            gaps[limits:] = distance if whole else distance[layout.contacts]
        gaps -= layout.rest
        return Rows(layout, data.efc_J[: nefc * nv].reshape(nefc, nv), gaps)

    def items(
        self, laws: PairLaws, data: mujoco.MjData, rows: Rows, is_near: NDArray[np.bool_]
    ) -> Items:
        """Return the items of joints, and of the limits and contacts that are near."""
        layout = rows.layout
        if layout.keys is None:
            keys, stay = _keys(self._model, data, layout)
            layout.items.clear()
            layout.keys = keys
            if not stay:
                self._identity = None
        which = is_near.tobytes()
        items = layout.items.get(which)
        if items is None:
            items = layout.items[which] = _items(laws, data, layout, is_near)
        return items


def _layout(
    model: RowsModel, data: mujoco.MjData, address: NDArray[np.int64], geoms: NDArray[np.int64]
) -> Layout:
    begin, limits = data.ne + data.nf, data.nl
    own = np.flatnonzero(address >= 0)
    limit, geoms = np.arange(begin, begin + limits), geoms[own]
    is_joint = data.efc_type[limit] == model.joint_limit
    joints, tendons = data.efc_id[limit[is_joint]], data.efc_id[limit[~is_joint]]
    rest = np.zeros(limits + len(own))
    rest[:limits][is_joint] = model.user.jnt_margin[joints]
    rest[:limits][~is_joint] = model.user.tendon_margin[tendons]
    rest[limits:] = data.contact.includemargin[own] - model.detection
    rest[limits:] -= model.depth[geoms].min(axis=1, initial=np.inf)
    rows = np.concatenate((limit, address[own]))
    pairs = [(one, other) for one, other in geoms.tolist()]
    return Layout(data.ne, begin, limits, rows, own, geoms, pairs, rest, {})


def _keys(model: RowsModel, data: mujoco.MjData, layout: Layout) -> tuple[NDArray[np.int64], bool]:
    """Return keys that do not depend on the order in which geoms and contacts are listed.

    Points of a pair are numbered by their places on the geom that moves; those on a plane are
    always in the same order, and their keys stay.
    """
    geoms = layout.geoms
    ranks = model.rank[geoms]
    pairs = ranks.min(axis=1) * len(model.rank) + ranks.max(axis=1)
    ordinal = np.zeros(len(pairs), dtype=np.int64)
    several = len(set(layout.pairs)) < len(layout.pairs)
    if several:
        first = geoms[:, 0]
        carrier = np.where(model.is_fixed[first], geoms[:, 1], first)
        axes = data.geom_xmat[carrier].reshape(-1, 3, 3) @ _PLACE
        position = data.contact.pos[layout.contacts]
        place = ((position - data.geom_xpos[carrier]) * axes).sum(axis=1)
        order = np.lexsort((place, pairs))
        count = np.arange(len(pairs))
        is_first = np.diff(pairs[order], prepend=-1) != 0
        ordinal[order] = count - np.maximum.accumulate(np.where(is_first, count, 0))
    keys = np.concatenate(
        (np.arange(layout.begin + layout.limits), _CONTACTS + pairs * _POINTS + ordinal)
    )
    return keys, not several or bool(model.is_plane[geoms].any(axis=1).all())


def _items(
    laws: PairLaws, data: mujoco.MjData, layout: Layout, is_near: NDArray[np.bool_]
) -> Items:
    chosen = np.flatnonzero(is_near)
    first = layout.unilateral[chosen].tolist()
    limits = int(np.count_nonzero(is_near[: layout.limits]))
    index = [*range(layout.begin), *first[:limits]]
    dry = layout.begin - layout.equalities
    kinds = [JOINT] * layout.equalities + [DRY] * dry + [LIMIT] * limits
    contacts = (chosen[limits:] - layout.limits).tolist()
    friction = data.contact.friction
    found = [laws.of(layout.pairs[k], friction[layout.contacts[k]]) for k in contacts]
    for law, row in zip(found, first[limits:], strict=True):
        index.extend(range(row, row + 1 + law.dimension))
        kinds.append(law.number)
    own = np.concatenate((np.arange(layout.begin), layout.begin + chosen))
    assert layout.keys is not None
    return Items(
        np.array(index, dtype=np.int64),
        np.array(kinds, dtype=np.int64),
        layout.keys[own],
        contacts,
        found,
        has_axes=any(law.axes is not None for law in found),
    )
