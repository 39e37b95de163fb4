"""Compiled core of asperity. Private: use the classes of `asperity`.

Every array is C-contiguous float64 and fully shaped: n points of dimension p are ``(n, p)``.
The core raises the exceptions of asperity.errors.
"""

from collections.abc import Callable, Sequence
from typing import Any, TypeAlias, final

import numpy as np
from numpy.typing import NDArray

_Array: TypeAlias = NDArray[np.float64]
_Short: TypeAlias = NDArray[np.int32]
# Row starts, columns and values of a CSR matrix.
_Indices: TypeAlias = NDArray[np.int64]
_Triple: TypeAlias = tuple[_Indices, _Indices, _Array]
# G, sparse.
_Sparse: TypeAlias = _Triple
# M, Wᵀ (rows × n) and G if it is known.
_Factored: TypeAlias = tuple[_Triple, _Triple, _Triple | None]
# Whether it holds, whether that is exact, tolerance, defect, witness points (k, p).
_Verdict: TypeAlias = tuple[bool, bool, float, float, _Array | None]

__all__ = [
    "CallbackSystem",
    "FrictionFactor",
    "Law",
    "LinearSystem",
    "LinearVariants",
    "Outcome",
    "Problem",
    "RigidBodies",
    "Set",
    "Signal",
    "Solver",
    "Step",
    "Stepper",
    "TreeStep",
    "TreeStepper",
    "__version__",
    "advance",
    "build_profile",
    "calls_python",
    "cone_polar",
    "cone_projection",
    "constraint_forces",
    "deepest_overlap",
    "evaluate",
    "flow_law",
    "integrate",
    "integrate_many",
    "simulate",
    "simulate_many",
    "star_shape",
]

__version__: str
build_profile: str

@final
class Set:
    @staticmethod
    def ball(dimension: int, radius: float) -> Set: ...
    @staticmethod
    def cuboid(lower: _Array, upper: _Array) -> Set: ...
    @staticmethod
    def ellipsoid(semi_axes: _Array, axes: _Array | None = None) -> Set: ...
    @staticmethod
    def ellipse_from_intercepts(n1: float, n2: float, nu: float) -> tuple[float, float, float]: ...
    @staticmethod
    def superellipsoid(semi_axes: _Array, exponent: float) -> Set: ...
    @staticmethod
    def capped_rectangle(a: float, b: float, cap: float) -> Set: ...
    @staticmethod
    def wedge_asperity(mu: float, beta: float) -> Set: ...
    @staticmethod
    def polygon(vertices: _Array) -> Set: ...
    @staticmethod
    def polar_curve(angle: _Array, radius: _Array) -> Set: ...
    @staticmethod
    def support_curve(angle: _Array, support: _Array) -> Set: ...
    @staticmethod
    def coulomb_contensou(mu: float, pressure: str) -> Set: ...
    @staticmethod
    def intersection(sets: Sequence[Set]) -> Set: ...
    @staticmethod
    def union(sets: Sequence[Set]) -> Set: ...
    @staticmethod
    def minkowski_sum(sets: Sequence[Set]) -> Set: ...
    def rotated(self, angle: float) -> Set: ...
    def scaled(self, factor: float) -> Set: ...
    def mapped(self, matrix: _Array) -> Set: ...
    @property
    def dimension(self) -> int: ...
    @property
    def is_convex(self) -> bool: ...
    def gauge(self, x: _Array) -> _Array: ...
    def gauge_gradient(self, x: _Array) -> _Array: ...
    def support(self, y: _Array) -> _Array: ...
    def support_point(self, y: _Array) -> _Array: ...
    def support_hessian(self, y: _Array) -> _Array: ...
    def project(self, z: _Array) -> _Array: ...
    def normal_cone(self, x: _Array, tolerance: float) -> _Array | None: ...
    def tangent_cone(self, x: _Array, tolerance: float) -> list[_Array] | None: ...
    def convexity(self) -> _Verdict: ...
    def strict_convexity(self) -> _Verdict: ...
    def symmetry(self) -> _Verdict: ...
    def scale_inside(self, outer: Set) -> tuple[float, _Array]: ...

def cone_projection(generators: _Array, y: _Array) -> _Array: ...
def cone_polar(generators: _Array) -> _Array: ...
def star_shape(vertices: _Array) -> _Verdict: ...

@final
class Law:
    def __new__(
        cls,
        reservoir: Set,
        direction: Set,
        rate: tuple[str, float, float, float, float] | None,
    ) -> Law: ...
    def with_direction(self, direction: Set) -> Law: ...
    @property
    def dimension(self) -> int: ...
    @property
    def direction_scale(self) -> float: ...
    @property
    def is_associated(self) -> bool: ...
    @property
    def alpha_min(self) -> float: ...
    def force(self, slip: _Array, normal_force: _Array) -> _Array: ...
    def slip_direction(self, force: _Array, normal_force: _Array, tolerance: float) -> _Array: ...
    def jacobian(self, slip: _Array, normal_force: _Array) -> _Array: ...
    def dissipation(self, slip: _Array, normal_force: _Array) -> _Array: ...
    def associativity(self) -> _Verdict: ...
    def collinearity(self) -> _Verdict: ...
    def dissipativity(self) -> _Verdict: ...
    def monotonicity(self) -> _Verdict: ...

def flow_law(
    phi: _Array, force: _Array, closure_tolerance: float, convexity_tolerance: float
) -> tuple[_Array, _Array, _Array, _Array, tuple[float, float, float, float]]: ...

@final
class Solver:
    def __new__(cls, name: str, **options: float | Sequence[str] | None) -> Solver: ...
    @staticmethod
    def steps() -> list[str]: ...

@final
class Outcome:
    @property
    def percussion(self) -> _Array: ...
    @property
    def velocity(self) -> _Array: ...
    @property
    def phase(self) -> NDArray[np.int64]: ...
    @property
    def ambiguous_contacts(self) -> NDArray[np.bool_]: ...
    @property
    def converged(self) -> bool: ...
    @property
    def status(self) -> str: ...
    @property
    def residual(self) -> float: ...
    @property
    def iterations(self) -> int: ...
    @property
    def worst_contact(self) -> int: ...
    @property
    def stages(self) -> list[tuple[str, int, int, float]]: ...
    @property
    def islands(self) -> list[tuple[list[int], str, float, int]]: ...
    @property
    def infeasibility(self) -> dict[str, Any] | None: ...
    @property
    def certificate(self) -> dict[str, Any]: ...

@final
class Problem:
    def __new__(
        cls,
        delassus: _Array | _Sparse | _Factored,
        free_velocity: _Array,
        laws: Sequence[Law | None],
        normal_force: Sequence[float | None],
        normal_restitution: _Array,
        tangential_restitution: _Array,
        initial_velocity: _Array,
    ) -> Problem: ...
    def solve(
        self,
        solver: Solver,
        tolerance: float,
        time_limit: float | None,
        start: tuple[_Array, Sequence[int], _Array] | None,
        measure: str,
    ) -> Outcome: ...
    def residual(self, percussion: _Array) -> tuple[float, int]: ...
    def natural_map(self, percussion: _Array) -> float: ...
    def certificate(self, percussion: _Array) -> dict[str, Any]: ...
    def spectrum(self) -> tuple[float, float]: ...
    def solutions(self, contact: int, percussion: _Array) -> list[dict[str, Any]]: ...

@final
class Stepper:
    def __new__(cls, laws: Sequence[Law], solver: Solver) -> Stepper: ...
    def step(
        self,
        delassus: Any,
        free_velocity: _Array,
        kinds: NDArray[np.int64],
        bounds: _Array | None,
        keys: NDArray[np.int64] | None,
        tolerance: float,
        time_limit: float | None,
    ) -> Step: ...
    def forget(self) -> None: ...
    def certificate(self) -> dict[str, Any]: ...
    def contact_problem(self) -> dict[str, Any]: ...

@final
class Step:
    @property
    def percussion(self) -> _Array: ...
    @property
    def velocity(self) -> _Array: ...
    @property
    def phase(self) -> NDArray[np.int64]: ...
    @property
    def ambiguous_items(self) -> NDArray[np.bool_]: ...
    @property
    def status(self) -> str: ...
    @property
    def residual(self) -> float: ...
    @property
    def mismatch(self) -> float: ...
    @property
    def iterations(self) -> int: ...
    @property
    def worst_item(self) -> int: ...

_Layout: TypeAlias = tuple[
    int, int, NDArray[np.int64], NDArray[np.int64], Sequence[tuple[int, int]]
]

@final
class TreeStepper:
    def __new__(
        cls,
        laws: Sequence[Law] | None,
        solver: Solver,
        starts: NDArray[np.int64],
        ancestors: NDArray[np.int64],
        trees: NDArray[np.int64],
        geoms: Sequence[tuple[int, bool, bool, float]],
    ) -> TreeStepper: ...
    def is_listed(self, counts: tuple[int, int, int], addresses: _Short, geoms: _Short) -> bool: ...
    def learn(
        self,
        pair: tuple[int, int],
        kind: int,
        restitution: float,
        axis: tuple[Sequence[float], int | None, bool, float] | None,
        flat: int | None,
    ) -> None: ...
    def list(
        self,
        counts: tuple[int, int, int],
        addresses: _Short,
        geoms: _Short,
        margins: _Array,
        detection: float,
        limits: _Array | None,
        positions: _Array,
        places: _Array,
        rotations: _Array,
    ) -> Sequence[int]: ...
    def depth(
        self, geoms: _Short, distances: _Array, margins: _Array, detection: float
    ) -> float: ...
    def layout(self) -> _Layout: ...
    def place(
        self,
        jacobian: _Array,
        sparsity: tuple[_Short, _Short, _Short] | None,
        positions: _Array,
        distances: _Array,
        dry: _Array,
        h: float,
    ) -> float: ...
    def factor(self, values: _Array) -> None: ...
    def turn(
        self, frames: _Array, geoms: _Array, bodies: _Array, factors: _Array | None
    ) -> None: ...
    def drive(self, velocities: _Array) -> None: ...
    def accelerate(
        self,
        acceleration: _Array,
        before: _Array,
        velocities: _Array,
        h: float,
        damping: _Array | None,
    ) -> bool: ...
    def step(self, before: _Array, h: float, exact: float, tolerance: float) -> TreeStep: ...
    def was_from(self, part: float) -> bool: ...
    def gains_energy(self, before: _Array, part: float) -> bool: ...
    def pyramids(
        self,
        step: TreeStep,
        count: int,
        addresses: _Short,
        dimensions: _Short,
        friction: _Array,
    ) -> _Array: ...
    def least_change(self, rows: NDArray[np.int64], before: _Array, tolerance: float) -> _Array: ...
    def close(self, equalities: _Array, limit: float, tolerance: float) -> _Array: ...
    def came(self, depth: float, after: _Array, half: float) -> float: ...
    def refused(self) -> int | None: ...
    def near(self) -> NDArray[np.bool_]: ...
    def forget(self) -> None: ...
    def gaps(self) -> _Array: ...
    def row_velocities(self, rows: NDArray[np.int64], velocities: _Array) -> _Array: ...
    def moves(self) -> NDArray[np.bool_]: ...
    def problem(
        self,
    ) -> tuple[Sequence[float], Sequence[float], Sequence[int], Sequence[float], Sequence[int]]: ...

@final
class TreeStep:
    @property
    def step(self) -> Step | None: ...
    def layout(self) -> _Layout: ...
    @property
    def velocity(self) -> _Array: ...
    @property
    def near(self) -> NDArray[np.bool_]: ...
    @property
    def gaps(self) -> _Array: ...
    @property
    def forces(self) -> _Array: ...
    @property
    def generalised(self) -> _Array: ...

@final
class LinearSystem:
    def __new__(
        cls,
        mass: _Array,
        stiffness: _Array,
        damping: _Array,
        force: _Array,
        contacts: Sequence[dict[str, Any]],
        constraints: tuple[_Array, _Array] | None = None,
    ) -> LinearSystem: ...

@final
class LinearVariants:
    def __new__(
        cls,
        mass: _Array,
        stiffness: _Array,
        damping: _Array,
        force: _Array,
        contacts: Sequence[dict[str, Any]],
        laws: Sequence[str | None],
        places: Sequence[tuple[str, int, int, list[str]]],
        values: _Array,
        replaced: Sequence[tuple[int, Sequence[Law]]],
    ) -> LinearVariants: ...

@final
class CallbackSystem:
    def __new__(
        cls,
        system: object,
        blocks: Sequence[int],
        touched: Sequence[Sequence[int]] | None,
        rotations: Sequence[int],
        coordinates: int | None,
        constraints: int,
        constant: tuple[bool, bool],
        contacts: Sequence[dict[str, Any]],
    ) -> CallbackSystem: ...

@final
class Signal:
    @staticmethod
    def linear(times: _Array, values: _Array, periodic: bool) -> Signal: ...
    @staticmethod
    def cubic(knots: _Array, coefficients: _Array, last: _Array, periodic: bool) -> Signal: ...
    @staticmethod
    def sine(frequency: float, amplitude: _Array, phase: _Array, offset: _Array) -> Signal: ...
    @property
    def period(self) -> float | None: ...
    @property
    def jumps(self) -> bool: ...
    def values(self, t: _Array, order: int) -> _Array: ...
    def integral(self, start: float, end: float) -> _Array: ...
    def breaks(self, start: float, end: float, most: int) -> list[tuple[float, bool]]: ...

@final
class FrictionFactor:
    def __new__(cls, given: Any) -> FrictionFactor: ...
    def at(self, x1: float, x2: float) -> float: ...

# Places and vectors have two entries in planar systems where they go in, always three where they
# come out.
@final
class RigidBodies:
    def __new__(
        cls,
        planar: bool,
        mass: _Array,
        inertia: _Array,
        load: _Array,
        timed_loads: Sequence[tuple[int, Any, Any]],
        pairs: Sequence[dict[str, Any]],
        springs: Sequence[dict[str, Any]],
        joints: Sequence[dict[str, Any]],
        gravity: _Array,
        q0: _Array,
    ) -> RigidBodies: ...
    def advance(self, q: _Array, u: _Array, dt: float) -> _Array: ...
    def energy(self, t: _Array, q: _Array, u: _Array) -> _Array: ...
    def momentum(self, u: _Array) -> _Array: ...
    def angular_momentum(self, q: _Array, u: _Array, about: _Array) -> _Array: ...
    def contact_geometry(self, t: _Array, q: _Array) -> tuple[_Array, _Array]: ...
    def joint_reactions(
        self, t: _Array, dt: float, q: _Array, u: _Array, contacts: _Array
    ) -> _Array: ...
    @property
    def depends_on_time(self) -> bool: ...

def deepest_overlap(
    system: LinearSystem | CallbackSystem | RigidBodies, t: float, q: _Array
) -> tuple[int, float] | None: ...
def evaluate(
    system: LinearSystem | CallbackSystem | RigidBodies, t: float, q: _Array, u: _Array
) -> dict[str, Any]: ...
def advance(
    system: LinearSystem | CallbackSystem | RigidBodies, q: _Array, u: _Array, dt: float
) -> _Array: ...
def constraint_forces(
    system: LinearSystem | CallbackSystem | RigidBodies,
    times: tuple[float, float],
    q: _Array,
    u: _Array,
    contacts: _Array,
) -> _Array: ...
def calls_python(system: LinearSystem | CallbackSystem | RigidBodies) -> bool: ...
def simulate(
    system: LinearSystem | CallbackSystem | RigidBodies,
    dt: float,
    steps: int,
    clock: tuple[float, int, float | None],
    q0: _Array,
    u0: _Array,
    contacts: _Array,
    momenta: _Array,
    solver: Solver,
    tolerance: float,
    save_every: int,
    until_rest: bool,
    raise_on_failure: bool,
    progress: Callable[[int, int], object] | None,
) -> tuple[dict[str, Any], BaseException | None]: ...

_Runs: TypeAlias = tuple[
    list[LinearSystem | CallbackSystem | RigidBodies],
    LinearVariants | None,
    NDArray[np.int64] | None,
    _Array,
    _Array,
    int,
]
_Kept: TypeAlias = tuple[int | None, float, list[bool], tuple[_Array, float, float] | None]

def simulate_many(
    runs: _Runs,
    dt: float,
    steps: int,
    solver: Solver,
    tolerance: float,
    until_rest: bool,
    kept: _Kept,
    threads: int | None,
    lanes: bool,
    progress: Callable[[int, int], object] | None,
) -> tuple[dict[str, Any], BaseException | None]: ...
def integrate_many(
    runs: _Runs,
    t_end: float,
    tolerance: float,
    sample: float | None,
    max_step: float | None,
    stop: tuple[_Array, float, float] | None,
    max_events: int,
    kept: _Kept,
    threads: int | None,
    progress: Callable[[int, int], object] | None,
) -> tuple[dict[str, Any], BaseException | None]: ...
def integrate(
    system: LinearSystem | CallbackSystem | RigidBodies,
    times: tuple[float, float],
    q0: _Array,
    u0: _Array,
    tolerance: float,
    sample: float | None,
    max_step: float | None,
    section: tuple[_Array, float, float] | None,
    max_events: int,
    progress: Callable[[float, float], object] | None,
) -> tuple[dict[str, Any], BaseException | None]: ...
