"""Compiled core of asperity. Private: use the classes of `asperity`.

Every array is C-contiguous float64 and fully shaped: n points of dimension p are ``(n, p)``.
The core raises the exceptions of asperity.errors.
"""

from collections.abc import Callable, Sequence
from typing import Any, TypeAlias, final

import numpy as np
from numpy.typing import NDArray

_Array: TypeAlias = NDArray[np.float64]

__all__ = [
    "CallbackSystem",
    "Law",
    "LinearSystem",
    "Problem",
    "Set",
    "Solver",
    "__version__",
    "build_profile",
    "simulate",
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
    def ellipsoid(semi_axes: _Array) -> Set: ...
    @staticmethod
    def ellipse_from_intercepts(n1: float, n2: float, nu: float) -> tuple[float, float, float]: ...
    @staticmethod
    def superellipsoid(semi_axes: _Array, exponent: float) -> Set: ...
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

@final
class Law:
    def __new__(cls, reservoir: Set, direction: Set) -> Law: ...
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
        delassus: _Array,
        free_velocity: _Array,
        laws: Sequence[Law],
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
    ) -> dict[str, Any]: ...
    def residual(self, percussion: _Array) -> tuple[float, int]: ...
    def solutions(self, contact: int, percussion: _Array) -> list[dict[str, Any]]: ...

@final
class LinearSystem:
    def __new__(
        cls,
        mass: _Array,
        stiffness: _Array,
        damping: _Array,
        force: _Array,
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
    q0: _Array,
    u0: _Array,
    solver: Solver,
    tolerance: float,
    save_every: int,
    until_rest: bool,
    raise_on_failure: bool,
    progress: Callable[[int, int], object] | None,
) -> tuple[dict[str, Any], BaseException | None]: ...
