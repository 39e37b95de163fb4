"""The kinds of scenarios: one file each."""

from asperity.predict.kinds.base import Kind, Laws, Quantity, Setup, rest_time
from asperity.predict.kinds.mass_on_belt import MASS_ON_BELT
from asperity.predict.kinds.rigid_bodies import RIGID_BODIES
from asperity.predict.kinds.sliding_disk import SLIDING_DISK
from asperity.predict.kinds.sliding_point import SLIDING_POINT

KINDS = {kind.name: kind for kind in (SLIDING_POINT, SLIDING_DISK, MASS_ON_BELT, RIGID_BODIES)}
"""By the name in the file."""

__all__ = ["KINDS", "Kind", "Laws", "Quantity", "Setup", "rest_time"]
