"""Which solver is the fastest for my problem?
===========================================

``Auto`` is the one to begin with; the others are there for special problems and for comparison.
Learn how to choose one, how far each gets within a time limit, and who judges the result.
"""

import time

import asperity as asp
import matplotlib.pyplot as plt
from asperity import problems

# %%
# Three problems
# --------------
# A stack and a wall, whose contacts carry each other, and sliders that hardly do.

law = asp.FrictionLaw.associated(asp.Ellipse(0.6, 0.3))
scenes = {
    "100 sliders": problems.sliders(100, law=law),
    "stack of 6": problems.stack(6, push=1.0, law=law),
    "wall of 4 rows": problems.wall(4, columns=3, push=2.0, law=law),
}
solvers = [
    asp.Auto(),
    asp.Exact(),
    asp.SemismoothNewton(),
    asp.ProximalPoint(),
    asp.InteriorPoint(),
    asp.ADMM(),
    asp.ProxGaussSeidel(),
    asp.ProxJacobi(),
]

# %%
# Each of them on each problem
# ----------------------------
# With ``on_failure="record"`` a solve that does not converge is returned with its status. The
# residual is computed from the percussions, by the same function for all solvers.

table = {}
for scene, problem in scenes.items():
    print(scene)
    for solver in solvers:
        begin = time.perf_counter()
        solution = problem.solve(solver, tolerance=1e-8, time_limit=0.5, on_failure="record")
        took = time.perf_counter() - begin
        name = type(solver).__name__
        table[scene, name] = took, solution.status
        words = solution.status.name.lower().replace("_", " ")
        print(f"  {name:17} {1e3 * took:7.1f} ms  residual {solution.residual:.0e}  {words}")

# %%
# Times
# -----
# Open circles did not reach the tolerance, within their own limits or 0.5 s. ``Auto`` begins with
# sweeps, which cost it some milliseconds on the stack, and is the one that gives up on nothing.

with asp.plot.style():
    size = {"figsize": (11.0, 3.8), "layout": "constrained"}
    figure, axes = plt.subplots(1, 3, sharex=True, sharey=True, **size)
    for ax, scene in zip(axes, scenes, strict=True):
        for row, solver in enumerate(solvers):
            took, status = table[scene, type(solver).__name__]
            done = status is asp.Status.CONVERGED
            color = "#0072B2" if row else "#D55E00"
            ax.plot(1e3 * took, row, "o", color=color, fillstyle="full" if done else "none")
        ax.set(title=scene, xlabel="time in ms", xscale="log", xlim=(0.1, 2000.0))
    axes[0].set_yticks(range(len(solvers)), [type(solver).__name__ for solver in solvers])
    axes[0].invert_yaxis()
plt.show()
