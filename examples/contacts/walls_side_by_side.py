"""What has to be solved again if one of many walls is pushed?
===========================================================

Contacts that do not influence each other fall into islands, and each of them is solved by itself.
Learn how to join problems, how to start from the last solution, and what that saves.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np
from asperity import problems
from scipy.sparse import block_diag

# %%
# A yard of eight walls
# ---------------------
# Any bodies and contacts make a problem: a mass matrix M, directions W, and free velocities Wᵀu.

walls = [problems.wall(rows, columns=2, push=1.0) for rows in range(2, 10)]
yard = asp.ContactProblem.from_bodies(
    block_diag([wall.mass for wall in walls], format="csr"),
    directions=block_diag([wall.directions for wall in walls], format="csr"),
    free_velocity=np.concatenate([wall.free_velocity for wall in walls]),
    laws=[law for wall in walls for law in wall.laws],
)
calm = yard.solve()
print(f"{len(yard.laws)} contacts in {len(calm.islands)} islands")

# %%
# One push more
# -------------
# The fourth wall is loaded a little more. An island that the last percussions solve already is not
# touched.

begin = sum(wall.free_velocity.size for wall in walls[:3])
pushed = np.array(yard.free_velocity)
pushed[begin : begin + walls[3].free_velocity.size] *= 1.1
again = yard.replace(free_velocity=pushed).solve(start=calm)
for island in again.islands:
    print(f"{len(island.contacts):4} contacts: {island.iterations} iterations")

# %%

with asp.plot.style():
    figure, ax = plt.subplots(figsize=(7.6, 4.2), layout="constrained")
    place = np.arange(len(walls))
    for shift, (name, solution) in zip(
        (-0.2, 0.2), (("first solve", calm), ("after the push", again)), strict=True
    ):
        ax.bar(place + shift, [island.iterations for island in solution.islands], 0.4, label=name)
    ax.set_xticks(place, [str(len(island.contacts)) for island in calm.islands])
    ax.set(xlabel="contacts of the wall", ylabel="iterations")
    ax.legend()
plt.show()
