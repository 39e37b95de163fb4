"""Does friction grow in proportion to the load?
=============================================

Amontons' law says so, and laws per unit load rely on it; soft materials do otherwise. Learn how to
test it on runs with different loads, and likewise whether the speed matters.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np
from asperity import identify

# %%
# Runs with different loads
# -------------------------
# One of the two virtual materials has a coefficient that falls with the load, as for a soft pin.

law = asp.FrictionLaw.associated(asp.Ellipse(0.54, 0.46))
forces = [2.0, 4.0, 8.0, 16.0]
EXPONENTS = {"hard pin": 0.0, "soft pin": -0.12}


def run(load, exponent, seed):
    """Return the forces of a run at a load; the coefficient is proportional to load^exponent."""
    factor = (load / 4.0) ** exponent
    material = law.replace(reservoir=law.reservoir.scaled(factor), direction=law.direction)
    machine = identify.VirtualTribometer(
        material, normal_force=load, turns=3, sample_rate=150.0, seed=seed
    )
    return identify.process(machine.record())


tests = {}
for name, exponent in EXPONENTS.items():
    runs = [run(load, exponent, seed) for seed, load in enumerate(forces)]
    found = tests[name] = identify.load_dependence(runs)
    print(
        f"{name}: μ ∝ load^{found.exponent:.3f} ({found.low:.3f} … {found.high:.3f}), "
        f"Amontons' law {'may hold' if found.is_independent else 'does not hold'}"
    )

# %%
# Runs with different speeds
# --------------------------

machine = identify.VirtualTribometer(law, normal_force=8.0, turns=3, sample_rate=150.0)
speeds = [
    identify.process(machine.replace(turn_rate=rate, seed=seed).record())
    for seed, rate in enumerate([0.05, 0.1, 0.2, 0.4])
]
found = identify.speed_dependence(speeds)
print(f"speed: exponent {found.exponent:.4f}, independent: {found.is_independent}")

# %%

with asp.plot.style():
    figure, ax = plt.subplots(figsize=(7.2, 4.4), layout="constrained")
    line = np.geomspace(1.8, 18.0, 50)
    for name, test in tests.items():
        (points,) = ax.plot(test.values, test.coefficients, "o", label=name)
        middle = np.exp(np.mean(np.log(test.coefficients)))
        centre = np.exp(np.mean(np.log(test.values)))
        ax.plot(line, middle * (line / centre) ** test.exponent, color=points.get_color())
    ax.set(xscale="log", xlabel="normal force in N", ylabel="mean friction coefficient")
    ax.set_xticks(forces, [f"{force:.0f}" for force in forces])
    ax.set_ylim(0.4, 0.6)
    ax.minorticks_off()
    ax.legend()
plt.show()
