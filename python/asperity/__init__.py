"""Set-valued anisotropic dry friction: laws, solvers, motions, stability, identification.

Theory: S. V. Walker, R. I. Leine, *Set-valued anisotropic dry friction laws: formulation,
experimental verification and instability phenomenon*, Nonlinear Dynamics (2019), cited as [WL19].

>>> import asperity as asp
>>> law = asp.FrictionLaw(reservoir=asp.Ellipse(0.6, 0.3), direction=asp.Ellipse(0.5, 0.3))
>>> path = asp.simulate(
...     asp.SlidingPoint(0.1, law=law), dt=1e-3, t_end=1.0, u0=[1.0, 1.0], until_rest=True
... )
>>> path.status
Outcome.AT_REST
"""

from importlib import import_module as _import_module
from types import ModuleType as _ModuleType
from typing import TYPE_CHECKING as _TYPE_CHECKING

from asperity import (
    contact,
    cycles,
    ensemble,
    errors,
    law,
    runs,
    sets,
    solvers,
    status,
    steady_sliding,
    sweeps,
    system,
)
from asperity._core import __version__
from asperity.contact import *
from asperity.cycles import *
from asperity.ensemble import *
from asperity.errors import *
from asperity.law import *
from asperity.runs import *
from asperity.sets import *
from asperity.solvers import *
from asperity.status import *
from asperity.steady_sliding import *
from asperity.sweeps import *
from asperity.system import *

if _TYPE_CHECKING:
    from asperity import identify as identify
    from asperity import mechanisms as mechanisms
    from asperity import mujoco as mujoco
    from asperity import plot as plot
    from asperity import predict as predict
    from asperity import problems as problems
    from asperity import track as track

# A public name is listed once, by its subpackage.
__all__ = ["__version__"]
__all__ += contact.__all__
__all__ += cycles.__all__
__all__ += ensemble.__all__
__all__ += errors.__all__
__all__ += law.__all__
__all__ += runs.__all__
__all__ += sets.__all__
__all__ += solvers.__all__
__all__ += status.__all__
__all__ += steady_sliding.__all__
__all__ += sweeps.__all__
__all__ += system.__all__

# These subpackages import matplotlib, MuJoCo and SciPy: they are imported at first use.
_LAZY = ("identify", "mechanisms", "mujoco", "plot", "predict", "problems", "track")


def __getattr__(name: str) -> _ModuleType:
    if name in _LAZY:
        return _import_module(f"asperity.{name}")
    message = f"module 'asperity' has no attribute {name!r}"
    for part in (contact, ensemble, law, runs, sets, solvers, steady_sliding, sweeps, system):
        if not name.startswith("_") and hasattr(part, name):
            message += f": it is {part.__name__}.{name}"
    raise AttributeError(message)


def __dir__() -> list[str]:
    return sorted({*__all__, *_LAZY})
