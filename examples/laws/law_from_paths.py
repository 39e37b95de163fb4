"""Can filmed paths tell a friction law?
=====================================

A body is launched in six directions and filmed until it stops. Learn how a law is fitted to the
paths, without any force sensor, and what paths do not tell.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np
from asperity import identify

# %%
# Virtual films
# -------------
# The law is known here, so that the result can be judged. Twelve points of every path have errors
# of 0.3 mm; directions are known to 0.2°, speeds and times of the launches are not.

law = asp.FrictionLaw(asp.Superellipse(0.537, 0.457, 2.94), asp.Superellipse(1.84, 1.19, 2.51))
body = asp.SlidingPoint(0.018, law=law)
random = np.random.default_rng(2)
error, turned = 0.3e-3, np.deg2rad(0.2)
paths, launches = [], []
for angle in np.deg2rad(np.linspace(5.0, 87.0, 6)):
    speed = 1.5 * (1.0 + 0.02 * random.normal())
    velocity = [speed * np.cos(angle), speed * np.sin(angle)]
    run = asp.simulate(body, dt=1e-4, t_end=1.0, u0=velocity, until_rest=True)
    t = np.linspace(0.0, run.t[-1], 12)
    x = np.stack([np.interp(t, run.t, run.q[:, i]) for i in (0, 1)], axis=-1)
    x += error * random.normal(size=x.shape)
    paths.append(asp.track.MeasuredPath(t + 0.01 * random.normal(), x, np.full(x.shape, error)))
    known = angle + turned * random.normal()
    launches.append(identify.Launch(place=(0.0, 0.0), direction=known, direction_error=turned))

# %%
# The law of the paths
# --------------------
# The axes of the sets are those of the grinding grooves. Intervals follow from what differs
# between paths.

fit = identify.fit_paths(
    paths,
    system=body,
    launch=launches,
    fixed={"reservoir.angle": 0.0, "direction.angle": 0.0},
    length_error=0.001,
)
print(fit.summary())
first = fit.paths[0]
print(
    f"the first path is missed by {1e3 * first.rms:.3f} mm, its launch was {first.launch_speed} m/s"
)

# %%
# Paths and sets
# --------------

with asp.plot.style():
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.0, 5.0), layout="constrained")
    asp.plot.plot_fitted_paths(fit, ax=left)
    left.set_title("Measured and simulated paths")
    asp.plot.plot_law(fit.law, ax=right, legend=False)
    figure.legend(*right.get_legend_handles_labels(), loc="outside lower center", ncols=4)
    right.set_title("The law that was found")
plt.show()
