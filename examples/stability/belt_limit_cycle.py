"""How does a mass on a belt stick and slip?
=========================================

A mass on two springs lies on a belt whose friction is anisotropic. Learn what it does if the belt
runs at 50°, as in Fig. 17 of Walker & Leine (2019).
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np

# %%
# Mass, springs and belt
# ----------------------
# The reservoir :math:`C` is turned by 30° against the direction set :math:`D`: that makes steady
# sliding unstable.

law = asp.FrictionLaw(asp.Ellipse(30.0, 10.0, angle=np.deg2rad(30.0)), asp.Ellipse(3.0, 1.0))
velocity = [np.cos(np.deg2rad(50.0)), np.sin(np.deg2rad(50.0))]
belt = asp.MassOnBelt(mass=1.0, stiffness=1.0, law=law, normal_force=1.0, belt_velocity=velocity)
motion = asp.simulate(belt, dt=1e-3, t_end=200.0)
print(motion.summary())

# %%
# The limit cycle
# ---------------
# After the transient the mass repeats a cycle of stick and slip around the unstable equilibrium.

with asp.plot.style():
    figure, ax = plt.subplots(figsize=(6.4, 5.6), layout="constrained")
    asp.plot.plot_path(motion.slice(150.0, 200.0), ax=ax, contact=0)
    ax.plot(*belt.equilibrium, "+", color="black", markersize=10.0, label="unstable equilibrium")
    ax.set(xlabel="$x$ in m", ylabel="$y$ in m")
    ax.get_legend().remove()
    figure.legend(loc="outside upper center", ncols=3)
plt.show()
