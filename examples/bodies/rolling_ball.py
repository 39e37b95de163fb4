"""When does a spinning ball begin to roll?
========================================

A spinning ball is dropped on a table, where it slides at first. Learn when it rolls and how fast,
and how contact forces are read in the axes of the world.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np

RADIUS, MU = 0.1, 0.2

# %%
# Drop, slide, roll
# -----------------
# A ball falls from 0.9 m with a spin of 50 or 10 rad/s. The fast one slides for a while; the
# friction of the impact alone makes the slow one roll. Either way :math:`2/7` of :math:`R\omega_0`
# remain.

runs = {}
for spin in (50.0, 10.0):
    ball = asp.Body.ball(
        1.0, radius=RADIUS, position=(0.0, 0.0, 1.0), angular_velocity=(0.0, spin, 0.0)
    )
    table = asp.SpherePlane(0, radius=RADIUS, plane=asp.Plane(), law=asp.FrictionLaw.isotropic(MU))
    system = asp.RigidBodies([ball], pairs=[table])
    runs[spin] = system, asp.simulate(system, dt=1e-4, t_end=1.0)

# %%
# When rolling begins
# -------------------

landings = {}
for spin, (_, motion) in runs.items():
    landing = landings[spin] = np.flatnonzero(motion.normal_force[:, 0] > 0.0)[0]
    sliding = np.flatnonzero(motion.phase[:, 0] == asp.Phase.SLIP)
    begin = motion.t[sliding[-1] if sliding.size else landing]
    print(
        f"{spin:.0f} rad/s: lands at {motion.t[landing]:.4f} s, rolls from {begin:.4f} s on "
        f"with {motion.u[-1, 0]:.4f} m/s; (2/7) R ω₀ = {2.0 / 7.0 * RADIUS * spin:.4f} m/s"
    )

# %%
# Velocities and friction
# -----------------------
# Where the dashed line meets the full one, the ball rolls, and friction vanishes.

with asp.plot.style():
    figure, (speeds, forces) = plt.subplots(2, 1, sharex=True, layout="constrained")
    for spin, (system, motion) in runs.items():
        rolling = RADIUS * system.angular_velocities(motion)[:, 0, 1]
        (line,) = speeds.plot(motion.t, motion.u[:, 0], label=f"$v$, {spin:.0f} rad/s")
        color = line.get_color()
        speeds.plot(motion.t, rolling, "--", color=color, label=rf"$R\omega$, {spin:.0f} rad/s")
        after = landings[spin] + 1
        friction = system.contact_forces(motion, frame="world")[after:, 0, 0]
        forces.plot(motion.t[after:], friction, color=color)
    speeds.set_ylabel("velocity in m/s")
    forces.set(xlabel="time in s", ylabel="friction in N")
    figure.legend(loc="outside upper center", ncols=2)
plt.show()
