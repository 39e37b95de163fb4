"""Steps of a MuJoCo model with set-valued friction."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import wraps
from threading import RLock
from typing import TYPE_CHECKING, Any, Concatenate, Literal, NamedTuple, ParamSpec, TypeVar
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.contact import StepSolution
from asperity.errors import ConvergenceError, NoSolutionError, ParameterError
from asperity.mujoco.adhesion import Adhesion
from asperity.mujoco.guided import Guidance, Places
from asperity.mujoco.laws import Laws, PairLaws
from asperity.mujoco.model import RowsModel
from asperity.mujoco.projection import Projector
from asperity.mujoco.results import Projection, SceneContact, SceneProblem, SceneRun, SceneStep
from asperity.mujoco.rows import Layout, Reader
from asperity.solvers import Solver
from asperity.status import Phase, Status

if TYPE_CHECKING:
    import mujoco

    import asperity._core as _core

# Parts of the model's extent: violations up to the first stay, starts with more than the second are
# refused.
_EXACT, _START = 1e-9, 1e-6
# Projections converge like Newton's method where they are possible.
_PROJECTIONS = 20
# What says that percussions do not exist, or probably.
_CRUSHED = Status.NO_SOLUTION, Status.UNBOUNDED
# Steps without a contact that was found too late, after which the detection distance is halved.
_QUIET = 100


_Given = ParamSpec("_Given")
_Found = TypeVar("_Found")


def _alone(
    method: Callable[Concatenate[Scene, _Given], _Found],
) -> Callable[Concatenate[Scene, _Given], _Found]:
    """Have other threads wait: a scene has buffers, and remembers the last step."""

    @wraps(method)
    def locked(scene: Scene, /, *given: _Given.args, **named: _Given.kwargs) -> _Found:
        with scene._lock:
            return method(scene, *given, **named)

    return locked


class _Left(NamedTuple):
    """The end of a step: time and state, where mocap bodies were, and whether they had moved."""

    state: tuple[float, bytes]
    places: Places | None
    moved: bool


class Scene:
    """A MuJoCo model whose contacts, limits and joints are rigid, with set-valued friction.

    ``scene.step(data)`` takes the place of ``mujoco.mj_step(model, data)``: Moreau's midpoint rule,
    with percussions P that obey the laws of contact at the end of the step,

        q_M = q ⊕ ½h v,  (M + hD)(v⁺ − v) = h f(q_M, ½(v + v⁺)) − hD v + JᵀP,  q⁺ = q_M ⊕ ½h v⁺

    f are the forces without the damping D of joints, and their v⁺ is that of a first solve. Normal
    velocities are at least −gap/½h, with restitution −e_N γ_N where a gap would close; equalities
    reflect what their path curves, J(v + v⁺) = 0, which keeps the energy. Gaps, limits and
    equalities that are violated at the end by more than 1e-9 of the model's extent are projected.

    Bodies touch where MuJoCo lets them rest, at the sum of their margins. ``solref``, ``solimp``
    and ``impratio`` have no effect: equalities, limits and ``frictionloss`` are rigid. The step is
    that of ``model.opt.timestep``, whatever the integrator. Contacts without a law given here have
    the friction coefficients of MuJoCo, which combines those of the geoms: a disk, for ``condim`` 4
    an ellipsoid with the drilling, also where the cone is pyramidal; ``condim`` 1 has no friction.

    Mocap bodies that were moved since the last step go there in this one, with constant velocity:
    they carry what is welded to them and what lies on them. ``scene.project(data)`` places them at
    rest.

    After a step ``data`` holds the state at its end; positions of bodies, contacts and forces
    (``efc_force``, ``qacc``, ``cfrc_ext`` by ``mj_rnePostConstraint``, sensors) are those of its
    midpoint. Contacts nearby are listed, too.

    A scene may step several data in turn; threads wait for each other. Copies, by pickle too, do
    not remember the steps before: they begin as a scene does with new data, with mocap bodies at
    rest. A copy is of the same class and keeps the attributes that a subclass adds.

    Args:
        model: a ``mujoco.MjModel``. The scene works on a copy: later changes have no effect.
        laws: by pairs of names of geoms or bodies, and ``"default"``: a `FrictionLaw`, whose first
            axis is that of the first of the pair, or a `PairLaw`. Geoms win over bodies, also where
            both have the name.
        starts: ``"refuse"`` states that violate gaps, limits or equalities by more than 1e-6 of the
            model's extent, or ``"project"`` them: the first state, and every one that was changed
            by hand, also by switching equalities.
        normal_restitution: e_N in [0, 1] of contacts whose `PairLaw` gives none; limits have none.
        rolling: ``"refuse"`` geoms with ``condim`` 6, or ``"ignore"`` their rolling friction.
        on_failure: ``"raise"``, with the data as before the step, or ``"record"``: take the step
            with the percussions where the solver ended; mocap bodies that crush others, or that
            these cannot follow, are refused all the same.
        solver: default `Auto`.
        tolerance: largest relative defect of a contact.

    Raises:
        ParameterError: naming the argument, the flex or rolling friction of a model, or the name
            that the model does not have.
        ModuleNotFoundError: without mujoco.

    Reference: [WL19] (19), (55); J. J. Moreau (1988).

    >>> import mujoco
    >>> import asperity as asp
    >>> from asperity.mujoco import Scene
    >>> model = mujoco.MjModel.from_xml_string('''
    ... <mujoco><worldbody>
    ...   <geom name="plate" type="plane" size="1 1 .1"/>
    ...   <body pos="0 0 .05"><freejoint/><geom name="puck" type="box" size=".1 .1 .05"/></body>
    ... </worldbody></mujoco>''')
    >>> data = mujoco.MjData(model)
    >>> data.qvel[:2] = 1.0, 1.0
    >>> grooved = asp.FrictionLaw.associated(asp.Ellipse(0.6, 0.2))
    >>> scene = Scene(model, {("plate", "puck"): grooved})
    >>> run = scene.simulate(data, t_end=1.0)
    >>> run.qpos[-1, :2].round(3).tolist()
    [0.103, 0.334]
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        laws: Laws | None = None,
        *,
        starts: Literal["refuse", "project"] = "refuse",
        normal_restitution: float = 0.0,
        rolling: Literal["refuse", "ignore"] = "refuse",
        on_failure: Literal["raise", "record"] = "raise",
        solver: Solver | None = None,
        tolerance: float = 1e-10,
    ) -> None:
        before = set(vars(self))
        self._starts = arrays.choice(starts, "starts", ("refuse", "project"))
        self._on_failure = arrays.choice(on_failure, "on_failure", ("raise", "record"))
        arrays.choice(rolling, "rolling", ("refuse", "ignore"))
        self._rows = rows = RowsModel(model, ignore_rolling=rolling == "ignore")
        self._mj, self._model, self._dt = rows.mj, rows.model, rows.dt
        self._laws = PairLaws(rows, laws, arrays.fraction(normal_restitution, "normal_restitution"))
        self._given: dict[str, Any] = dict(
            laws=None if laws is None else dict(laws),
            starts=starts,
            normal_restitution=normal_restitution,
            rolling=rolling,
            on_failure=on_failure,
            solver=solver,
            tolerance=tolerance,
        )
        self._reader = Reader(rows, self._laws, solver)
        self._tolerance = arrays.positive(tolerance, "tolerance")
        self._extent = float(model.stat.extent)
        self._projector = Projector(rows, exact=_EXACT * self._extent, solver=solver)
        self._adhesion = Adhesion(rows, _EXACT * self._extent)
        self._least_detection = 1e-4 * self._extent
        rows.widen(self._least_detection)
        self._quiet = 0
        self._lock = RLock()
        # How the last step of each data left it.
        self._left: WeakKeyDictionary[mujoco.MjData, _Left] = WeakKeyDictionary()
        # The least velocity that equalities allow.
        self._still = np.zeros(rows.model.nv)
        # Whose step was the last one, and what it solved, if anything.
        self._owner: mujoco.MjData | None = None
        self._last: tuple[_core.TreeStep, StepSolution, Array, Array] | None = None
        m, enable = self._model, self._mj.mjtEnableBit
        self._integrates_more = bool(m.na or m.nhistory or m.nplastic or m.nplugin)
        # Enumerators and options are slow to read.
        self._options, cones = m.opt, self._mj.mjtCone
        self._cones = int(cones.mjCONE_PYRAMIDAL), int(cones.mjCONE_ELLIPTIC)
        self._is_pyramidal = model.opt.cone == cones.mjCONE_PYRAMIDAL
        self._has_energy = bool(m.opt.enableflags & int(enable.mjENBL_ENERGY))
        # All but what subclasses and users have set.
        self._own = {"_own", *vars(self)} - before

    def __reduce__(self) -> tuple[Any, ...]:
        # A subclass may be made of other arguments.
        return _again, (type(self), self._rows.user, self._given), self.__getstate__()

    def __getstate__(self) -> Any:
        return {name: value for name, value in vars(self).items() if name not in self._own}

    @property
    def dt(self) -> float:
        """Time step in s, that of the model."""
        return self._dt

    def __repr__(self) -> str:
        of, name = self._model, type(self).__name__
        return f"<{name}: {of.ngeom} geoms, {of.nv} velocities, dt {self._dt:g} s>"

    @_alone
    def step(self, data: mujoco.MjData) -> SceneStep:
        """Take one step.

        Args:
            data: of the model; its state is advanced.

        Raises:
            ParameterError: if the state is not finite, or inadmissible, see `starts`.
            NoSolutionError, ConvergenceError: naming the contact or joint; the state is as before.
                Also if more than 1e-6 of the model's extent are violated at the end.
        """
        is_new = self._is_new(data)
        if is_new:
            self._rows.check(data)
        if is_new or self._owner is not data:
            self._reader.stepper.forget()
        q, v = before = data.qpos.copy(), data.qvel.copy()
        try:
            if is_new:
                self._start(data)
                q, v = data.qpos.copy(), data.qvel.copy()
            start = self._guided(data, v, is_new=is_new)
            control = self._mj.get_mjcb_control()
            if control is not None:
                control(data.model, data)
            found, solution = self._advance(data, q, v, start)
            guided = self._reader.guidance is not None
            # Where hands crush what is between them, the nearest place for it is far away.
            crushed = guided and solution is not None and solution.status in _CRUSHED
            projected, violation = self._projector.settle(0 if crushed else _PROJECTIONS)
            if violation > _START * self._extent:
                self._refuse_out_of_reach(data)
        except BaseException:
            data.qpos[:], data.qvel[:] = before
            raise
        after = found.velocity
        self._write(data, v, after, found, solution)
        data.qpos[:] = self._projector.data.qpos
        if data.ne:
            data.qvel[:] = self._projector.level(after)
        if self._has_energy:
            data.energy[:] = self._projector.energy(data.qvel)
        places = Places.of(self._mj, data) if self._model.nmocap else None
        self._left[data] = _Left(self._state(data), places, guided)
        self._quiet += 1
        if self._quiet > _QUIET and self._rows.detection > self._least_detection:
            self._quiet = 0
            self._rows.widen(0.5 * self._rows.detection)
        return SceneStep(solution, projected, violation)

    def simulate(
        self, data: mujoco.MjData, *, t_end: float, keep: Sequence[str] = ("qpos", "qvel")
    ) -> SceneRun:
        """Take steps until a time.

        Args:
            data: of the model; its state is advanced.
            t_end: in s, of ``data.time``, to half a step.
            keep: arrays of ``MjData`` that are sampled after every step.

        Raises:
            ParameterError: naming the argument, or as `step`.
            NoSolutionError, ConvergenceError: as `step`.
        """
        self._rows.check(data)
        steps = round((arrays.number(t_end, "t_end") - data.time) / self._dt)
        if steps < 0:
            raise ParameterError("t_end", f"must not be before data.time = {data.time:g}")
        if isinstance(keep, str):
            raise ParameterError("keep", f"must be a sequence of names, as ({keep!r},)")
        for name in keep:
            if not isinstance(getattr(data, str(name), None), np.ndarray):
                raise ParameterError("keep", f"must name arrays of MjData, got {name!r}")
        t = np.empty(steps + 1)
        kept = {name: np.empty((steps + 1, *getattr(data, name).shape)) for name in keep}
        residual = violation = 0.0
        for k in range(steps + 1):
            if k:
                step = self.step(data)
                violation = max(violation, step.violation)
                if step.solution is not None:
                    residual = max(residual, step.solution.residual)
            t[k] = data.time
            for name, samples in kept.items():
                value = getattr(data, name)
                if value.shape != samples.shape[1:]:
                    raise ParameterError("keep", f"must name arrays of one size, not {name!r}")
                samples[k] = value
        return SceneRun(t, kept, residual, violation)

    @_alone
    def problem(self, data: mujoco.MjData) -> SceneProblem:
        """Return the rows of the step from here, without taking it.

        Limits and contacts that stay open are left out.
        """
        self._rows.check(data)
        trial = self._mj.MjData(self._model)
        self._mj.mj_copyData(trial, self._model, data)
        q, v = data.qpos.copy(), data.qvel.copy()
        start = self._guided(data, v, is_new=self._is_new(data))
        found = self._solve(trial, q, v, start)
        layout, near = found.layout(), found.near
        delassus, free, kinds, bounds, keys = self._reader.stepper.problem()
        return SceneProblem(
            delassus=np.reshape(delassus, (len(free), len(free))),
            free_velocity=np.array(free),
            items=np.array(kinds, dtype=np.int64),
            bounds=np.array(bounds),
            keys=np.array(keys, dtype=np.int64),
            laws=tuple(self._laws.laws),
            names=tuple(self._name(trial, Layout(*layout), near, k) for k in range(len(kinds))),
        )

    @_alone
    def contacts(self, data: mujoco.MjData) -> list[SceneContact]:
        """Return the contacts that took part in the last step, closed or about to close.

        Args:
            data: that of the last step, as the scene left it.

        Raises:
            ParameterError: if it is not.
        """
        if self._owner is not data or self._is_new(data):
            raise ParameterError("data", "must be as the scene's last step left it")
        if self._last is None:
            return []
        found, solution, position, frames = self._last
        layout, contacts, force, gaps = Layout(*found.layout()), [], found.forces, found.gaps
        for place, k in enumerate(np.flatnonzero(found.near).tolist()):
            contact, item = k - layout.limits, layout.begin + place
            if contact < 0:
                continue
            row, number = layout.unilateral[k], layout.contacts[contact]
            pair = one, other = layout.pairs[contact]
            dimension = self._laws.dimension(pair)
            frame, parts = frames[number].reshape(3, 3), force[row : row + 4]
            acting = 1 + min(dimension, 2)
            contacts.append(
                SceneContact(
                    geoms=(self._rows.names[one], self._rows.names[other]),
                    position=position[number],
                    normal=frame[0],
                    gap=float(gaps[k]),
                    force=parts[:acting] @ frame[:acting],
                    torque=float(parts[3]) if dimension == 3 else 0.0,
                    phase=Phase(int(solution.phase[item])),
                    ambiguous=bool(solution.ambiguous_items[item]),
                )
            )
        return contacts

    @_alone
    def project(self, data: mujoco.MjData) -> Projection:
        """Move a state, by as little as possible in M, to where gaps, limits and equalities hold.

        Raises:
            NoSolutionError: if they cannot, to 1e-6 of the model's extent.
        """
        self._rows.check(data)
        self._left.pop(data, None)
        ahead = self._projector
        ahead.place(data)
        violations = ahead.violations(_EXACT * self._extent)
        ahead.settle(_PROJECTIONS)
        left = ahead.violations(_START * self._extent)
        if left:
            raise NoSolutionError(f"the state cannot be projected: {_listed(left)} are left")
        change = np.zeros(self._model.nv)
        self._mj.mj_differentiatePos(self._model, change, 1.0, data.qpos, ahead.data.qpos)
        data.qpos[:] = ahead.data.qpos
        return Projection(violations, float(np.abs(change).max(initial=0.0)))

    def _start(self, data: mujoco.MjData) -> None:
        """Refuse or project a state that the scene did not leave."""
        self._projector.place(data)
        violations = self._projector.violations(_START * self._extent)
        if violations and self._starts == "project":
            self.project(data)
        elif violations:
            raise ParameterError(
                "data",
                f"must be admissible, it violates {_listed(violations)}: scene.project(data) or "
                'starts="project" moves it',
            )
        if self._projector.data.ne:
            # What equalities do not allow would be reflected.
            data.qvel[:] = self._projector.level(data.qvel)

    def _guided(self, data: mujoco.MjData, v: Array, *, is_new: bool) -> Array:
        """Have mocap bodies move to where they are now; return v with that of equalities."""
        self._reader.guidance = self._projector.reader.guidance = None
        self._still = np.zeros_like(v)
        left = None if is_new else self._left[data]
        if left is None or left.places is None:
            return v
        places = Places.of(self._mj, data)
        moves = any((a != b).any() for a, b in zip(places, left.places, strict=True))
        if not (moves or left.moved):
            return v
        ahead = self._projector
        ahead.place(data)
        if moves:
            rates = ahead.rates(self._dt)
            guidance = Guidance.between(self._mj, left.places, places, self._dt, rates)
            ahead.guide(guidance)
            self._reader.guidance = guidance
        if not ahead.data.ne:
            return v
        self._still = ahead.level(self._still)
        return ahead.level(v)

    def _refuse_out_of_reach(self, data: mujoco.MjData) -> None:
        """Refuse places that cannot be projected."""
        if self._reader.guidance is not None:
            why = "mocap bodies go where the others cannot follow"
        elif self._on_failure == "raise":
            why = "the step ends where gaps, limits and equalities cannot hold"
        else:
            return
        left = self._projector.violations(_START * self._extent)
        raise NoSolutionError(f"{why}, at {data.time:g} s: {_listed(left)} are left")

    def _is_new(self, data: mujoco.MjData) -> bool:
        arrays.of_kind(data, "data", self._mj.MjData, "a mujoco.MjData")
        left = self._left.get(data)
        return left is None or left.state != self._state(data)

    def _state(self, data: mujoco.MjData) -> tuple[float, bytes]:
        state = data.qpos.tobytes() + data.qvel.tobytes()
        # A reset may leave all but the time.
        return data.time, state + data.eq_active.tobytes() if self._model.neq else state

    def _advance(
        self, data: mujoco.MjData, q: Array, v: Array, start: Array
    ) -> tuple[_core.TreeStep, StepSolution | None]:
        """Solve the step, from contacts that are found in time, and find the rows at its end."""
        while True:
            found = self._solve(data, q, v, start)
            solution = None if found.step is None else StepSolution(found.step)
            if self._on_failure == "raise" and solution is not None and not solution.converged:
                raise self._failure(data, found, solution)
            after = found.velocity
            self._projector.advance(data, after, 0.5 * self._dt)
            distance = self._came(after)
            if distance <= self._rows.detection:
                return found, solution
            self._quiet = 0
            self._rows.widen(2.0 * distance)

    def _solve(self, data: mujoco.MjData, q: Array, v: Array, start: Array) -> _core.TreeStep:
        """Solve the step with the rows at the midpoint; `start` is v with that of equalities."""
        mj, m, reader = self._mj, self._model, self._reader
        data.qpos[:] = q
        mj.mj_integratePos(m, data.qpos, v, 0.5 * self._dt)
        data.qvel[:] = v
        if reader.guidance is None:
            mj.mj_fwdPosition(m, data)
        else:
            places = data.mocap_pos.copy(), data.mocap_quat.copy()
            data.mocap_pos[:], data.mocap_quat[:] = reader.guidance.middle
            mj.mj_fwdPosition(m, data)
            data.mocap_pos[:], data.mocap_quat[:] = places
        if self._rows.complete(data):
            mj.mj_makeConstraint(m, data)
        if self._rows.is_damped:
            self._rows.factor(data)
        reader.read(data)
        if self._adhesion:
            self._adhesion.look(data)
        stepper = reader.stepper
        reader.factor(data)
        self._accelerate(data, v)
        # Forces at the mean velocity, or a tumbling body would gain energy.
        self._accelerate(data, v)
        found = self._percussions(data, start)
        if found.step is not None:
            # Percussions are part of it, or stiff joints and stuck feet would lend energy.
            data.qvel[:] = 0.5 * (v + found.velocity)
            self._accelerate(data, v)
            if not stepper.was_from(self._tolerance):
                found = self._percussions(data, start)
        return found

    def _accelerate(self, data: mujoco.MjData, v: Array) -> None:
        """Find the velocities without percussions, by forces at the one of `data`.

        That of `data` becomes their mean with v.
        """
        mj, m = self._mj, self._model
        mj.mj_fwdVelocity(m, data)
        mj.mj_fwdActuation(m, data)
        if self._adhesion:
            self._adhesion.correct(data)
        mj.mj_fwdAcceleration(m, data)
        # Damping is that of v⁺, MuJoCo's that of the velocity here.
        damping = self._rows.damping if self._rows.is_damped else None
        stepper = self._reader.stepper
        if not stepper.accelerate(data.qacc_smooth, v, data.qvel, self._dt, damping):
            forces = ("qfrc_applied", "xfrc_applied", "ctrl", "qfrc_actuator", "qfrc_passive")
            wrong = [name for name in forces if not np.isfinite(getattr(data, name)).all()]
            why = (
                f"{wrong[0]} is not finite"
                if wrong
                else "forces are too large: try a smaller timestep"
            )
            raise ParameterError(
                "data", f"must have finite velocities after a step, at {data.time:g} s {why}"
            )

    def _percussions(self, data: mujoco.MjData, v: Array) -> _core.TreeStep:
        """Solve the step from the velocities without percussions and those before."""
        stepper, settings = self._reader.stepper, (self._dt, _EXACT, self._tolerance)
        try:
            found = stepper.step(v, *settings)
        except ParameterError as error:
            item = stepper.refused()
            if item is None:
                raise
            name = self._name(data, self._reader.layout, stepper.near(), item)
            message = f"with drilling (condim 4) need bodies that drill and slide: {name}"
            raise ParameterError("laws", message) from error
        converged = Status.CONVERGED.value
        if found.step is not None and found.step.status != converged:
            # Percussions of the step before may be a bad start.
            stepper.forget()
            found = stepper.step(v, *settings)
        if data.ne and found.step is not None:
            # Anchors that move by what their paths curve may jam contacts, or drive them: they
            # rest then.
            failed = found.step.status != converged
            if failed or stepper.gains_energy(v, self._tolerance):
                rests = stepper.step(self._still, *settings)
                if rests.step is None or rests.step.status == converged or not failed:
                    return rests
        return found

    def _came(self, after: Array) -> float:
        """Return from how far contacts came that end inside."""
        least = _EXACT * self._extent
        if self._projector.depth <= least:
            return 0.0
        return self._projector.reader.stepper.came(least, after, 0.5 * self._dt)

    def _write(
        self,
        data: mujoco.MjData,
        v: Array,
        after: Array,
        found: _core.TreeStep,
        solution: StepSolution | None,
    ) -> None:
        """Leave in `data` what MuJoCo would: velocities, activations, time, forces and sensors."""
        mj, m, h = self._mj, self._model, self._dt
        data.qacc[:] = (after - v) / h
        self._owner, self._last, contacts = data, None, data.contact
        data.qfrc_constraint[:] = found.generalised
        if solution is not None:
            self._last = found, solution, contacts.pos.copy(), contacts.frame.copy()
        if self._rows.is_damped:
            mj.mj_factorM(m, data)
        if self._integrates_more:
            middle = data.qpos.copy()
            data.qvel[:] = v
            mj.mj_Euler(m, data)
            data.qpos[:] = middle
        else:
            data.time += h
        data.qvel[:] = after
        if self._is_pyramidal and data.ncon:
            self._options.cone, round_cone = self._cones
            mj.mj_makeConstraint(m, data)
            self._options.cone = round_cone
            contacts = data.contact
            edges = contacts.efc_address, contacts.dim, contacts.friction
            self._rows.refuse_overflow(data)
            data.efc_force[:] = self._reader.stepper.pyramids(found, data.nefc, *edges)
        else:
            data.efc_force[:] = 0.0 if solution is None else found.forces
        mj.mj_fwdVelocity(m, data)
        # Or sensors would read the accelerations of an earlier step.
        data.flg_rnepost = False
        if m.nsensor:
            for sense in (mj.mj_sensorPos, mj.mj_sensorVel, mj.mj_sensorAcc):
                sense(self._rows.user, data)

    def _name(self, data: mujoco.MjData, layout: Layout, near: NDArray[np.bool_], item: int) -> str:
        if item < layout.begin:
            return self._rows.item_name(data, item, None)
        place = int(np.flatnonzero(near)[item - layout.begin])
        contact = place - layout.limits
        if contact >= 0:
            return self._rows.item_name(data, 0, layout.pairs[contact])
        return self._rows.item_name(data, int(layout.unilateral[place]), None)

    def _failure(
        self, data: mujoco.MjData, found: _core.TreeStep, solution: StepSolution
    ) -> NoSolutionError | ConvergenceError:
        name = self._name(data, Layout(*found.layout()), found.near, solution.worst_item)
        where = f"{name} at {data.time:g} s"
        message = f"{solution.status.message}: {where}"
        if solution.status is Status.NO_SOLUTION:
            return NoSolutionError(message, residual=solution.residual)
        return ConvergenceError(message, residual=solution.residual, advice=solution.status.advice)


def _again(kind: type[Scene], model: mujoco.MjModel, given: dict[str, Any]) -> Scene:
    """Return a scene of this class that has taken no step."""
    scene = Scene.__new__(kind)
    Scene.__init__(scene, model, **given)
    return scene


def _listed(violations: dict[str, float]) -> str:
    """Return the largest violations in words."""
    worst = sorted(violations.items(), key=lambda entry: -entry[1])[:3]
    return ", ".join(f"{name} by {depth:.3g} (m or rad)" for name, depth in worst)
