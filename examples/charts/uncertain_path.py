"""How certain is a sliding path?
==============================

A law was measured, with errors. Learn where a disk may slide under the laws that agree with it.
"""

import tempfile

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np
from asperity import identify, predict, track

SIZE, RUN = 400, {"t_end": 0.32, "u0": [1.28903, 0.80548]}  # 1.52 m/s at 32°

# %%
# A virtual tribometer measures the law of a surface, a virtual camera films a disk on it.
with tempfile.TemporaryDirectory() as folder:
    scenario, file = predict.write_example("sliding point", folder)
    disk = asp.SlidingPoint(0.018, law=asp.FrictionLaw.load(file))
    machine = identify.VirtualTribometer(disk.law, normal_force=9.3, turns=5, seed=1)
    found = identify.fit_law(identify.process(machine.record())).identified_law
    found.save(file)
    region = predict.simulate_scenario(scenario, bands=True).bands.region
run = asp.integrate(disk, **RUN, sample_every=1e-4)
camera = track.VirtualCamera(run, fps=250.0, size=(240, 200), rest=0.0)
film = track.track_mark(camera.frames(), fps=250.0, scene=camera.view, mark=camera.mark).path()
laws = {"law": [found.law, *found.sample(SIZE, seed=2)]}
q = asp.integrate_many(disk, **RUN, replace=laws, keep=0.004).samples["q"]
print(f"the ellipse holds {np.mean([region.contains(end) for end in q[:, -1]]):.1%} of the ends")
with asp.plot.style():
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.0, 4.4), layout="constrained")
    bands = 1e3 * np.quantile((q - q[0])[..., 0], [0.025, 0.975], axis=0)
    left.fill_between(film.time, *bands, alpha=0.3)
    left.plot(film.time, 1e3 * (film.position - q[0])[:, 0], "k.")
    left.set(title="95 % band and film", xlabel="time in s", ylabel="deviation of $x$ in mm")
    right.plot(*1e3 * q[:, -1].T, ".", *1e3 * region.outline().T, "-", *1e3 * film.end, "k*")
    right.legend(["drawn laws", "95 %, by predict", "film"])
    right.set(title="Ends of the paths", xlabel="$x$ in mm", ylabel="$y$ in mm")
plt.show()
