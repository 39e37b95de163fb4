"""How fast does a motion settle into its cycle?
=============================================

A section that every turn crosses makes a sequence of numbers of a vibration. Learn how to stop an
integration at a section, and how to read off that sequence whether a cycle is stable.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np

# %%
# A block on a belt with falling friction
# ---------------------------------------
# Steady sliding is unstable. The section consists of the states in which the spring is as long as
# in steady sliding, crossed downwards.

rate = asp.Stribeck(0.5, ratio=0.4, viscous=0.1)
law = asp.FrictionLaw.isotropic(1.0, dimension=1).replace(rate=rate)
belt = asp.Contact(law, direction=[1.0], normal_force=1.0, velocity=[-0.6])
block = asp.LinearSystem([[1.0]], stiffness=[[1.0]], contacts=[belt])
[middle] = asp.equilibrium(block).q


def turns(speed, number=12):
    """Return the motions between crossings, beginning with a speed downwards at the section."""
    state, found = asp.State([middle], [-speed]), []
    for _ in range(number):
        section = asp.Section([-1.0, 0.0], -middle, after=state.t0 + 1.0)
        motion = asp.integrate(
            block, t_end=state.t0 + 20.0, start=state, section=section, sample_every=0.02
        )
        found.append(motion)
        state = asp.State(motion.q[-1], motion.u[-1], t0=motion.t[-1])
    return found


options = turns(0.1, number=1)[0].options
print(f"ended at the section: {options.section}")

# %%
# The return map
# --------------
# From one crossing to the next the speed grows, until the block sticks for a part of the turn. What
# has stuck has forgotten how it came, so that all motions are in the cycle after a single stick.

starts = {speed: turns(speed) for speed in (0.05, 1.2)}
for speed, motions in starts.items():
    print(f"from {speed} m/s:", " ".join(f"{-motion.u[-1, 0]:.4f}" for motion in motions))
speeds = np.linspace(0.02, 1.3, 40)
returns = [-turns(speed, number=1)[0].u[-1, 0] for speed in speeds]

with asp.plot.style():
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.0, 4.6), layout="constrained")
    for (speed, motions), color in zip(starts.items(), ("#0072B2", "#D55E00"), strict=True):
        for motion in motions:
            left.plot(motion.q[:, 0], motion.u[:, 0], color=color, linewidth=1.0)
        series = np.array([speed, *[-motion.u[-1, 0] for motion in motions]])
        right.plot(np.repeat(series, 2)[:-1], np.r_[0.0, np.repeat(series[1:], 2)], color=color)
    left.vlines(middle, -1.3, 0.0, "black", "--", label="section")
    left.set(ylim=(-1.4, 1.0), title="Two motions", xlabel="$q$ in m", ylabel="$u$ in m/s")
    left.legend(loc="upper left")
    right.plot(speeds, returns, "k-", label="return map")
    right.plot(speeds, speeds, "k:", label="the same again")
    right.set(title="Speeds at the section", xlabel="speed in m/s", ylabel="next speed in m/s")
    right.set(aspect="equal")
    right.legend(loc="lower right")
plt.show()
