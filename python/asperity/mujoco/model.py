"""A private copy of a MuJoCo model whose rows are those of all contacts and limits nearby."""

from __future__ import annotations

import copy
from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from asperity._base import arrays, extras
from asperity.errors import ParameterError

if TYPE_CHECKING:
    import mujoco

# Limits have rows at any distance: those that stay open are left out of the step.
_FAR = 1e10
_ROLLING = 6
# Distances of a pair that differ by more than so many times MuJoCo's tolerance are not the same.
_MISSED = 10.0


class RowsModel:
    """The copy, with the detection distance of contacts, and what the user's model says of rows.

    MuJoCo makes rows for contacts and limits within their margins only: those of the copy are
    wider. The user's margins are part of the gap, as bodies rest there in MuJoCo.
    """

    def __init__(self, model: mujoco.MjModel, *, ignore_rolling: bool) -> None:
        self.mj = extras.library("mujoco")
        self.given = arrays.of_kind(model, "model", self.mj.MjModel, "a mujoco.MjModel")
        # As it is now: what the user changes later must not reach some parts and others not.
        self.user, self.model = copy.copy(model), copy.copy(model)
        m = self.model
        _refuse(self.mj, m, ignore_rolling)
        disable, enable = self.mj.mjtDisableBit, self.mj.mjtEnableBit
        m.opt.cone = self.mj.mjtCone.mjCONE_ELLIPTIC
        m.opt.integrator = self.mj.mjtIntegrator.mjINT_EULER
        # What only MuJoCo's own solver needs.
        m.opt.solver = self.mj.mjtSolver.mjSOL_NEWTON
        m.opt.disableflags |= int(disable.mjDSBL_ISLAND) | int(disable.mjDSBL_EULERDAMP)
        for flag in (enable.mjENBL_SLEEP, enable.mjENBL_SPECULATIVE, enable.mjENBL_IPC):
            m.opt.enableflags &= ~int(flag)
        m.geom_condim[m.geom_condim == _ROLLING] = 4
        m.pair_dim[m.pair_dim == _ROLLING] = 4
        # Contacts in a gap would have one row for it.
        m.geom_adhesion[:] = 0.0
        m.pair_adhesion[:] = 0.0
        m.jnt_margin[:] = _FAR
        m.tendon_margin[:] = _FAR
        self.buffer = self.mj.MjData(m).nbuffer
        self.dt = float(m.opt.timestep)
        self.detection = 0.0
        self.damping = self.dt * m.dof_damping
        if int(m.opt.disableflags) & int(disable.mjDSBL_DAMPER):
            self.damping[:] = 0.0
        self.is_damped = bool(self.damping.any())
        self._diagonal = m.M_rowadr + m.M_rownnz - 1
        kinds = self.mj.mjtWarning
        self._full = int(kinds.mjWARN_CONTACTFULL), int(kinds.mjWARN_CNSTRFULL)
        self._pairs = {
            frozenset((int(a), int(b))): k
            for k, (a, b) in enumerate(zip(m.pair_geom1, m.pair_geom2, strict=True))
        }
        self.names = tuple(_geom_name(model, geom) for geom in range(model.ngeom))
        self.rank = self._ranks()
        self.is_fixed = m.body_weldid[m.geom_bodyid] == 0
        # The mocap body that a geom is part of, or −1.
        self.hand = m.body_mocapid[m.body_weldid[m.geom_bodyid]]
        types = self.mj.mjtGeom
        self.is_plane = m.geom_type == types.mjGEOM_PLANE
        # Pairs whose product is 1 have formulas, edges and faces of the others are clipped.
        edges = {types.mjGEOM_CAPSULE: 1, types.mjGEOM_BOX: 1}
        edges |= {types.mjGEOM_CYLINDER: 2, types.mjGEOM_MESH: 2}
        self._edges = [edges.get(kind, 0) for kind in m.geom_type.tolist()]
        self._nearest_alone = int(disable.mjDSBL_MULTICCD)
        finds_several = not int(m.opt.disableflags) & self._nearest_alone
        self._may_miss = finds_several and 2 in self._edges
        self.depth = self._depths()
        self.have_margins = bool(model.jnt_margin.any() or model.tendon_margin.any())
        self.is_sparse = bool(self.mj.mj_isSparse(m))
        self.joint_limit = int(self.mj.mjtConstraint.mjCNSTR_LIMIT_JOINT)

    def widen(self, detection: float) -> None:
        """Find contacts up to this distance in m from touching."""
        more = detection - self.detection
        m, self.detection = self.model, detection
        m.geom_margin += more / 2
        # Without it the bounding volumes of bodies with several geoms would hide contacts.
        m.body_margin += more / 2
        m.pair_margin += more

    def complete(self, data: mujoco.MjData) -> bool:
        """Add contacts at the nearest points of pairs where MuJoCo misses them; whether it does.

        Where edges or faces nearly lie on each other, it takes rims as polygons of 16 corners and
        no more than four points.
        """
        if not self._may_miss:
            return False
        mj, m, contacts, edges = self.mj, self.model, data.contact, self._edges
        found: dict[tuple[int, int], float] = {}
        for (a, b), distance in zip(contacts.geom.tolist(), contacts.dist.tolist(), strict=True):
            if edges[a] * edges[b] > 1:
                found[a, b] = min(distance, found.get((a, b), _FAR))
        if not found:
            return False
        most = _MISSED * m.opt.ccd_tolerance
        missed = {
            pair
            for pair, distance in found.items()
            if abs(mj.mj_geomDistance(m, data, *pair, _FAR, None) - distance) > most
        }
        if not missed:
            return False
        m.opt.disableflags |= self._nearest_alone
        try:
            mj.mj_collision(m, data)
            nearest = [copy.copy(c) for c in data.contact if tuple(c.geom.tolist()) in missed]
        finally:
            m.opt.disableflags &= ~self._nearest_alone
        mj.mj_collision(m, data)
        for contact in nearest:
            mj.mj_addContact(m, data, contact)
        return True

    def may_touch(self, first: int, second: int) -> bool:
        """Whether MuJoCo makes contacts of two geoms."""
        m = self.user
        if frozenset((first, second)) in self._pairs:
            return True
        bodies = sorted(int(m.geom_bodyid[geom]) for geom in (first, second))
        welds = [int(m.body_weldid[body]) for body in bodies]
        parents = [int(m.body_weldid[m.body_parentid[weld]]) for weld in welds]
        filters = not int(m.opt.disableflags) & int(self.mj.mjtDisableBit.mjDSBL_FILTERPARENT)
        if welds[0] == welds[1] or (bodies[0] << 16) + bodies[1] in m.exclude_signature:
            return False
        if filters and all(welds) and (welds[0] == parents[1] or welds[1] == parents[0]):
            return False
        types, affinities = m.geom_contype, m.geom_conaffinity
        return bool(types[first] & affinities[second] or types[second] & affinities[first])

    def gap(self, first: int, second: int) -> float:
        """Return how far beyond their margins MuJoCo finds contacts of two geoms."""
        m, pair = self.user, self._pairs.get(frozenset((first, second)))
        gap = m.geom_gap[first] + m.geom_gap[second] if pair is None else m.pair_gap[pair]
        return float(gap)

    def condim(self, first: int, second: int) -> int:
        """Return the dimension of the contacts of two geoms in the user's model."""
        m, pair = self.user, self._pairs.get(frozenset((first, second)))
        if pair is not None:
            return min(int(m.pair_dim[pair]), 4)
        return min(int(m.geom_condim[self._winners(first, second)].max()), 4)

    def adhesion(self, first: int, second: int) -> float:
        """Return the force in N with which two geoms attract each other at each contact."""
        m, pair = self.user, self._pairs.get(frozenset((first, second)))
        if pair is not None:
            return float(m.pair_adhesion[pair])
        return float(m.geom_adhesion[self._winners(first, second)].sum())

    def _winners(self, first: int, second: int) -> list[int]:
        """Return the geom of higher priority, or both."""
        one, other = self.user.geom_priority[[first, second]]
        return [first, second] if one == other else [first if one > other else second]

    def raise_condim(self, geoms: set[int], dimension: int) -> None:
        """Have MuJoCo make at least as many rows for contacts of these geoms."""
        m = self.model
        chosen = sorted(geoms)
        m.geom_condim[chosen] = np.maximum(m.geom_condim[chosen], dimension)
        for pair, number in self._pairs.items():
            if pair <= geoms:
                m.pair_dim[number] = max(m.pair_dim[number], dimension)

    def check(self, data: mujoco.MjData) -> None:
        """Refuse data of another model, and states that are not finite."""
        arrays.of_kind(data, "data", self.mj.MjData, "a mujoco.MjData")
        m = data.model
        is_same = data.nbuffer == self.buffer
        if not (is_same and (m is self.given or self._saved(m) == self._saved(self.user))):
            raise ParameterError("data", "must be that of the scene's model, not of another")
        if not (np.isfinite(data.qpos).all() and np.isfinite(data.qvel).all()):
            raise ParameterError("data", "must have finite qpos and qvel")

    def _saved(self, model: mujoco.MjModel) -> bytes:
        saved = np.empty(self.mj.mj_sizeModel(model), dtype=np.uint8)
        self.mj.mj_saveModel(model, None, saved)
        return saved.tobytes()

    def limit_margins(self, data: mujoco.MjData, rows: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return the distances at which the user's model has the limits of these rows rest."""
        is_joint = data.efc_type[rows] == self.joint_limit
        number = data.efc_id[rows]
        margins = np.empty(len(rows))
        margins[is_joint] = self.user.jnt_margin[number[is_joint]]
        margins[~is_joint] = self.user.tendon_margin[number[~is_joint]]
        return margins

    def factor(self, data: mujoco.MjData) -> None:
        """Factor M + h D in place of M, for damping that is implicit."""
        entries = data.M
        own = entries[self._diagonal]
        entries[self._diagonal] = own + self.damping
        self.mj.mj_factorM(self.model, data)
        entries[self._diagonal] = own

    def refuse_overflow(self, data: mujoco.MjData) -> None:
        """Refuse data without the memory for all contacts nearby, some of which MuJoCo drops."""
        numbers = data.warning.number
        if any(numbers[kind] for kind in self._full):
            raise ParameterError(
                "model", 'has no memory for all contacts nearby: raise <size memory="..."/>'
            )

    def item_name(self, data: mujoco.MjData, row: int, pair: tuple[int, int] | None) -> str:
        """Return what the user calls a contact of two geoms, or the row of a joint or tendon."""
        if pair is not None:
            return "contact of " + " and ".join(repr(self.names[geom]) for geom in pair)
        kinds, objects = self.mj.mjtConstraint, self.mj.mjtObj
        words, of = {
            kinds.mjCNSTR_EQUALITY: ("equality", objects.mjOBJ_EQUALITY),
            kinds.mjCNSTR_FRICTION_DOF: ("frictionloss of joint", objects.mjOBJ_JOINT),
            kinds.mjCNSTR_FRICTION_TENDON: ("frictionloss of tendon", objects.mjOBJ_TENDON),
            kinds.mjCNSTR_LIMIT_JOINT: ("limit of joint", objects.mjOBJ_JOINT),
            kinds.mjCNSTR_LIMIT_TENDON: ("limit of tendon", objects.mjOBJ_TENDON),
        }[kinds(int(data.efc_type[row]))]
        number = int(data.efc_id[row])
        if words == "frictionloss of joint":
            number = int(self.user.dof_jntid[number])
        name = self.mj.mj_id2name(self.user, of, number)
        return f"{words} {name or number!r}"

    def _ranks(self) -> NDArray[np.int64]:
        """Return numbers of geoms by what they are, whatever their order in the file."""
        m = self.user

        def identity(geom: int) -> tuple[object, ...]:
            body = m.geom_bodyid[geom]
            places = (m.body_pos[body], m.body_quat[body], m.geom_pos[geom], m.geom_quat[geom])
            shape = (int(m.geom_type[geom]), m.geom_size[geom].tolist())
            return (m.geom(geom).name, m.body(body).name, *shape, *(p.tolist() for p in places))

        order = sorted(range(m.ngeom), key=identity)
        return np.argsort(np.array(order, dtype=np.int64))

    def _depths(self) -> NDArray[np.float64]:
        """Return by how much geoms rest in each other, in m.

        MuJoCo finds one point instead of eight where two boxes touch within 1e-9 m. Equalities are
        violated by up to 1e-9 of the extent: contacts that they hold must not contradict them.
        """
        least = 1e-8 * self.user.stat.extent if self.user.neq else 0.0
        types = self.mj.mjtGeom
        flat = np.isin(
            self.user.geom_type, [types.mjGEOM_BOX, types.mjGEOM_MESH, types.mjGEOM_CYLINDER]
        )
        return np.maximum(np.where(flat, 1e-5 * self.user.geom_rbound, 0.0), least)


def _geom_name(model: mujoco.MjModel, geom: int) -> str:
    own = model.geom(geom).name
    if own:
        return own
    body = model.body(model.geom_bodyid[geom])
    return f"{body.name or 'body ' + str(body.id)}[{geom - int(body.geomadr[0])}]"


def _refuse(mj: ModuleType, m: mujoco.MjModel, ignore_rolling: bool) -> None:
    """Refuse, by name, what has no rows that a contact law could have."""
    if not m.opt.timestep > 0.0:
        raise ParameterError("model", f"must have a positive timestep, has {m.opt.timestep:g}")
    if m.nflex:
        raise ParameterError("model", "has a flex, whose contacts are not those of rigid bodies")
    touching = (m.geom_contype != 0) | (m.geom_conaffinity != 0)
    rolling = np.flatnonzero(touching & (m.geom_condim == _ROLLING)).tolist()
    rolling += m.pair_geom1[m.pair_dim == _ROLLING].tolist()
    if rolling and not ignore_rolling:
        name = _geom_name(m, rolling[0])
        raise ParameterError(
            "model",
            f'has rolling friction (condim 6) at geom {name!r}: rolling="ignore" leaves it out',
        )
    if int(m.opt.enableflags) & int(mj.mjtEnableBit.mjENBL_OVERRIDE):
        raise ParameterError("model", "overrides the parameters of its contacts: turn override off")
    pairs = [frozenset(pair) for pair in zip(m.pair_geom1, m.pair_geom2, strict=True)]
    if len(set(pairs)) < len(pairs):
        twice = next(pair for pair in pairs if pairs.count(pair) > 1)
        names = " and ".join(repr(_geom_name(m, geom)) for geom in sorted(twice))
        raise ParameterError("model", f"has two <pair> of the geoms {names}: keep one of them")
