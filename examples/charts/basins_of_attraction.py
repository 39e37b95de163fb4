"""Which starts end in stick and slip?
===================================

A mass on a belt slides steadily, or it sticks and slips for ever. Learn which starts lead to which.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np

SIZE, ENDS = 30, {"slides": "#0072B2", "sticks, then slides": "#56B4E9", "cycle": "#F5DEB3"}
law = asp.FrictionLaw(asp.Ellipse(30.0, 10.0, angle=np.pi / 6), asp.Ellipse(3.0, 1.0))
belt = asp.MassOnBelt(1.0, stiffness=1.0, law=law, normal_force=1.0, belt_velocity=[1.0, 0.0])


def draw(ax, x, y, velocity, q0):
    """Draw how motions from rest end; cycles stick for 0.7 of the time, swings below 0.1."""
    run = {"dt": 0.1, "replace": {"belt_velocity": velocity}, "keep": "stick_share"}
    begun = asp.simulate_many(belt, t_end=400.0, q0=q0, **run)
    later = asp.simulate_many(belt, t_end=50.0, q0=begun.q, u0=begun.u, **run)
    end = np.where(later.stick_share > 0.1, 2, begun.stick_share > 0.0)[..., 0]
    return ax.contourf(x, y, end, levels=[-0.5, 0.5, 1.5, 2.5], colors=[*ENDS.values()])


# %%
phi, far, k = np.linspace(40.0, 46.0, SIZE), np.linspace(-14.0, 14.0, SIZE), SIZE // 3
v = np.stack([np.cos(np.deg2rad(phi)), np.sin(np.deg2rad(phi))], axis=-1)
x, y = np.meshgrid(np.linspace(9.0, 29.0, SIZE), np.linspace(-6.0, 14.0, SIZE))
cycle = asp.limit_cycle(belt.replace(belt_velocity=v[k]), q0=[0.0, 0.0], u0=[0.0, 0.0])
print(f"belt at {phi[k]:.1f}°: {cycle.share(asp.Phase.STICK):.0%} of the cycle is stick")
with asp.plot.style():
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.0, 4.4), layout="constrained")
    draw(left, phi, far, v, law.force(-v) + far[:, None, None] * v + [0.01, 0.0])
    left.axvline(np.rad2deg(asp.critical_directions(law)[0][0]), color="black", linestyle="--")
    left.set(title="Beside steady sliding", xlabel="belt direction in °", ylabel="distance in m")
    end = draw(right, x, y, v[k], np.stack([x, y], axis=-1))
    figure.colorbar(end, ticks=[0, 1, 2]).set_ticklabels(ENDS)
    right.plot(*cycle.motion.q.T, "k-", *law.force(-v[k]), "k+")
    right.set(title=f"Belt at {phi[k]:.1f}°", xlabel="$x$ in m", ylabel="$y$ in m")
plt.show()
