"""Files of laws that are kept for the tests of the Rust crate, written by Python.

``python tests/stored_laws.py`` writes them anew, with forces that the crate must find.
"""

import json
from pathlib import Path

import asperity as asp
import numpy as np
from samples import BEAN, CORNERED, EGG, PENTAGON, SLANTED

FOLDER = Path(__file__).parents[1] / "crates" / "asperity" / "tests" / "laws"

WAVES = asp.Superellipse(0.54, 0.46, 2.9, angle=0.1) | asp.sets.Mapped(
    BEAN, [[2.0, 0.1], [0.3, 1.0]]
)
EVERYTHING = (
    WAVES
    | asp.Polygon([[0.7, -0.3], [0.5, 0.4], [-0.2, 0.6], [-0.5, -0.4]])
    | asp.WedgeAsperity(0.5, beta=0.4, angle=0.3)
    | (asp.Rectangle(0.6, 0.3, angle=0.2) & asp.CappedRectangle(0.4, 0.3, cap=0.2, angle=-0.2))
)
ROUND = asp.Ellipse(1.2, 0.7, angle=0.4) + asp.Disk(0.2) + CORNERED.scaled(0.1) + EGG
LAWS = {
    "plane": asp.FrictionLaw(
        EVERYTHING,
        ROUND,
        rate=asp.Stribeck(0.1, ratio=0.6, shape="hyperbolic", exponent=1.5, viscous=0.01),
    ),
    "reported": asp.FrictionLaw(
        BEAN, EGG, report=asp.law.FlowReport(1.001, 0.0, 0.1, 1e-3, misfit=0.02, samples=36)
    ),
    "engine": asp.FrictionLaw.like("exudyn", dryFriction=(0.5, 0.4), dryFrictionAngle=0.3),
    "line": asp.FrictionLaw.associated(asp.Interval(-0.2, 0.3)),
    "drilling": asp.FrictionLaw(
        asp.CoulombContensou(0.3, pressure="uniform"), asp.Ellipsoid([1.0, 0.8, 0.5])
    ),
    "turned": asp.FrictionLaw(
        asp.Superellipsoid([0.5, 0.3, 0.4], exponent=3.0)
        & asp.Box(lower=[-0.4, -0.3, -0.2], upper=[0.45, 0.25, 0.3]),
        asp.Ellipsoid([1.2, 0.7, 0.9], axes=SLANTED),
    ),
    "space": asp.FrictionLaw(asp.Ball(0.4), asp.Box([1.0, 0.8, 0.5]) + asp.Ball(0.3)),
    "pentagon": asp.FrictionLaw.associated(PENTAGON.scaled(0.3)),
}
"""Together they hold every class of sets."""
# With D at the scale at which the crate writes it.
LAWS = {name: law.replace(direction=law.direction, report=law.report) for name, law in LAWS.items()}


def answers(law):
    """Return slips and the forces there, as lists."""
    slip = np.random.default_rng(3).normal(size=(20, law.dimension))
    return {"slip": slip.tolist(), "force": law.force(slip, normal_force=2.0).tolist()}


def without_origin(text):
    """Return the text of a file without the lines that differ from one day to the next."""
    return text.split("# where this law comes from")[0]


if __name__ == "__main__":
    for name, law in LAWS.items():
        law.save(FOLDER / f"{name}.toml")
    found = {name: answers(law) for name, law in LAWS.items()}
    (FOLDER / "forces.json").write_text(json.dumps(found, indent=1) + "\n")
