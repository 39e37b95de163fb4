"""How far does a mass on a belt swing?
====================================

Where steady sliding is unstable small motions grow. Learn how large they get, and that they are
there before steady sliding has lost its stability.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np

SIZE, LOOK = 36, {"vmin": 2.0, "vmax": 36.0, "cmap": "viridis"}
law = asp.FrictionLaw(asp.Ellipse(30.0, 10.0), asp.Ellipse(3.0, 1.0))
belt = asp.MassOnBelt(1.0, stiffness=1.0, law=law, normal_force=1.0, belt_velocity=[1.0, 0.0])
(phi, zeta), fine = (np.linspace([30.0, 10.0], [90.0, 80.0], n).T for n in (SIZE, 300))
v = np.stack([np.cos(np.deg2rad(phi)), np.sin(np.deg2rad(phi))], axis=-1)

# %%
# All start at rest with relaxed springs. Eight cycles are found by shooting as well.
start = {"q0": [0.0, 0.0], "u0": [0.0, 0.0]}
turned = {"belt_velocity": v[:, None], "law.reservoir.angle": np.deg2rad(zeta)}
run = {"dt": 0.1, "t_end": 600.0, "keep": "extent", "after": 400.0}
runs = asp.simulate_many(belt, replace=turned, **run, **start)
i = SIZE * np.array([28, 44, 60, 40, 58, 75, 63, 77]) // 100
j = SIZE * np.array([29, 29, 29, 46, 46, 46, 65, 65]) // 100
some = [runs.system(place) for place in zip(i.tolist(), j.tolist(), strict=True)]
cycles = asp.limit_cycle_many(some, **start)
swing, exact = np.hypot(*runs.extent.T), np.hypot(*(cycles.maximum - cycles.minimum).T)
print(f"differ from limit cycles by {abs(swing[j, i] / exact - 1.0).max():.1%} at most")
with asp.plot.style():
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.0, 4.4), layout="constrained")
    rates = asp.growth_chart(belt, phi=np.deg2rad(fine[0]), zeta=np.deg2rad(fine[1]))
    asp.plot.plot_growth_chart(rates, ax=left, limit=12.0).set_title("Growth of small motions")
    figure.colorbar(right.pcolormesh(phi, zeta, swing, **LOOK), label="swing in m")
    right.contour(*fine, rates.growth.T > 1e-6, levels=[0.5], colors="white")
    right.scatter(phi[i], zeta[j], s=60.0, c=exact, edgecolors="black", **LOOK)
    right.plot(np.rad2deg([asp.critical_directions(x.law)[0] for x in some]), zeta[j], "wD")
    right.set(title="Swing of what follows", xlabel="direction of the belt in degrees")
plt.show()
