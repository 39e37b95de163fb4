"""How far can I trust friction coefficients from my sensor?
=========================================================

More turns make the scatter smaller, but not the errors of calibration and zeros, which all turns
share. Learn how a calibration is given, and what it adds to a confidence interval.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np
from asperity import identify

# %%
# A calibration
# -------------
# Known loads along the three axes of a sensor, and what its channels read. They answer to each
# other's loads.

random = np.random.default_rng(5)
crosstalk = np.array([[1.02, 0.03, 0.0], [-0.02, 0.97, 0.01], [0.0, 0.04, 1.01]])
loads = np.repeat(np.eye(3), 4, axis=0) * np.tile([2.0, 4.0, 6.0, 9.0], 3)[:, None]
readings = loads @ crosstalk.T + 0.01 * random.normal(size=loads.shape)
calibration = identify.Calibration(loads, readings)
print("gains and crosstalk, with standard errors:")
print(calibration.matrix.round(4))
print(np.sqrt(np.diag(calibration.covariance)).reshape(3, 3).round(5))

# %%
# Records of more and more turns
# ------------------------------
# The variance of an estimate has three parts: scatter between turns, gains, and zeros.

law = asp.FrictionLaw(asp.Ellipse(0.54, 0.46), asp.Ellipse(1.5, 1.0))
machine = identify.VirtualTribometer(law, normal_force=9.3, sample_rate=150.0, seed=6)
numbers, errors, shares = [3, 5, 10, 20, 40], [], []
for number in numbers:
    data = identify.process(machine.replace(turns=number).record())
    fit = identify.fit_law(data, reservoir="ellipse", direction="ellipse")
    estimate = fit.parameters["reservoir.a"]
    errors.append(estimate.standard_error)
    shares.append(fit.covariance.shares()[0])
    print(f"{number:2} turns: {estimate}")

# %%
# What the error consists of
# --------------------------
# Here a few turns are enough: what is left is the calibration, and only better weighings help.

parts = np.array(shares).T * np.array(errors)
names = ["scatter of the turns", "gains", "zeros"]
with asp.plot.style():
    figure, ax = plt.subplots(figsize=(7.6, 4.4), layout="constrained")
    bottom = np.zeros(len(numbers))
    for name, part in zip(names, parts, strict=True):
        ax.bar([str(number) for number in numbers], 1e3 * part, bottom=1e3 * bottom, label=name)
        bottom += part
    ax.set(xlabel="turns", ylabel="standard error of a friction coefficient × 1000")
    figure.legend(title="share of the variance", loc="outside upper center", ncols=3)
plt.show()
