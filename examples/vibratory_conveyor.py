"""A part on a conveyor that is shaken obliquely goes where friction and shaking agree on.

The tray swings along a line that rises at 20°. Its surface has grooves: friction is stronger across them than
along them. How fast the part is carried, and how far off the direction of shaking, depends on the angle between
the two.

Run: python vibratory_conveyor.py conveyor.png
"""

import sys

import asperity as asp
import numpy as np

FREQUENCY, AMPLITUDE, RISE = 50.0, 0.3e-3, np.deg2rad(20.0)
PERIODS, SETTLING = 30, 10
ACROSS, ALONG = 0.5, 0.2
LAW = asp.FrictionLaw.associated(asp.Ellipse(ACROSS, ALONG))


def carried(grooves):
    """Return the motion of a part on a tray with grooves at an angle to the shaking, along x."""
    stroke = AMPLITUDE * np.array([np.cos(RISE), 0.0, np.sin(RISE)])
    # From the lowest point of the swing on.
    shaking = asp.Sine(stroke, FREQUENCY, phase=np.full(3, -np.pi / 2))
    across = (np.sin(grooves), -np.cos(grooves), 0.0)
    tray = asp.Plane(axis=across, motion=asp.PlaneMotion(displacement=shaking))
    part = asp.Body.ball(0.01, 0.005, position=-stroke)
    contact = asp.PointPlane(0, (0.0, 0.0, 0.0), tray, LAW)
    system = asp.RigidBodies([part], [contact])
    return asp.integrate(system, t_end=PERIODS / FREQUENCY, dt=0.05 / FREQUENCY)


angles = np.deg2rad(np.linspace(0.0, 180.0, 37))
motions = [carried(angle) for angle in angles]
settled = round(SETTLING / 0.05)
time = (PERIODS - SETTLING) / FREQUENCY
transport = np.array([(m.q[-1, :2] - m.q[settled, :2]) / time for m in motions])
speed = np.linalg.norm(transport, axis=1)
astray = np.rad2deg(np.arctan2(transport[:, 1], transport[:, 0]))

flights = np.mean([np.mean(m.phase[settled:, 0] == asp.Phase.OPEN) for m in motions])
for name, k in (("along", 0), ("at 45° to", 9), ("across", 18)):
    print(f"grooves {name} the shaking: {1e3 * speed[k]:.1f} mm/s, {astray[k]:.1f}° off")
print(f"the part flies for {100 * flights:.0f} % of the time")

with asp.plot.style():
    import matplotlib.pyplot as plt

    figure, (left, right) = plt.subplots(1, 2, figsize=(9.0, 3.8), layout="constrained")
for k in (0, 6, 12, 18, 24, 30):
    x, y = 1e3 * motions[k].q[:, :2].T
    left.plot(x, y, label=f"{np.rad2deg(angles[k]):.0f}°")
left.set(xlabel="along the shaking in mm", ylabel="across it in mm", title="paths")
left.legend(title="grooves at", ncols=2)
left.set_aspect("equal", adjustable="datalim")
right.plot(np.rad2deg(angles), 1e3 * speed, "C0")
right.set(xlabel="angle from the shaking to the grooves in degrees", title="transport")
right.set_ylabel("speed in mm/s", color="C0")
right.set_ylim(0.0)
other = right.twinx()
other.plot(np.rad2deg(angles), astray, "C1--")
other.set_ylabel("direction off the shaking in degrees", color="C1")
other.axhline(0.0, color="0.7", linewidth=0.8)
asp.plot.save_figure(figure, sys.argv[1] if len(sys.argv) > 1 else "vibratory_conveyor.png")
