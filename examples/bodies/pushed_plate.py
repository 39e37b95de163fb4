"""About which point does a pushed body turn?
===========================================

A finger that pushes a body slowly beside its centre turns it as it moves it; where the centre of
rotation is, friction under the whole body decides. Learn how to push a body along a line, and how
well Coulomb's law predicts what a robot's pushes have done to a plate.

The measured pushes are left out unless ``ASPERITY_MEASUREMENTS`` names the folder of
``real_pushes.npz``.
"""

import os
import re
from pathlib import Path

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np

# %%
# A slow push
# -----------
# Along its line the finger pushes with d (v − u), u being the velocity of the body along it. Once
# this no longer changes, the push is balanced by friction alone: neither d, v nor the mass matters.

DAMPING, SPEED = 100.0, 0.1


def push(points, loads, mu, line):
    """Return the steady velocities (vx, vy, ω) of a body and the finger's force.

    The body stands on points with normal forces in N; the line is direction and lever of the force.
    """
    law = asp.FrictionLaw.isotropic(mu)
    contacts = [
        asp.Contact(law, direction=[[1.0, 0.0], [0.0, 1.0], [-y, x]], normal_force=load)
        for (x, y), load in zip(points, loads, strict=True)
    ]
    system = asp.LinearSystem(
        0.2 * np.diag([1.0, 1.0, max(np.mean(points**2), line[2] ** 2)]),
        damping=DAMPING * np.outer(line, line),
        force=DAMPING * SPEED * line,
        contacts=contacts,
    )
    run = asp.simulate(system, dt=1e-3, t_end=0.8)
    return run.u[-1], DAMPING * (SPEED - line @ run.u[-1])


# %%
# A rod
# -----
# Friction of a rod of length L that is pushed across, at p from its end, has no torque about the
# finger where the rod turns about a point at c = p + √(p² + L²/2 − pL) from that end. The force is
# μ W (2c/L − 1): pushed at its end, a rod turns about 0.707 L with 0.414 μ W.

COUNT, WEIGHT = 60, 10.0
rod = np.stack([(np.arange(COUNT) + 0.5) / COUNT - 0.5, np.zeros(COUNT)], axis=-1)
places = np.linspace(0.0, 0.4, 5)
centres = []
for place in places:
    line = np.array([0.0, 1.0, place - 0.5])
    u, force = push(rod, np.full(COUNT, WEIGHT / COUNT), 0.3, line)
    centre, expected = 0.5 - u[1] / u[2], place + np.sqrt(place**2 + 0.5 - place)
    known = 0.3 * WEIGHT * (2.0 * expected - 1.0)
    print(
        f"pushed at {place:.1f} L: turns about {centre:.3f} L, expected {expected:.3f} L;", end=" "
    )
    print(f"force {force:.4f} N, expected {known:.4f} N")
    # It turns about one of its points, or between two of them.
    assert abs(centre - expected) < 0.51 / COUNT
    assert abs(force / known - 1.0) < 1e-3
    centres.append(centre)

# %%
# A plate
# -------
# A robot has pushed a plate of 1.518 kg on three support points over a board and over wood
# [ZhouPaoliniBagnellMason2016]. With the line of the force as it was measured, Coulomb's law says
# how the plate moves, whatever the coefficient, and with the published one, how large the force is.

folder = os.environ.get("ASPERITY_MEASUREMENTS")
PUBLISHED = {"plate": 0.282, "wood": 0.336}
LENGTH = 0.05  # m, which makes velocities of rotations
moves = {board: [] for board in PUBLISHED}
ratios = {board: [] for board in PUBLISHED}
data = np.load(Path(folder) / "real_pushes.npz") if folder else {}
for name in data:
    found = re.match(r"cmu/(wood_)?([\d._]+)-", name)
    if not found:
        continue
    board = "wood" if found[1] else "plate"
    points = (np.array(found[2].split("_"), dtype=float).reshape(2, 3).T - 50.0) / 1000.0
    loads = np.linalg.solve(np.vstack([np.ones(3), points.T]), [1.518 * 9.8, 0.0, 0.0])
    for _, _, angle, *measured in data[name][:, :9]:
        turned = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        moved, applied = np.reshape(measured, (2, 3))
        moved, applied = (np.append(turned @ one[:2], one[2]) for one in (moved, applied))
        size = np.linalg.norm(applied[:2])
        u, force = push(points, loads, PUBLISHED[board], applied / size)
        both = np.stack([u, moved]) * [1.0, 1.0, LENGTH]
        moves[board].append(both / np.linalg.norm(both, axis=1, keepdims=True))
        ratios[board].append(size / force)
errors = {}
for board, pairs in moves.items() if folder else ():
    cosine = np.prod(pairs, axis=1).sum(axis=-1)
    errors[board] = np.rad2deg(np.arccos(np.clip(cosine, -1.0, 1.0)))
    print(f"{board}, {len(pairs)} pushes: the motion is {np.median(errors[board]):.1f}°", end=" ")
    print("beside the measured one (median), the measured force", end=" ")
    print(f"{np.median(ratios[board]):.2f} times the predicted one (median)")
if not folder:
    print("set ASPERITY_MEASUREMENTS to compare with measured pushes")

# %%

with asp.plot.style():
    count = 2 if folder else 1
    figure, axes = plt.subplots(1, count, figsize=(5.2 * count, 4.2), layout="constrained")
    left, *rest = np.ravel(axes)
    fine = np.linspace(0.0, 0.45, 200)
    known = fine + np.sqrt(fine**2 + 0.5 - fine)
    left.plot(fine, known, color="#0072B2", label="$p + \\sqrt{p^2 + L^2/2 - pL}$")
    left.plot(places, centres, "o", color="#D55E00", label=f"rod on {COUNT} points")
    left.set(xlabel="place of the finger $p/L$", ylabel="centre of rotation $c/L$")
    left.legend(loc="upper left")
    for ax in rest:
        for (board, pairs), color in zip(moves.items(), ("#0072B2", "#D55E00"), strict=True):
            ax.plot(*np.array(pairs)[:, ::-1, 2].T, ".", color=color, label=board)
        ax.plot([-1.0, 1.0], [-1.0, 1.0], color="#999999", linewidth=0.8)
        ax.set(xlabel="measured share of rotation", ylabel="predicted share of rotation")
        ax.legend(loc="upper left")
plt.show()
