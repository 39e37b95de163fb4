"""Does a vibratory conveyor carry parts in MuJoCo as by events?
============================================================

A feeder in MJCF swings its tray on a spring, and parts creep over grooves in it. Learn how to give
two geoms a law whose axes one of them carries, and how to check the speed of transport.
"""

import asperity as asp
import matplotlib.pyplot as plt
import mujoco
import numpy as np
from asperity.mujoco import PairLaw, Scene

FREQUENCY, AMPLITUDE, RISE = 50.0, 0.3e-3, np.deg2rad(20.0)
PERIODS, SETTLING, DT = 20, 8, 1e-4
LAW = asp.FrictionLaw.associated(asp.Ellipse(0.5, 0.2))
SWING = np.array([np.cos(RISE), 0.0, np.sin(RISE)])

# %%
# The feeder as a model
# ---------------------
# The tray is far heavier than the part and swings on the spring of its joint. The part does not
# turn: it has slides only.

MASS = 100.0
slides = "".join(f'<joint type="slide" axis="{axis}"/>' for axis in ("1 0 0", "0 1 0", "0 0 1"))
model = mujoco.MjModel.from_xml_string(f"""
<mujoco><option timestep="{DT}"/><worldbody>
  <body name="tray" gravcomp="1">
    <joint type="slide" axis="{SWING[0]} 0 {SWING[2]}"
      stiffness="{MASS * (2.0 * np.pi * FREQUENCY) ** 2}"/>
    <geom name="tray" type="box" size="1 1 .1" pos="0 0 -.1"/>
    <inertial pos="0 0 0" mass="{MASS}" diaginertia="1 1 1"/></body>
  <body name="part" pos="0 0 .005">{slides}
    <geom name="part" type="sphere" size=".005" mass="0.01"/></body>
</worldbody></mujoco>""")


def in_mujoco(grooves):
    """Return the places of a part over time, with grooves at an angle to the swing, along x."""
    across = (np.sin(grooves), -np.cos(grooves), 0.0)
    scene = Scene(model, {("tray", "part"): PairLaw(LAW, axis=across)})
    data = mujoco.MjData(model)
    data.qpos[0] = -AMPLITUDE
    data.qpos[1:] = -AMPLITUDE * SWING
    run = scene.simulate(data, t_end=PERIODS / FREQUENCY)
    return run.t, run.qpos[:, 1:3]


# %%
# The known motion
# ----------------
# `integrate` finds every stick, slip and hop of the part on a plane with the same motion.


def by_events(grooves):
    """Return the places of the part over time on a plane that moves as the tray does."""
    swing = asp.Sine(AMPLITUDE * SWING, frequency=FREQUENCY, phase=np.full(3, -np.pi / 2))
    across = (np.sin(grooves), -np.cos(grooves), 0.0)
    tray = asp.Plane(axis=across, motion=asp.PlaneMotion(displacement=swing))
    part = asp.Body.ball(0.01, radius=0.005, position=-AMPLITUDE * SWING)
    contact = asp.PointPlane(0, point=(0.0, 0.0, 0.0), plane=tray, law=LAW)
    system = asp.RigidBodies([part], pairs=[contact])
    run = asp.integrate(system, t_end=PERIODS / FREQUENCY, sample_every=1.0 / (20 * FREQUENCY))
    return run.t, run.q[:, :2]


def transport(motion):
    """Return the mean velocity once the motion has settled in m/s."""
    t, place = motion
    start = np.searchsorted(t, SETTLING / FREQUENCY - 0.5 * DT)
    return (place[-1] - place[start]) / (t[-1] - t[start])


angles = np.deg2rad([0.0, 45.0, 90.0])
pairs = [(in_mujoco(angle), by_events(angle)) for angle in angles]
for angle, (stepped, known) in zip(angles, pairs, strict=True):
    found, expected = 1e3 * transport(stepped), 1e3 * transport(known)
    speeds = [f"({speed[0]:.1f}, {speed[1].round(1) + 0.0}) mm/s" for speed in (found, expected)]
    print(f"grooves at {np.rad2deg(angle):.0f}°: {speeds[0]} in MuJoCo, {speeds[1]} by events")
    # A hop begins and ends with a step, of which a period has 200.
    assert np.allclose(found, expected, rtol=0.0, atol=1.2)

# %%

with asp.plot.style():
    figure, ax = plt.subplots(figsize=(8.0, 4.4), layout="constrained")
    for angle, (stepped, known), color in zip(
        angles, pairs, ("#0072B2", "#D55E00", "#009E73"), strict=True
    ):
        t, place = stepped
        ax.plot(t, 1e3 * place[:, 0], color=color, label=f"grooves at {np.rad2deg(angle):.0f}°")
        t, place = known
        ax.plot(t[::10], 1e3 * place[::10, 0], "o", color=color, markersize=3.0)
    ax.set(xlabel="time in s", ylabel="$x$ of the part in mm")
    ax.legend(title="lines MuJoCo, dots by events", loc="upper left")
plt.show()
