"""Why does chalk hop over the board?
===================================

A rod that is pushed over a rough surface tip first digs in, stops and jumps, though nothing strikes
it. Learn how ``integrate`` goes through Painlevé's paradox, and which event leads out of it.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np
from asperity import mechanisms

# %%
# A rod that slides tip first
# ---------------------------
# Normal force and friction enforce each other: the steeper the rod, the larger both become. Where
# their feedback is one, no force keeps the tip from entering the ground.

rod = mechanisms.painleve_rod()
motion = asp.integrate(rod, t_end=1.0, sample_every=1e-3)
for event in motion.events:
    print(f"at {event.time:.6f} s: {event.kind.value}")
jump = next(e for e in motion.events if e.kind is asp.EventKind.IMPACT_WITHOUT_COLLISION)

# %%
# An impact without collision
# ---------------------------
# At that instant a percussion stops the tip, which did not approach the ground, and the rod turns
# over it into the air.

before = motion.t < jump.time
tip = motion.q[:, :2] + np.stack([np.cos(motion.q[:, 2]), np.sin(motion.q[:, 2])], axis=-1)
with asp.plot.style():
    figure, (left, right) = plt.subplots(1, 2, figsize=(11.0, 4.2), layout="constrained")
    for k in np.flatnonzero((motion.t >= 0.7) & (motion.t <= 1.0))[::30]:
        foot = 2.0 * motion.q[k, :2] - tip[k]
        left.plot(*np.stack([tip[k], foot]).T, color="#0072B2" if before[k] else "#D55E00")
    left.axhline(0.0, color="black")
    left.set(title="The rod before and after, every 30 ms", xlabel="$x$ in m", ylabel="$y$ in m")
    left.set_aspect("equal")
    right.semilogy(motion.t[before], motion.normal_force[before, 0], label="normal force")
    right.axvline(jump.time, color="#D55E00", label="impact without collision")
    right.set(title="Force on the tip", xlabel="time in s", ylabel="force in N")
    right.legend(loc="upper left")
plt.show()
