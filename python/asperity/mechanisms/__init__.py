"""The mechanisms of friction-induced instability in [WL19] Fig. 13, as ready systems.

Each differs from a stable system in one thing: the friction coefficient depends on the sliding
speed (`stribeck_block`), the normal force on displacements (`mode_coupling`) or on velocities
(`FrictionalImpactOscillator`, and beyond any stability `painleve_rod`), the direction of the
force on the configuration (`FollowerPendulum`). Friction is isotropic in all of them.

>>> from asperity import mechanisms, simulate
>>> for mu in (0.6, 0.9):
...     motion = simulate(mechanisms.mode_coupling(mu), dt=1e-2, t_end=60.0, q0=[1e-3, 0.0, 0.0])
...     print(bool(abs(motion.q).max() > 0.1))
False
True
"""

from asperity.mechanisms.coupling import mode_coupling
from asperity.mechanisms.follower import FollowerPendulum
from asperity.mechanisms.oscillator import FrictionalImpactOscillator
from asperity.mechanisms.rod import painleve_rod
from asperity.mechanisms.stribeck import stribeck_block

__all__ = [
    "FollowerPendulum",
    "FrictionalImpactOscillator",
    "mode_coupling",
    "painleve_rod",
    "stribeck_block",
]
