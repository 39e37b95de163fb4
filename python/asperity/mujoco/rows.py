"""The rows of MuJoCo's joints, limits and contacts, and the items that a step makes of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

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
class Rows:
    """All rows near a state: of equalities, dry joints, limits and contacts, in this order.

    `unilateral` are the rows of limits and the normal rows of contacts, with their `gaps`;
    `contacts` the numbers of contacts in MuJoCo's list, `geoms` their pairs.
    """

    matrix: Array
    unilateral: NDArray[np.int64]
    gaps: Array
    limits: int
    contacts: NDArray[np.int64]
    geoms: NDArray[np.int64]


@dataclass(slots=True)
class Items:
    """Those that take part in a step: their rows among all, laws, and the axes of these."""

    index: list[int]
    kinds: list[int]
    keys: list[int]
    contacts: list[int]
    laws: list[ContactLaw]
    turned: list[tuple[int, tuple[float, float, float, float], float]]

    @property
    def joints(self) -> int:
        """Number of items before those of contacts."""
        return len(self.kinds) - len(self.contacts)

    def turn(self, matrix: Array) -> None:
        """Turn rows of MuJoCo's tangents into those of the laws' axes."""
        for row, (a, b, c, d), radius in self.turned:
            one, other = matrix[row], matrix[row + 1].copy()
            matrix[row + 1] = c * one + d * other
            matrix[row] = a * one + b * other
            if radius:
                matrix[row + 2] *= radius

    def turn_back(self, percussion: Array) -> Array:
        """Return percussions of the laws' rows as those of MuJoCo's rows."""
        turned = percussion.copy()
        for row, (a, b, c, d), radius in self.turned:
            one, other = percussion[row], percussion[row + 1]
            turned[row], turned[row + 1] = a * one + c * other, b * one + d * other
            if radius:
                turned[row + 2] *= radius
        return turned


def all_rows(model: RowsModel, data: mujoco.MjData) -> Rows:
    """Return all rows that MuJoCo made."""
    nefc, nv = data.nefc, model.model.nv
    begin, limits = data.ne + data.nf, data.nl
    matrix = data.efc_J[: nefc * nv].reshape(nefc, nv)
    rows, gaps = np.arange(begin, begin + limits), data.efc_pos[begin : begin + limits].copy()
    if model.has_margins and limits:
        number = data.efc_id[begin : begin + limits]
        is_joint = data.efc_type[begin : begin + limits] == model.joint_limit
        gaps[is_joint] -= model.user.jnt_margin[number[is_joint]]
        gaps[~is_joint] -= model.user.tendon_margin[number[~is_joint]]
    contacts = data.contact
    address, geoms = contacts.efc_address, contacts.geom
    distance = contacts.dist - contacts.includemargin + model.detection
    own = np.arange(len(address))
    if len(address) and address.min() < 0:
        own = np.flatnonzero(address >= 0)
        address, geoms, distance = address[own], geoms[own], distance[own]
    if model.has_depth and len(own):
        distance += model.depth[geoms].min(axis=1)
    return Rows(
        matrix,
        np.concatenate((rows, address)),
        np.concatenate((gaps, distance)),
        limits,
        own,
        geoms,
    )


def keys_of_contacts(model: RowsModel, data: mujoco.MjData, geoms: NDArray[np.int64]) -> list[int]:
    """Return keys that do not depend on the order in which geoms and contacts are listed.

    Points of a pair are numbered by their places on the geom that moves.
    """
    ranks = model.rank[geoms]
    pairs = ranks.min(axis=1) * len(model.rank) + ranks.max(axis=1)
    ordinal = np.zeros(len(pairs), dtype=np.int64)
    if len(pairs) > 1:
        first = geoms[:, 0]
        carrier = np.where(model.is_fixed[first], geoms[:, 1], first)
        axes = data.geom_xmat[carrier].reshape(-1, 3, 3) @ _PLACE
        own = (
            data.contact.pos if len(data.contact) == len(geoms) else data.contact.pos[: len(geoms)]
        )
        place = ((own - data.geom_xpos[carrier]) * axes).sum(axis=1)
        order = np.lexsort((place, pairs))
        count = np.arange(len(pairs))
        is_first = np.diff(pairs[order], prepend=-1) != 0
        ordinal[order] = count - np.maximum.accumulate(np.where(is_first, count, 0))
    return (_CONTACTS + pairs * _POINTS + ordinal).tolist()


def items_of(
    model: RowsModel,
    laws: PairLaws,
    data: mujoco.MjData,
    rows: Rows,
    keys: list[int],
    is_near: NDArray[np.bool_],
) -> Items:
    """Return the items of joints, and of the limits and contacts that are near."""
    ne, begin = data.ne, data.ne + data.nf
    chosen = np.flatnonzero(is_near)
    first = rows.unilateral[chosen].tolist()
    limits = int(np.count_nonzero(is_near[: rows.limits]))
    index = [*range(begin), *first[:limits]]
    kinds = [JOINT] * ne + [DRY] * (begin - ne) + [LIMIT] * limits
    items = Items(index, kinds, index.copy(), [], [], [])
    if limits == len(first):
        return items
    friction, frames = data.contact.friction, data.contact.frame
    for k, row in zip((chosen[limits:] - rows.limits).tolist(), first[limits:], strict=True):
        number = rows.contacts[k]
        one, other = rows.geoms[k].tolist()
        law = laws.of((one, other), friction[number])
        if law.axes is not None:
            turn = law.axes.turn(data, frames[number])
            items.turned.append((len(index) + 1, turn, law.radius if law.dimension == 3 else 0.0))
        index.extend(range(row, row + 1 + law.dimension))
        kinds.append(law.number)
        items.keys.append(keys[k])
        items.contacts.append(k)
        items.laws.append(law)
    return items
