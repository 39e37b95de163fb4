"""Where does a vibratory conveyor carry a part?
=============================================

A tray swings along a line that rises at 20°, and a part creeps forward on its grooves. Learn how
fast it is carried, and how far grooves lead it off the direction of shaking.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np

FREQUENCY, AMPLITUDE, RISE = 50.0, 0.3e-3, np.deg2rad(20.0)
PERIODS, SETTLING, SAMPLES = 20, 8, 20
LAW = asp.FrictionLaw.associated(asp.Ellipse(0.5, 0.2))

# %%
# A part on a shaken tray
# -----------------------
# The frame of the law follows the grooves: its first axis lies across them. The shaking begins at
# the lowest point of the swing.


def carried(grooves):
    """Return the motion of a part on a tray with grooves at an angle to the shaking, along x."""
    stroke = AMPLITUDE * np.array([np.cos(RISE), 0.0, np.sin(RISE)])
    shaking = asp.Sine(stroke, frequency=FREQUENCY, phase=np.full(3, -np.pi / 2))
    across = (np.sin(grooves), -np.cos(grooves), 0.0)
    tray = asp.Plane(axis=across, motion=asp.PlaneMotion(displacement=shaking))
    part = asp.Body.ball(0.01, radius=0.005, position=-stroke)
    contact = asp.PointPlane(0, point=(0.0, 0.0, 0.0), plane=tray, law=LAW)
    system = asp.RigidBodies([part], pairs=[contact])
    return asp.integrate(
        system, t_end=PERIODS / FREQUENCY, sample_every=1.0 / (SAMPLES * FREQUENCY)
    )


angles = np.deg2rad(np.linspace(0.0, 180.0, 13))
motions = [carried(angle) for angle in angles]

# %%
# Speed and direction of transport
# --------------------------------
# After eight periods the motion has settled.

settled = SETTLING * SAMPLES
time = (PERIODS - SETTLING) / FREQUENCY
transport = np.array([(m.q[-1, :2] - m.q[settled, :2]) / time for m in motions])
speed = np.linalg.norm(transport, axis=1)
astray = np.rad2deg(np.arctan2(transport[:, 1], transport[:, 0]))
flights = np.mean([np.mean(m.phase[settled:, 0] == asp.Phase.OPEN) for m in motions])
for name, k in (("along", 0), ("at 45° to", 3), ("across", 6)):
    off = astray[k].round(1) + 0.0
    print(f"grooves {name} the shaking: {1e3 * speed[k]:.1f} mm/s, {off:.1f}° off")
print(f"the part flies for {100 * flights:.0f} % of the time")

# %%
# Paths
# -----
# Grooves that lie obliquely lead the part off the direction of shaking.

with asp.plot.style():
    figure = plt.figure(figsize=(9.0, 4.2), layout="constrained")
    grid = figure.add_gridspec(2, 2)
    paths = figure.add_subplot(grid[:, 0])
    for k in (1, 3, 6, 9, 11):
        x, y = 1e3 * motions[k].q[:, :2].T
        paths.plot(x, y)
        paths.annotate(f" {np.rad2deg(angles[k]):.0f}°", (x[-1], y[-1]), va="center")
    paths.set(xlabel="along the shaking in mm", ylabel="across it in mm")
    paths.set_title("Paths, by the angle of the grooves")
    paths.margins(x=0.12)
    paths.set_aspect("equal", adjustable="datalim")
    fast = figure.add_subplot(grid[0, 1])
    fast.plot(np.rad2deg(angles), 1e3 * speed, "o-", markersize=4.0)
    fast.set(ylabel="speed in mm/s", ylim=(0.0, None))
    fast.tick_params(labelbottom=False)
    aside = figure.add_subplot(grid[1, 1], sharex=fast)
    aside.plot(np.rad2deg(angles), astray, "o-", markersize=4.0)
    aside.set(xlabel="angle from the shaking to the grooves in degrees")
    aside.set(ylabel="degrees off the shaking", xticks=np.arange(0.0, 181.0, 30.0))
plt.show()
