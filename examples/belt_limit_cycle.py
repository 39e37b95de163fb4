"""Limit cycle of a mass on a moving belt (Walker & Leine 2019, Fig. 17).

Run: python belt_limit_cycle.py belt.png
"""

import sys

import asperity as asp
import numpy as np

law = asp.FrictionLaw(asp.Ellipse(30.0, 10.0, angle=np.deg2rad(30.0)), asp.Ellipse(3.0, 1.0))
velocity = [np.cos(np.deg2rad(50.0)), np.sin(np.deg2rad(50.0))]
belt = asp.MassOnBelt(mass=1.0, stiffness=1.0, law=law, normal_force=1.0, belt_velocity=velocity)
motion = asp.simulate(belt, dt=1e-3, t_end=200.0)
print(motion.summary())

ax = asp.plot.plot_path(motion.slice(150.0, 200.0), contact=0)
asp.plot.save_figure(ax.figure, sys.argv[1] if len(sys.argv) > 1 else "belt_limit_cycle.png")
