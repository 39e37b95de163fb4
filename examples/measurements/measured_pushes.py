"""Which friction laws do pushed bodies have?
==========================================

Robots have pushed bodies over boards and measured force and motion. Learn whether the boards are
isotropic, and which law a whole contact patch has.

Run: ``python measured_pushes.py FOLDER``; FOLDER holds ``real_pushes.npz``.
"""

import argparse
import os
import re
import sys
from pathlib import Path

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np
from asperity import identify

parser = argparse.ArgumentParser()
parser.add_argument("folder", nargs="?", default=os.environ.get("ASPERITY_MEASUREMENTS"))
parser.add_argument("--sets", type=int, help="how many sets of patches, by default all")
parser.add_argument("--figure", help="file of the picture, which is shown without it")
options = parser.parse_args()
if options.folder is None:
    sys.exit("name the folder of real_pushes.npz, or set ASPERITY_MEASUREMENTS")
with np.load(Path(options.folder) / "real_pushes.npz") as file:
    data = dict(file)

# %%
# Two boards: a null test
# -----------------------
# A right-angled triangle of 1.518 kg on three support points was pushed on a plate and on a wooden
# board [ZhouPaoliniBagnellMason2016]. The names of the logs hold the points in mm; the centre of
# mass is at (50, 50). Normal forces follow from statics, so that the friction coefficient is all
# that has to be fitted, and ellipses are what the pushes may claim beside it.

WEIGHT = 1.518 * 9.8
PUBLISHED = {"plate": 0.282, "wood": 0.336}
boards = {}
for board in PUBLISHED:
    logs, points = [], []
    for name, pushes in data.items():
        found = re.match(r"cmu/(wood_)?([\d._]+)-", name)
        if found and (found[1] is None) == (board == "plate"):
            x, y = np.array(found[2].split("_"), dtype=float).reshape(2, 3)
            logs.append(pushes)
            points.append(np.stack([x - 50.0, y - 50.0], axis=-1) / 1000.0)
    fit = boards[board] = identify.fit_supports(logs, points, weight=WEIGHT)
    print(f"{board}: {sum(map(len, logs))} pushes, published coefficient {PUBLISHED[board]}")
    print(fit.summary())
    print(fit.comparison.summary())
    print(f"anisotropy of the board is claimed: {fit.anisotropic}\n")

# %%
# An ellipse in the body's axes fits better on both boards, by the same tenth and at the same
# −40°: two boards cannot have turned with the body, so that it is an error of the apparatus that
# does. Left to choose between an isotropic board and an anisotropic one, the pushes choose the
# first.

# %%
# Patches: which shape of C?
# --------------------------
# Bodies of other shapes stood on ABS and on plywood with their whole face
# [YuBauzaFazeliRodriguez2016]. Five contiguous parts of each set of pairs of wrench and twist are
# left out in turn and predicted from the others.

MODELS = {
    "round area": {"reservoir": "contensou"},
    "ellipsoid": {},
    "ellipsoids C and D": {"direction": "ellipsoid"},
    "5 points": {"reservoir": "supports"},
    "5 points, elliptic": {"reservoir": "supports", "friction": "ellipse"},
}
names = sorted(name[4:-7] for name in data if re.match("mit/.*_wrench", name))[: options.sets]
comparisons = [
    identify.compare_patches(data[f"mit/{name}_wrench"], data[f"mit/{name}_twist"], models=MODELS)
    for name in names
]
errors = np.array([[one.left_out for one in found.candidates] for found in comparisons])
print("relative error of left-out wrenches")
print(f"{'':16s}", *(f"{name:>18s}" for name in MODELS))
for name, row in zip([*names, "mean"], [*errors, errors.mean(axis=0)], strict=True):
    print(f"{name:16s}", *(f"{error:18.3f}" for error in row))

# %%
# Is the law associated?
# ----------------------
# The extended law of two ellipsoids predicts better than the associated one of a single ellipsoid.
# The associated law of five points, whose C has another shape, predicts better than both.

PAIRS = (("ellipsoids C and D", "ellipsoid"), ("5 points", "ellipsoids C and D"))
gains = {
    pair: [found.improvement(pair[0], over=pair[1]) for found in comparisons] for pair in PAIRS
}
for (better, over), listed in gains.items():
    clear = sum(one.low > 0.0 for one in listed)
    print(
        f"{better} over {over}: mean square error smaller by "
        f"{np.mean([one.value for one in listed]):.0%} on the average, in "
        f"{sum(one.value > 0.0 for one in listed)} of {len(listed)} sets, "
        f"in {clear} of them by more than its 95 % band"
    )

# %%
# How much of what D gains can be the shape of C? Pairs that are made of the associated law of five
# points, with the measured twists and residuals whose blocks have random signs, tell: there, every
# gain of the extended ellipsoids is one of shape or of chance.

random = np.random.default_rng(0)
shape = []
for name in names:
    twist = data[f"mit/{name}_twist"]
    fit = identify.fit_patch(data[f"mit/{name}_wrench"], twist, **MODELS["5 points"])
    signs = random.choice([-1.0, 1.0], 40)[np.arange(len(twist)) * 40 // len(twist)]
    made = fit.pairs.wrench - fit.residuals + signs[:, None] * fit.residuals
    two = {name: MODELS[name] for name in PAIRS[0]}
    found = identify.compare_patches(made, twist, models=two)
    shape.append(found.improvement(PAIRS[0][0], over=PAIRS[0][1]))
print(
    f"on pairs of associated laws of five points: {np.mean([one.value for one in shape]):.1%} on "
    f"the average, in {sum(one.low > 0.0 for one in shape)} of {len(shape)} sets by more than "
    "its band"
)

# %%
# Friction coefficient over the direction, and errors by model
# ------------------------------------------------------------
# Left: the applied force relative to the isotropic law's, in sectors of the force's direction, with
# twice its standard error.


def over_direction(fit, in_body):
    """Return sectors of directions with mean and standard error of force over predicted force."""
    force = fit.pairs.wrench[:, :2]
    model = (fit.pairs.wrench - fit.residuals)[:, :2]
    along, squares = (force * model).sum(axis=1), (model**2).sum(axis=1)
    angle = np.arctan2(force[:, 1], force[:, 0]) + (0.0 if in_body else fit.pairs.angle)
    # A line through the origin has two directions: an ellipse does not tell them apart.
    sector = (angle % np.pi // (np.pi / 8.0)).astype(int)
    weights = np.bincount(sector, weights=squares, minlength=8)
    means = np.bincount(sector, weights=along, minlength=8) / weights
    left = (along - means[sector] * squares) ** 2
    spread = 2.0 * np.sqrt(np.bincount(sector, weights=left, minlength=8)) / weights
    return 22.5 * (np.arange(8) + 0.5), means, spread


with asp.plot.style():
    figure = plt.figure(figsize=(10.0, 7.2), layout="constrained")
    grid = figure.add_gridspec(2, 2, width_ratios=(1.0, 1.25))
    for row, (in_body, axes) in enumerate(((False, "board"), (True, "body"))):
        ax = figure.add_subplot(grid[row, 0])
        for shift, (board, fit) in zip((-1.5, 1.5), boards.items(), strict=True):
            where, mean, spread = over_direction(fit, in_body)
            ax.errorbar(where + shift, mean, spread, fmt="o", capsize=2.0, label=board)
        ax.axhline(1.0, color="black", linewidth=0.8)
        ax.set(
            xlabel=f"direction of the force in the {axes}'s axes [°]",
            ylabel="force / isotropic law",
            xticks=range(0, 181, 45),
            ylim=(0.75, 1.3),
            title=f"Pushes on three points: axes of the {axes}",
        )
        ax.legend(loc="upper right", ncols=2)
    ax = figure.add_subplot(grid[:, 1])
    order = errors[:, 1].argsort()
    for k, (name, mark) in enumerate(zip(MODELS, "^os*D", strict=True)):
        ax.plot(errors[order, k], range(len(names)), mark, label=name, markersize=6.0)
    ax.set_yticks(range(len(names)), [names[k].replace("_", ", ") for k in order])
    ax.set(xlabel="relative error of left-out wrenches", title="Whole patches")
    ax.legend(loc="lower right")
if options.figure:
    figure.savefig(options.figure, dpi=110)
else:
    plt.show()
