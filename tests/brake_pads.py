"""Pads of trilinear bricks on a moving surface, and their eigenvalues by dense matrices."""

from itertools import product

import asperity as asp
import numpy as np
import scipy.linalg
import scipy.sparse as sp


def brick(edges, *, modulus, poisson, density):
    """Return K and M of one element, 24 coordinates, by 2 × 2 × 2 points of Gauss."""
    shear = modulus / (2.0 * (1.0 + poisson))
    lame = 2.0 * shear * poisson / (1.0 - 2.0 * poisson)
    elastic = np.diag([2.0 * shear] * 3 + [shear] * 3)
    elastic[:3, :3] += lame
    corners = np.array(list(product((-1.0, 1.0), repeat=3)))
    half = np.array(edges) / 2.0
    K, M = np.zeros((2, 24, 24))
    for point in product((-1.0, 1.0), repeat=3):
        factors = 1.0 + corners * point / np.sqrt(3.0)
        shape = factors.prod(axis=1) / 8.0
        slope = np.stack(
            [corners[:, k] * np.delete(factors, k, axis=1).prod(axis=1) for k in range(3)], axis=1
        ) / (8.0 * half)
        B = np.zeros((6, 8, 3))
        for row, k in enumerate(range(3)):
            B[row, :, k] = slope[:, k]
        for row, (j, k) in enumerate(((0, 1), (1, 2), (2, 0)), start=3):
            B[row, :, j], B[row, :, k] = slope[:, k], slope[:, j]
        B = B.reshape(6, 24)
        K += B.T @ elastic @ B * half.prod()
        M += density * np.kron(np.outer(shape, shape), np.eye(3)) * half.prod()
    return K, M


def pad(cells, *, contacts=None, pressure=5e5, spring=3e7):
    """Return M, C, K, f, positions and contact nodes of a pad held by springs and pressed down.

    A row of oblique springs at the end couples motions along the surface and normal to it.
    """
    size, cells = np.array([0.08, 0.04, 0.015]), np.array(cells)
    element_K, element_M = brick(size / cells, modulus=4e9, poisson=0.3, density=2500.0)
    number = np.arange((cells + 1).prod()).reshape(cells + 1)
    corners = np.stack(
        [
            number[a : cells[0] + a, b : cells[1] + b, c : cells[2] + c].ravel()
            for a, b, c in product((0, 1), repeat=3)
        ],
        axis=1,
    )
    places = (3 * corners[:, :, None] + np.arange(3)).reshape(len(corners), 24)
    n = 3 * number.size
    rows, columns = np.repeat(places, 24, axis=1).ravel(), np.tile(places, (1, 24)).ravel()
    K, M = (
        sp.csc_array((np.tile(part.ravel(), len(places)), (rows, columns)), shape=(n, n))
        for part in (element_K, element_M)
    )
    top, end, bottom = number[:, :, -1].ravel(), number[-1, :, cells[2] // 2], number[:, :, 0]
    held = np.zeros(n)
    for k, share in enumerate((1.0, 1.0, 0.3)):
        held[3 * top + k] = share * spring / len(top)
    oblique = np.array([np.cos(0.6), 0.0, np.sin(0.6)])
    ends = sp.lil_array((n, n))
    for node in end:
        part = np.ix_(3 * node + np.arange(3), 3 * node + np.arange(3))
        ends[part] = 3.0 * spring / len(end) * np.outer(oblique, oblique)
    K = (K + sp.diags_array(held) + ends).tocsc()
    K, M = 0.5 * (K + K.T), 0.5 * (M + M.T)
    f = np.zeros(n)
    f[3 * top + 2] = -pressure * size[0] * size[1] / len(top)
    nodes = bottom.ravel()
    if contacts is not None:
        nodes = nodes[np.linspace(0, len(nodes) - 1, contacts).astype(int)]
    positions = np.stack(np.unravel_index(np.arange(number.size), cells + 1), axis=1) * size / cells
    return M, 1e-8 * K + 2.0 * M, K, f, positions, nodes


def pad_system(cells, law, *, phi=0.0, speed=5.0, contacts=None, disc=False, tilt=0.0, gap=0.0):
    """Return the pad on a surface that moves along φ, or on a disc."""
    M, C, K, f, positions, nodes = pad(cells, contacts=contacts)
    coordinates = 3 * nodes[:, None] + np.arange(3)
    # A force at the top beside the pressure, which lifts one end.
    f[3 * len(positions) - 1] += tilt
    if disc:
        mesh = asp.MeshContacts.on_disc(
            law,
            coordinates=coordinates,
            positions=positions[nodes],
            rate=[0.0, 0.0, 60.0],
            centre=[0.04, -0.1, 0.0],
            circumferential=True,
            gap=gap,
        )
    else:
        velocity = speed * np.array([np.cos(phi), np.sin(phi), 0.0])
        mesh = asp.MeshContacts(law, coordinates=coordinates, velocity=velocity, gap=gap)
    return asp.LinearSystem(M, damping=C, stiffness=K, force=f, contacts=mesh)


def saddle(system, steady):
    """Return C with the friction of the closed contacts, E and W_N, contact by contact.

    Derivatives of the friction force are differences of the force.
    """
    mesh, n = system.contacts[0], system.dof
    closed = list(steady.closed)
    W, E = (sp.lil_array((n, len(closed))) for _ in range(2))
    C = system.damping.tolil()
    for column, i in enumerate(closed):
        place, axes, slip = mesh.coordinates[i], mesh.axes[i], mesh.slip[i]
        for row, normal, push in zip(
            place, axes[2], axes[2] + mesh.law.force(slip) @ axes[:2], strict=True
        ):
            W[row, column], E[row, column] = normal, push
        h = 1e-5 * np.linalg.norm(slip)
        slopes = [
            (mesh.law.force(slip + h * unit) - mesh.law.force(slip - h * unit)) / (2.0 * h)
            for unit in np.eye(2)
        ]
        block = steady.normal_force[i] * axes[:2].T @ np.stack(slopes, axis=1) @ axes[:2]
        for a in range(3):
            for b in range(3):
                C[place[a], place[b]] -= block[a, b]
    return C.tocsc(), E.tocsc(), W.tocsc()


def eigenvalues_near(system, steady, shift, count):
    """Return eigenvalues near a shift by SciPy's LU of the whole saddle matrix and ARPACK."""
    from scipy.sparse.linalg import LinearOperator, eigs, splu

    C, E, W = saddle(system, steady)
    M, K, n, m = system.mass, system.stiffness, system.dof, E.shape[1]
    size = abs(K).max()
    # The multipliers in units of the stiffness.
    whole = sp.block_array([[shift**2 * M + shift * C + K, -size * E], [size * W.T, None]])
    lu = splu(whole.tocsc().astype(complex))

    def inverted(x):
        a, b = np.split(x.ravel(), 2)
        right = -abs(shift) * (M @ b) - C @ a - shift * (M @ a)
        y = lu.solve(np.concatenate([right, np.zeros(m)]).astype(complex))[:n]
        return np.concatenate([y, (shift * y + a) / abs(shift)])

    operator = LinearOperator((2 * n, 2 * n), matvec=inverted, dtype=complex)
    return shift + 1.0 / eigs(operator, k=count, which="LM", return_eigenvectors=False)


def dense_eigenvalues(system, steady):
    """Return all eigenvalues with |s| below 10⁸, by QZ of the linearised saddle pencil."""
    M, K = (part.toarray() for part in (system.mass, system.stiffness))
    C, E, W = (part.toarray() for part in saddle(system, steady))
    n, m = E.shape
    # State (q, q̇/unit, λ), in units of one size.
    unit, stiff, zero = 1e5, np.abs(K).max(), np.zeros
    left = np.block(
        [
            [zero((n, n)), unit * np.eye(n), zero((n, m))],
            [-K / stiff, -unit * C / stiff, E],
            [W.T, zero((m, n)), zero((m, m))],
        ]
    )
    right = scipy.linalg.block_diag(np.eye(n), unit * M / stiff, zero((m, m)))
    values = scipy.linalg.eigvals(left, right)
    return values[np.isfinite(values) & (np.abs(values) < 1e8)]
