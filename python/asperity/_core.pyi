"""Compiled core of asperity. Private: use the classes of `asperity`.

Every array is C-contiguous float64 and fully shaped: ``n`` points of dimension ``p`` are ``(n, p)``.
The core raises the exceptions of `asperity.errors`.
"""

from collections.abc import Callable, Sequence
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

__version__: str
build_profile: str

@final
class Set:
    @staticmethod
    def ball(dimension: int, radius: float) -> Set: ...
    @staticmethod
    def cuboid(lower: Array, upper: Array) -> Set: ...
    @staticmethod
    def ellipsoid(semi_axes: Array) -> Set: ...
    @staticmethod
    def ellipse_from_intercepts(n1: float, n2: float, nu: float) -> tuple[float, float, float]: ...
    @staticmethod
    def superellipsoid(semi_axes: Array, exponent: float) -> Set: ...
    def rotated(self, angle: float) -> Set: ...
    def scaled(self, factor: float) -> Set: ...
    def mapped(self, matrix: Array) -> Set: ...
    @property
    def dimension(self) -> int: ...
    @property
    def is_convex(self) -> bool: ...
    def gauge(self, x: Array) -> Array: ...
    def gauge_gradient(self, x: Array) -> Array: ...
    def support(self, y: Array) -> Array: ...
    def support_point(self, y: Array) -> Array: ...
    def support_hessian(self, y: Array) -> Array: ...
    def project(self, z: Array) -> Array: ...
    def normal_cone(self, x: Array, tolerance: float) -> Array | None: ...

@final
class Law:
    def __new__(cls, reservoir: Set, direction: Set) -> Law: ...
    @property
    def dimension(self) -> int: ...
    @property
    def direction_scale(self) -> float: ...
    @property
    def alpha_min(self) -> float: ...
    def force(self, slip: Array, normal_force: Array) -> Array: ...
    def slip_direction(self, force: Array, normal_force: Array, tolerance: float) -> Array: ...
    def jacobian(self, slip: Array, normal_force: Array) -> Array: ...
    def dissipation(self, slip: Array, normal_force: Array) -> Array: ...

@final
class Solver:
    @staticmethod
    def exact(max_sweeps: int) -> Solver: ...
    @staticmethod
    def prox_jacobi(r: float | None, max_iterations: int) -> Solver: ...
    @staticmethod
    def prox_gauss_seidel(r: float | None, max_iterations: int) -> Solver: ...

@final
class Problem:
    def __new__(
        cls,
        delassus: Array,
        free_velocity: Array,
        laws: Sequence[Law],
        normal_force: Sequence[float | None],
        normal_restitution: Array,
        tangential_restitution: Array,
        initial_velocity: Array,
    ) -> Problem: ...
    def solve(
        self,
        solver: Solver,
        tolerance: float,
        time_limit: float | None,
        start: tuple[Array, Sequence[int], Array] | None,
    ) -> dict[str, Any]: ...
    def residual(self, percussion: Array) -> tuple[float, int]: ...
    def solutions(self, contact: int, percussion: Array) -> list[dict[str, Any]]: ...

@final
class LinearSystem:
    def __new__(
        cls,
        mass: Array,
        stiffness: Array,
        damping: Array,
        force: Array,
        contacts: Sequence[dict[str, Any]],
    ) -> LinearSystem: ...

@final
class CallbackSystem:
    def __new__(
        cls, system: object, dof: int, contacts: Sequence[dict[str, Any]]
    ) -> CallbackSystem: ...

def simulate(
    system: LinearSystem | CallbackSystem,
    dt: float,
    steps: int,
    q0: Array,
    u0: Array,
    solver: Solver,
    tolerance: float,
    save_every: int,
    until_rest: bool,
    raise_on_failure: bool,
    progress: Callable[[int, int], object] | None,
) -> tuple[dict[str, Any], BaseException | None]: ...
