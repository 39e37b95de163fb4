"""In which directions does a pad squeal?
======================================

A brake pad of finite elements lies on a moving surface. Learn from which friction on it squeals,
in which sliding directions, and which of its modes do.
"""

from itertools import product

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np
import scipy.sparse as sp

# %%
# The pad
# -------
# Bricks of a friction material; matrices of a finite-element code would come from its files.

cells, size = np.array([6, 3, 2]), np.array([0.08, 0.04, 0.015])
half = size / cells / 2.0
corners = np.array(list(product((-1.0, 1.0), repeat=3)))
shear, lame = 4e9 / 2.6, 4e9 * 0.3 / (1.3 * 0.4)
K_brick, M_brick = np.zeros((2, 24, 24))
for point in corners / np.sqrt(3.0):
    factors = (1.0 + corners * point) / 2.0
    slopes = corners / (2.0 * half) * factors[:, [1, 2, 0]] * factors[:, [2, 0, 1]]
    # λ tr(ε)² + 2 G ε:ε in displacements of the corners, and their mass.
    spread = shear * np.einsum("ik,jk->ij", slopes, slopes)[:, None, :, None] * np.eye(3)[:, None]
    spread = spread + lame * np.einsum("ik,jl->ikjl", slopes, slopes)
    spread = spread + shear * np.einsum("il,jk->ikjl", slopes, slopes)
    K_brick += spread.reshape(24, 24) * half.prod()
    shape = factors.prod(axis=1)
    M_brick += 2500.0 * np.kron(np.outer(shape, shape), np.eye(3)) * half.prod()

nodes = np.arange((cells + 1).prod()).reshape(cells + 1)
starts = [slice(0, -1), slice(1, None)]
bricks = np.stack(
    [nodes[starts[a], starts[b], starts[c]].ravel() for a, b, c in product((0, 1), repeat=3)],
    axis=1,
)
places = (3 * bricks[:, :, None] + np.arange(3)).reshape(len(bricks), 24)
rows, columns = np.repeat(places, 24, axis=1).ravel(), np.tile(places, (1, 24)).ravel()
n = 3 * nodes.size
K, M = (
    sp.coo_array((np.tile(part.ravel(), len(bricks)), (rows, columns)), shape=(n, n)).tocsc()
    for part in (K_brick, M_brick)
)
K, M = 0.5 * (K + K.T), 0.5 * (M + M.T)

# %%
# How it is held and pressed
# --------------------------
# Springs hold the back; an oblique one at the end couples motions along the surface and across it.

back, end, bottom = nodes[:, :, -1].ravel(), nodes[-1, :, 1], nodes[:, :, 0].ravel()
springs = np.zeros(n)
for k, share in enumerate((3e7, 3e7, 9e6)):
    springs[3 * back + k] = share / len(back)
oblique = np.zeros((n, len(end)))
oblique[3 * end, np.arange(len(end))] = np.cos(0.6)
oblique[3 * end + 2, np.arange(len(end))] = np.sin(0.6)
K = sp.csc_array(K + sp.diags_array(springs) + 9e7 / len(end) * sp.csc_array(oblique @ oblique.T))
pressed = np.zeros(n)
pressed[3 * back + 2] = -1600.0 / len(back)
contacts = asp.MeshContacts(
    asp.FrictionLaw.isotropic(1.0),
    coordinates=3 * bottom[:, None] + np.arange(3),
    velocity=[5.0, 0.0, 0.0],
)
pad = asp.LinearSystem(M, damping=3e-8 * K, stiffness=K, force=pressed, contacts=contacts)

# %%
# The map
# -------
# A dozen solutions of the whole model or fewer make a basis for all points. With μ = 1 in the law
# the factor of friction is the coefficient.

band = (2.0 * np.pi * 300.0, 2.0 * np.pi * 14e3)
friction = np.linspace(0.1, 0.9, 17)
chart = asp.squeal_map(
    pad,
    parameters={"friction": friction, "phi": np.deg2rad(np.arange(0.0, 181.0, 7.5))},
    band=band,
)
print(chart.summary())
aside = pad.varied(phi=np.deg2rad(75.0))
line = asp.squeal_map(
    aside, parameters={"friction": np.linspace(0.02, 0.9, 67)}, band=(band[0], 2e4)
)

with asp.plot.style():
    figure, (left, right) = plt.subplots(1, 2, figsize=(11.0, 4.2), layout="constrained")
    asp.plot.plot_squeal_map(chart, ax=left)
    left.set_title("Largest growth rate and its border")
    asp.plot.plot_squeal_map(line, ax=right)
    right.set_title("Modes below 3.2 kHz at 75°: one of them grows")
plt.show()
