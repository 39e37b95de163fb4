"""Synthetic measurements of the three contact pairs of [WL19] §5.2, Figs. 23–25.

No measurement is public. A virtual tribometer measures laws with the features that the paper
reports; everything computed from these data is labelled as synthetic.
"""

import math
from dataclasses import dataclass
from functools import cache

import asperity as asp
import numpy as np
from asperity.demo import table1
from asperity.identify import ProcessedData, RawData, VirtualTribometer, process
from paper.drawing import Array

SYNTHETIC = "synthetic data: virtual tribometer"
"""What a figure with such data says of them."""

_RADIUS = 0.1
_NODES = 720

# Radius of C beyond Table 1's superellipse in N, over cos 0, cos 2θ, …, cos 12θ: the only one that
# makes r 5.00 N across and 4.49 N along the grooves and leaves the least-squares fit unchanged.
_BEYOND = np.array([0.008902, -0.017973, 0.020394, -0.028209, 0.047394, -0.068818, 0.048309])


@dataclass(frozen=True)
class Pairing:
    """A contact pair with the law that the virtual tribometer measures."""

    name: str
    law: asp.FrictionLaw
    normal_force: float
    """Mean λ_N in N."""
    speed: float
    """Sliding speed ‖γ‖ in m/s."""
    seed: int

    @property
    def tribometer(self) -> VirtualTribometer:
        """The virtual tribometer: ten turns from the direction across the grooves."""
        return VirtualTribometer(
            self.law,
            normal_force=self.normal_force,
            turns=10.0,
            turn_rate=self.speed / (2.0 * math.pi * _RADIUS),
            radius=_RADIUS,
            sample_rate=1000.0,
            noise=0.02,
            noise_bandwidth=20.0,
            seed=self.seed,
        )

    def record(self) -> RawData:
        """Return the raw data."""
        return self.tribometer.record()


@cache
def processed(pairing: Pairing) -> ProcessedData:
    """Return the processed data of a pair; the same object each time."""
    return process(pairing.record())


def _pvc_reservoir() -> asp.PolarCurve:
    """Return C of PVC on ground steel per unit normal force.

    The friction coefficients on its axes are 0.54 and 0.48; with D of Table 1 its least-squares
    superellipse is that of Table 1.
    """
    angle = 2.0 * np.pi * np.arange(_NODES) / _NODES
    table = table1.SUPERELLIPSE_C
    return asp.PolarCurve(angle, table.radius(angle) + beyond(angle) / table1.NORMAL_FORCE)


def beyond(angle: Array) -> Array:
    """Return in N how far C of PVC reaches beyond the superellipse of Table 1."""
    return np.cos(2.0 * np.multiply.outer(angle, np.arange(len(_BEYOND)))) @ _BEYOND


SANDBLASTED = Pairing(
    "steel pin on sandblasted steel", asp.FrictionLaw.isotropic(0.14), 14.0, 0.05, seed=23
)
"""Isotropic, Fig. 23."""

PVC = Pairing(
    "PVC pin on surface ground steel",
    asp.FrictionLaw(_pvc_reservoir(), table1.SUPERELLIPSE_D),
    table1.NORMAL_FORCE,
    0.05,
    seed=24,
)
"""Rounded rectangles, Fig. 24 and Table 1."""

STEEL = Pairing(
    "steel pin on surface ground steel",
    asp.FrictionLaw(asp.Superellipse(0.15, 0.21, 1.5), asp.Superellipse(1.0, 1.5, 2.4)),
    18.5,
    0.1,
    seed=25,
)
"""C and D of different shape, most friction along the grooves, Fig. 25; parameters are own."""
