"""A spinning ball is dropped on a table: it slides until it rolls.

Run: python rolling_ball.py ball.png
"""

import sys

import asperity as asp
import numpy as np

RADIUS, MU = 0.1, 0.2

with asp.plot.style():
    import matplotlib.pyplot as plt

    figure, (speeds, forces) = plt.subplots(2, 1, sharex=True, layout="constrained")
for spin in (50.0, 10.0):
    ball = asp.Body.ball(
        1.0, radius=RADIUS, position=(0.0, 0.0, 1.0), angular_velocity=(0.0, spin, 0.0)
    )
    table = asp.SpherePlane(0, radius=RADIUS, plane=asp.Plane(), law=asp.FrictionLaw.isotropic(MU))
    system = asp.RigidBodies([ball], pairs=[table])
    motion = asp.simulate(system, dt=1e-4, t_end=1.0)

    velocity = motion.u[:, 0]
    rolling = RADIUS * system.angular_velocities(motion)[:, 0, 1]
    landing = np.flatnonzero(motion.normal_force[:, 0] > 0.0)[0]
    sliding = np.flatnonzero(motion.phase[:, 0] == asp.Phase.SLIP)
    begin = motion.t[sliding[-1]] if sliding.size else motion.t[landing]
    print(
        f"{spin:.0f} rad/s: lands at {motion.t[landing]:.4f} s, rolls from {begin:.4f} s on "
        f"with {velocity[-1]:.4f} m/s"
    )

    (line,) = speeds.plot(motion.t, velocity, label=f"v, ω₀ = {spin:.0f} rad/s")
    speeds.plot(
        motion.t, rolling, "--", color=line.get_color(), label=f"R ω, ω₀ = {spin:.0f} rad/s"
    )
    friction = system.contact_forces(motion, frame="world")[:, 0, 0]
    forces.plot(motion.t[landing + 1 :], friction[landing + 1 :], color=line.get_color())
speeds.set_ylabel("velocity in m/s")
figure.legend(loc="outside upper center", ncols=2)
forces.set(xlabel="time in s", ylabel="friction in N")
asp.plot.save_figure(figure, sys.argv[1] if len(sys.argv) > 1 else "rolling_ball.png")
