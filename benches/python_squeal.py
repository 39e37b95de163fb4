"""Eigenvalues of a sliding pad beside what SciPy does by hand, a map of them, those of dense pads.

Run: python benches/python_squeal.py [nx ny nz contacts], by default 22 11 7 100 (6,624
coordinates); each part in a process of its own, for its peak of memory.
"""

import resource
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as sl

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

MU, SPEED, SHIFT, COUNT = 0.5, 5.0, 2j * np.pi * 3e3, 20


def by_hand(cells: list[int], contacts: int) -> float:
    """Eliminate the normal coordinates of closed contacts, then SciPy's LU and ARPACK as they are.

    Isotropic friction along x; no contact opens.
    """
    from brake_pads import pad

    M, C, K, f, _, nodes = pad(cells, contacts=contacts)
    start, n, held = time.process_time(), len(f), 3 * nodes + 2
    free = np.setdiff1d(np.arange(n), held)
    rows = sp.identity(n, format="lil")
    for i in held:
        rows[i - 2, i] = -MU
    M, C, K_friction = ((rows.tocsr() @ part).tocsr()[free][:, free].tocsc() for part in (M, C, K))
    q = np.zeros(n)
    q[free] = sl.spsolve(K_friction, (rows.tocsr() @ f)[free])
    load = (K @ q - f)[held]
    turning = np.zeros(n)
    turning[held - 1] = MU * load / SPEED
    C = (C + sp.diags_array(turning[free])).tocsc()
    lu = sl.splu((SHIFT**2 * M + SHIFT * C + K_friction).tocsc())

    def inverted(x: np.ndarray) -> np.ndarray:
        a, b = np.split(x, 2)
        y = lu.solve(-(M @ b) - (C + SHIFT * M) @ a)
        return np.concatenate([y, SHIFT * y + a])

    size = 2 * len(free)
    sl.eigs(sl.LinearOperator((size, size), matvec=inverted, dtype=complex), k=COUNT)
    return time.process_time() - start


def asperity(cells: list[int], contacts: int) -> float:
    """Return the time of equilibrium and eigenvalues with all outputs."""
    import asperity as asp
    from brake_pads import pad_system

    system = pad_system(cells, asp.FrictionLaw.isotropic(MU), speed=SPEED, contacts=contacts)
    start = time.process_time()
    asp.stability(system, near=SHIFT.imag, count=COUNT).summary()
    return time.process_time() - start


def certified(cells: list[int], contacts: int) -> float:
    """Return the time of these eigenvalues with the count of missing ones."""
    import asperity as asp
    from brake_pads import pad_system

    system = pad_system(cells, asp.FrictionLaw.isotropic(MU), speed=SPEED, contacts=contacts)
    start = time.process_time()
    found = asp.stability(system, near=SHIFT.imag, count=COUNT, certify=True)
    assert "no eigenvalue missing" in found.summary()
    return time.process_time() - start


def mapped(cells: list[int], contacts: int) -> float:
    """Return the time of a map of 91 directions and 21 coefficients of friction to 15 kHz."""
    import asperity as asp
    from brake_pads import pad_system

    system = pad_system(cells, asp.FrictionLaw.isotropic(1.0), speed=SPEED, contacts=contacts)
    start = time.process_time()
    asp.squeal_map(
        system,
        parameters={"friction": np.linspace(0.1, 0.9, 21), "phi": np.deg2rad(np.arange(0, 181, 2))},
        band=(2 * np.pi * 300, 2 * np.pi * 15e3),
    ).summary()
    return time.process_time() - start


def dense(cells: tuple[int, int, int]) -> None:
    """Compare the stability of a dense pad with the eigenvalues of its matrix by NumPy."""
    import asperity as asp
    from brake_pads import pad_system

    system = pad_system(cells, asp.FrictionLaw.isotropic(MU)).dense()
    start = time.process_time()
    found = asp.stability(system)
    middle = time.process_time()
    _ = found.reason
    end = time.process_time()
    np.linalg.eigvals(found.first_order_matrix)
    floor = time.process_time() - end
    print(
        f"{system.dof} dense coordinates: {middle - start:.2f} s, {(middle - start) / floor:.1f} "
        f"times the eigenvalues alone; reasons {end - middle:.2f} s"
    )


PARTS = {
    "by hand": by_hand,
    "asperity": asperity,
    "with a certificate": certified,
    "map of 1911": mapped,
}

if __name__ == "__main__":
    if sys.argv[1:2] == ["part"]:
        *cells, contacts = map(int, sys.argv[3:])
        seconds = PARTS[sys.argv[2]](cells, contacts)
        print(seconds, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6)
    else:
        size = sys.argv[1:] or ["22", "11", "7", "100"]
        for part in PARTS:
            command = [sys.executable, __file__, "part", part, *size]
            done = subprocess.run(command, check=True, capture_output=True, text=True).stdout
            seconds, memory = map(float, done.split())
            print(f"{part}: {seconds:.2f} s of processor, peak {memory:.2f} GB")
        for cells in ((3, 3, 2), (5, 3, 4)):
            dense(cells)
