"""What do other engines make of two friction coefficients?
========================================================

Several engines take one coefficient along and one across, and each makes another law of them. Learn
how to make the law that an engine was found to compute, and what is known of the difference.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np

# %%
# The same two coefficients in the words of each engine:
MU = (0.6, 0.3)
engines = {
    "MuJoCo, pyramidal cone": ("mujoco", {"friction": MU}),
    "MuJoCo, elliptic cone": ("mujoco", {"friction": MU, "cone": "elliptic"}),
    "Bullet without cone": (
        "bullet",
        {"lateralFriction": 1.0, "anisotropicFriction": (*MU, 1.0), "enableConeFriction": False},
    ),
    "cardillo, DualStormerVerlet": (
        "cardillo",
        {"mu": 1.0, "anisotropy": MU, "solver": "DualStormerVerlet"},
    ),
    "Exudyn, rolling disc": ("exudyn", {"dryFriction": MU}),
}
laws = {name: asp.FrictionLaw.like(of, **words) for name, (of, words) in engines.items()}
for name, law in laws.items():
    report = law.report
    print(f"{name}: {report.deviation}\n")

# %%
# Three of the reservoirs are the same ellipse (MuJoCo with the elliptic cone, cardillo, Exudyn), in
# lines of different width on top of each other: these laws differ in the direction of the force.
# A body launched at 50° comes to rest in five places:
angle, turn = np.deg2rad(50.0), np.linspace(0.0, 2.0 * np.pi, 721)
launch = 2.0 * np.array([np.cos(angle), np.sin(angle)])
directions = np.column_stack([np.cos(turn), np.sin(turn)])

with asp.plot.style():
    figure, (forces, paths) = plt.subplots(1, 2, figsize=(10.0, 5.0), layout="constrained")
    for (name, law), width in zip(laws.items(), [1.5, 9.0, 1.5, 5.0, 1.5], strict=True):
        slider = asp.SlidingPoint(1.0, law=law)
        path = asp.simulate(slider, dt=1e-3, t_end=3.0, u0=launch, until_rest=True)
        boundary = law.reservoir.radius(turn)[:, None] * directions
        forces.plot(*boundary.T, linewidth=width)
        paths.plot(*path.q.T, label=name)
        paths.plot(*path.q[-1], "ko", markersize=4)
    forces.set(title="What the contact can bear", aspect="equal")
    forces.set(xlabel=r"$-\lambda_1/\lambda_N$", ylabel=r"$-\lambda_2/\lambda_N$")
    paths.set(title="Where the body stops", xlabel="x in m", ylabel="y in m", aspect="equal")
    figure.legend(loc="outside lower center", ncols=3)
plt.show()
