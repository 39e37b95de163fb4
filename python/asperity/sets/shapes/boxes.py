"""Sets with flat faces: interval, box, rectangle, capped rectangle."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

import asperity._core as _core
from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.errors import ParameterError
from asperity.sets.shapes.turned import SizedSet, TurnedSet


class Interval(SizedSet):
    """The interval [lower, upper] of R¹, the force reservoir of a planar mechanism's contact.

    Args:
        lower: end below 0.
        upper: end above 0; unequal lengths make friction depend on the sense of sliding.

    >>> from asperity import Interval
    >>> Interval(-0.2, 0.3).gauge([[0.6], [-0.1]]).tolist()
    [2.0, 0.5]
    """

    _lengths = ("lower", "upper")

    lower: float
    upper: float

    def __init__(self, lower: float, upper: float) -> None:
        lower, upper = arrays.number(lower, "lower"), arrays.number(upper, "upper")
        if lower >= 0.0:
            raise ParameterError("lower", f"must be negative, got {lower!r}")
        arrays.positive(upper, "upper")
        core = _core.Set.cuboid(np.array([lower]), np.array([upper]))
        self._set_core(core, lower=lower, upper=upper)


class Box(SizedSet):
    """The box {x : |xᵢ| ≤ aᵢ}, or {x : lᵢ ≤ xᵢ ≤ uᵢ}; C = D: independent friction along each axis.

    It is a set of friction forces, as of an X–Y table; a rigid body of this shape is made by
    `Body.box`.

    Args:
        half_widths: aᵢ > 0, shape ``(p,)`` with p ≤ 3; or `lower` and `upper` in its place.
        lower: lᵢ < 0, shape ``(p,)``; with another size than uᵢ, friction along the axis depends on
            the sense of sliding.
        upper: uᵢ > 0, shape ``(p,)``.

    Raises:
        ParameterError: naming the argument; ``half_widths`` if neither it nor both others are
            given.

    Reference: [WL19] (36).

    >>> from asperity import Box
    >>> Box([2.0, 1.0, 1.0]).project([3.0, 0.0, -4.0]).tolist()
    [2.0, 0.0, -1.0]
    >>> float(Box(lower=[-1.0, -0.5], upper=[2.0, 0.5]).support([-1.0, 1.0]))
    1.5
    """

    _lengths = ("half_widths", "lower", "upper")

    half_widths: Array | None
    lower: Array
    """lᵢ."""
    upper: Array
    """uᵢ."""

    def __init__(
        self,
        half_widths: ArrayLike | None = None,
        *,
        lower: ArrayLike | None = None,
        upper: ArrayLike | None = None,
    ) -> None:
        if half_widths is not None:
            if lower is not None or upper is not None:
                raise ParameterError("half_widths", "excludes lower and upper")
            widths = arrays.extents(half_widths, "half_widths")
            core = _core.Set.cuboid(-widths, widths)
            self._set_core(core, half_widths=widths, lower=None, upper=None)
            self._keep(lower=-widths, upper=widths)
            return
        if lower is None or upper is None:
            raise ParameterError("half_widths", "must be given, or lower and upper")
        high = arrays.extents(upper, "upper")
        low = arrays.array(lower, "lower", (len(high),))
        if (low >= 0.0).any():
            raise ParameterError("lower", f"must be negative, got {low.tolist()}")
        self._set_core(_core.Set.cuboid(low, high), half_widths=None, lower=low, upper=high)


class Rectangle(TurnedSet):
    """The rectangle with half-widths a, b, turned by an angle.

    Args:
        a: half-width along the first axis.
        b: half-width along the second axis.
        angle: of the first axis from e₁, counter-clockwise, in rad.

    Reference: [WL19] (36).

    >>> from asperity import Rectangle
    >>> float(Rectangle(2.0, 1.0).support([1.0, 1.0]))
    3.0
    """

    def __init__(self, a: float, b: float, *, angle: float = 0.0) -> None:
        a, b = arrays.size(a, "a"), arrays.size(b, "b")
        upright = _core.Set.cuboid(np.array([-a, -b]), np.array([a, b]))
        self._set_angled(upright, angle, a=a, b=b)


class CappedRectangle(TurnedSet):
    """The rectangle with half-widths a, b and a half-ellipse on each of its ends, turned.

    {x : |x₂| ≤ b √(1 − (max(|x₁| − a, 0)/c)²)}, c the semi-axis of the caps along the first axis:
    the force reservoir of a bobsleigh's runner on ice.

    Args:
        a: half-width of the rectangle along the first axis.
        b: half-width along the second axis.
        cap: semi-axis c of the half-ellipses, by which each end sticks out.
        angle: of the first axis from e₁, counter-clockwise, in rad.

    Reference: [WL19] Fig. 7b.

    >>> from asperity import CappedRectangle
    >>> runner = CappedRectangle(0.3, 0.1, cap=0.2)
    >>> runner.gauge([[0.5, 0.0], [0.3, 0.1]]).round(12).tolist()
    [1.0, 1.0]
    """

    _lengths = ("a", "b", "cap")

    cap: float

    def __init__(self, a: float, b: float, *, cap: float, angle: float = 0.0) -> None:
        a, b = arrays.size(a, "a"), arrays.size(b, "b")
        cap = arrays.size(cap, "cap")
        upright = _core.Set.capped_rectangle(a, b, cap)
        self._set_angled(upright, angle, a=a, b=b, cap=cap)
