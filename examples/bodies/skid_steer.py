"""How fast does a robot on four fixed wheels turn?
================================================

Wheels that cannot steer have to slide across when a robot turns on the spot, the more the longer it
is. Learn how to put a robot from an MJCF model on set-valued friction, and what its yaw rate is.
"""

import asperity as asp
import matplotlib.pyplot as plt
import mujoco
import numpy as np
from asperity.mujoco import Scene

TRACK, RADIUS, SPEED = 0.2, 0.05, 6.0  # half the track in m, of the wheels in m, in rad/s

# %%
# The robot
# ---------
# The wheels of both sides turn against each other, driven by actuators that hold their speed.


def model_of(length):
    """Return the model of a robot whose axles are at this distance in m before and behind."""
    corners = [(x * length, y * TRACK) for x in (-1, 1) for y in (-1, 1)]
    wheels = "".join(
        f'<body pos="{x} {y} 0"><joint name="wheel{k}" axis="0 1 0" armature="0.02"/>'
        f'<geom type="sphere" size="{RADIUS}" mass="0.2"/></body>'
        for k, (x, y) in enumerate(corners)
    )
    drives = "".join(f'<velocity joint="wheel{k}" kv="5"/>' for k in range(4))
    return mujoco.MjModel.from_xml_string(f"""
        <mujoco><option timestep="0.002"/><worldbody>
        <geom type="plane" size="5 5 .1"/>
        <body pos="0 0 {RADIUS}"><freejoint/>
          <geom type="box" size="{length} {0.8 * TRACK} .02" mass="4"/>{wheels}</body>
        </worldbody><actuator>{drives}</actuator></mujoco>""")


# %%
# What is known
# -------------
# On the spot a wheel at (a, b) slides with v − ω b along and ω a across, v being the speed of its
# rim. With equal loads the torques of Coulomb friction, against these slips, balance where
# b (v − ω b) = a · ω a. A wheel that did not slide would turn it with v/b.


def turns(length):
    """Return the yaw rate of the robot and the speed of the rims once it turns steadily."""
    model = model_of(length)
    data = mujoco.MjData(model)
    data.ctrl[:] = [SPEED, -SPEED, SPEED, -SPEED]
    scene = Scene(model, {"default": asp.FrictionLaw.isotropic(0.7)})
    scene.simulate(data, t_end=1.0)
    return data.qvel[5], RADIUS * np.mean(np.abs(data.qvel[6:]))


lengths = np.array([0.08, 0.12, 0.16, 0.2, 0.3, 0.4])
found = np.array([turns(length) for length in lengths])
rates, rims = found.T
expected = rims * TRACK / (lengths**2 + TRACK**2)
for length, rate, known in zip(lengths, rates, expected, strict=True):
    print(f"axles {2e3 * length:.0f} mm apart: {rate:.6f} rad/s, by the formula {known:.6f} rad/s")
assert np.allclose(rates, expected, rtol=1e-5)

# %%

with asp.plot.style():
    figure, ax = plt.subplots(figsize=(7.6, 4.4), layout="constrained")
    fine = np.linspace(0.0, 0.42, 200)
    speed = RADIUS * SPEED
    ax.plot(
        fine,
        speed * TRACK / (fine**2 + TRACK**2),
        color="#0072B2",
        label="wheels that slide across",
    )
    ax.axhline(speed / TRACK, color="#999999", linestyle="--", label="wheels that roll")
    ax.plot(lengths, rates, "o", color="#D55E00", label="MuJoCo model with asperity")
    ax.set(xlabel="half the distance of the axles in m", ylabel="yaw rate in rad/s", ylim=(0, 1.7))
    ax.legend(loc="lower left")
plt.show()
