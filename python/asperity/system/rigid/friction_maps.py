"""Friction that depends on the place: factors over a plane."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import KW_ONLY
from typing import Annotated, Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import Given, Positive, Record, Vector
from asperity.errors import ParameterError

_Polygons: TypeAlias = tuple[tuple[tuple[tuple[float, float], ...], float], ...]


def _polygons(given: Any, argument: str) -> _Polygons:
    polygons = []
    for part in arrays.several(given, argument):
        if not isinstance(part, tuple | list) or len(part) != 2:
            raise ParameterError(argument, f"must be pairs of vertices and a factor, got {part!r}")
        vertices = arrays.array(part[0], argument, (None, 2))
        if len(vertices) < 3:
            raise ParameterError(argument, f"must have 3 vertices at least, got {len(vertices)}")
        corners = tuple((float(x1), float(x2)) for x1, x2 in vertices)
        polygons.append((corners, arrays.positive(part[1], argument)))
    return tuple(polygons)


def _factors(given: Any, argument: str) -> Array:
    factors = arrays.array(given, argument, (None, None))
    if not (factors > 0.0).all():
        raise ParameterError(argument, f"must be positive, got {factors.min()}")
    return factors


class FrictionRegions(Record):
    """Regions of a plane in each of which friction is multiplied by a factor: ice, a wet patch.

    −λ ∈ φ λ_N C where the contact point is in the region with the factor φ. `integrate` stops at
    every border that a closed contact crosses, with an event ``"border"``.

    Args:
        regions: pairs of the vertices of a polygon in m, shape ``(n, 2)``, and its factor φ > 0; of
            polygons that overlap the later one counts, and where one covers itself twice it is
            left open. Coordinates are those along the plane's e₁ and e₂ from its point.
        elsewhere: the factor outside of all polygons.

    Raises:
        DimensionError, ParameterError: naming the argument.

    A puck slides from a floor with μ = 0.5 onto ice with 0.2 and stops where its energy is used up:

    >>> from asperity import (
    ...     Body, FrictionLaw, FrictionRegions, Plane, PointPlane, RigidBodies, integrate
    ... )
    >>> ice = FrictionRegions([([(0.1, -1.0), (9.0, -1.0), (9.0, 1.0), (0.1, 1.0)], 0.4)])
    >>> puck = Body.ball(1.0, radius=0.1, velocity=(1.5, 0.0, 0.0))
    >>> floor = PointPlane(
    ...     0,
    ...     point=(0.0, 0.0, 0.0),
    ...     plane=Plane(friction_factor=ice),
    ...     law=FrictionLaw.isotropic(0.5),
    ... )
    >>> motion = integrate(RigidBodies([puck], pairs=[floor]), t_end=2.0)
    >>> left = 1.5**2 / 2 - 0.5 * 9.81 * 0.1
    >>> bool(abs(motion.q[-1, 0] - 0.1 - left / (0.2 * 9.81)) < 1e-9)
    True
    """

    regions: Annotated[_Polygons, _polygons]
    _: KW_ONLY
    elsewhere: Positive = 1.0


class FrictionRaster(Record):
    """Factors of friction at the nodes of a rectangular grid, interpolated bilinearly between them.

    Beyond the grid the factors of its edge hold on.

    Args:
        factors: φ > 0 at the nodes, shape ``(n₁, n₂)``.
        x1: nodes along the plane's e₁ from its point in m, ascending, shape ``(n₁,)``.
        x2: nodes along e₂ in m, ascending, shape ``(n₂,)``.

    Raises:
        DimensionError, ParameterError: naming the argument.

    >>> import numpy as np
    >>> from asperity import FrictionRaster, Plane
    >>> x = np.linspace(0.0, 2.0, 21)
    >>> worn = FrictionRaster(np.exp(-np.hypot(*np.meshgrid(x, x))), x1=x, x2=x)
    >>> Plane(friction_factor=worn).friction_factor.factors.shape
    (21, 21)
    """

    factors: Annotated[Given[ArrayLike, Array], _factors]
    _: KW_ONLY
    x1: Vector
    x2: Vector

    def _complete(self, given: dict[str, Any]) -> None:
        for name in ("x1", "x2"):
            if len(given[name]) == 0 or (np.diff(given[name]) <= 0.0).any():
                raise ParameterError(name, "must ascend")
        arrays.check_shape(given["factors"], "factors", (len(given["x1"]), len(given["x2"])))


FrictionFactor: TypeAlias = (
    FrictionRegions | FrictionRaster | Callable[[float, float], float] | None
)
"""By what factor a plane multiplies the friction of what touches it, over the position (x₁, x₂):
regions, a raster, a smooth function with positive values, or everywhere 1."""


def checked_factor(given: Any, argument: str) -> Any:
    """Return `given` if it is a factor of friction over a plane."""
    if given is None or callable(given) or isinstance(given, FrictionRegions | FrictionRaster):
        return given
    raise ParameterError(
        argument,
        f"must be FrictionRegions, a FrictionRaster, a function of (x1, x2) or None, got {given!r}",
    )


def core_data(given: FrictionFactor) -> Any:
    """Return the factor for the core."""
    if isinstance(given, FrictionRegions):
        return given.regions, given.elsewhere
    if isinstance(given, FrictionRaster):
        return given.x1.tolist(), given.x2.tolist(), given.factors.ravel().tolist()
    return given
