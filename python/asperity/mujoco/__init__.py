"""Contacts, limits and joints of MuJoCo models, rigid and with set-valued friction.

Needs mujoco 4: ``pip install "asperity[mujoco]"``. `Scene` steps a model in place of
``mujoco.mj_step``; `PairLaw` says which of two geoms carries the axes of a friction law.
"""

from asperity.mujoco.laws import PairLaw
from asperity.mujoco.results import Projection as Projection
from asperity.mujoco.results import SceneContact as SceneContact
from asperity.mujoco.results import SceneProblem as SceneProblem
from asperity.mujoco.results import SceneRun as SceneRun
from asperity.mujoco.results import SceneStep as SceneStep
from asperity.mujoco.scene import Scene

__all__ = ["PairLaw", "Scene"]
