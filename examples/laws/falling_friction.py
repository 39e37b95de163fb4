"""What if friction falls with the speed?
======================================

Many pairings resist less the faster they slide, with a smooth change from stick to slip. Learn how
to add such a factor to any law, and what it does to a block that is pulled by a spring.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np

# %%
# A factor of the speed
# ---------------------
# ``Stribeck`` multiplies the force in slip; stick keeps the whole reservoir. Here half of the force
# is lost above 20 mm/s, or a little is gained by viscous friction.

constant = asp.FrictionLaw.isotropic(0.4, dimension=1)
rates = {
    "constant": None,
    "falling": asp.Stribeck(0.02, ratio=0.5),
    "falling, viscous": asp.Stribeck(0.02, ratio=0.5, viscous=6.0),
}
laws = {name: constant.replace(rate=rate) for name, rate in rates.items()}

# %%
# A block on a spring
# -------------------
# One end of the spring runs at 50 mm/s, and the block of 1 kg follows it. In the frame of that end
# the block hangs on a wall, and the ground slides below it.

runs = {}
for name, law in laws.items():
    ground = asp.Contact(law, direction=[1.0], normal_force=9.81, velocity=[0.05])
    block = asp.LinearSystem([[1.0]], stiffness=[[100.0]], contacts=[ground])
    runs[name] = asp.simulate(block, dt=1e-3, t_end=6.0, q0=[0.0])
    stick = runs[name].stick_fraction[0]
    print(f"{name:17} sticks for {stick:.0%} of the time, spring between", end=" ")
    print(f"{-100 * runs[name].q[2000:].max():.2f} and {-100 * runs[name].q[2000:].min():.2f} N")

# %%
# Laws and motions
# ----------------
# With falling friction the block sticks and slips for ever. Enough viscous friction ends that.

speed = np.linspace(0.0, 0.15, 400)
with asp.plot.style():
    figure, (left, right) = plt.subplots(1, 2, figsize=(11.0, 4.2), layout="constrained")
    for name, law in laws.items():
        left.plot(1e3 * speed[1:], -law.force(speed[1:, None])[:, 0])
        right.plot(runs[name].t, -100.0 * runs[name].q[:, 0], label=name)
    left.axvline(50.0, color="0.6", linestyle=":")
    left.annotate("speed of the pull", (50.0, 0.05), (4, 0), textcoords="offset points")
    left.set(xlabel="sliding speed in mm/s", ylabel="friction coefficient", ylim=(0.0, 0.65))
    right.set(xlabel="time in s", ylabel="force of the spring in N")
    figure.legend(loc="outside upper center", ncols=3)
plt.show()
