"""The force reservoir of a surface with wedge-shaped asperities."""

from __future__ import annotations

from asperity import _core
from asperity._base import arrays
from asperity.sets.shapes.turned import AngledSet


class WedgeAsperity(AngledSet):
    """The reservoir of parallel wedges in contact with springs, with its closed-form gauge.

    k_C(x) = (cos β/μ) (x₂² + B x₁²)/√(cos²β x₁² + x₂²), B = 1 − (1 + μ²) sin²β. The first axis is
    across the wedges, the second along them. Convex for μ tan β ≤ 1/√2.

    Args:
        mu: friction coefficient μ > 0 of a single spring on a flank.
        beta: inclination 0 ≤ β < π/2 of the flanks in rad, with μ tan β < 1.
        angle: of the first axis from e₁, counter-clockwise, in rad.

    Raises:
        ParameterError: where μ tan β ≥ 1, as the springs then lock.

    Reference: [WL19] (50), Fig. 10.

    >>> import math
    >>> from asperity import WedgeAsperity
    >>> surface = WedgeAsperity(1.2, beta=math.radians(36.0))
    >>> surface.radius([0.0, math.pi / 2]).round(9).tolist()
    [7.64327641, 1.483281573]
    >>> bool(surface.is_convex)
    False
    """

    mu: float
    beta: float

    def __init__(self, mu: float, *, beta: float, angle: float = 0.0) -> None:
        mu, beta = arrays.positive(mu, "mu"), arrays.non_negative(beta, "beta")
        self._set_angled(_core.Set.wedge_asperity(mu, beta), angle, mu=mu, beta=beta)
