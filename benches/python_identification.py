"""Time and memory of the identification of a long record: 10⁷ samples, 1,000 s at 10 kHz.

Run: python benches/python_identification.py [TURNS]
"""

import resource
import sys
import time

import asperity as asp
import numpy as np
from asperity.identify import VirtualTribometer, fit_law, process
from report import ratio

TURN_RATE, SAMPLE_RATE = 0.16, 1e4


def memory() -> float:
    """Return the largest memory so far in GB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6


def main(turns: int = 160) -> None:
    """Record, process and fit; the floor is one pass of NumPy over the readings."""
    law = asp.FrictionLaw(
        asp.Superellipse(4.99 / 9.3, 4.25 / 9.3, 2.94), asp.Superellipse(1.84, 1.19, 2.51)
    )
    rig = VirtualTribometer(
        law, normal_force=9.3, turns=turns, turn_rate=TURN_RATE, sample_rate=SAMPLE_RATE, seed=1
    )
    raw = rig.record()
    readings = raw.recordings[0].readings
    start = time.perf_counter()
    np.cos(readings)
    floor = time.perf_counter() - start
    print(f"{len(readings):,} samples, {memory():.2f} GB with the record")
    start = time.perf_counter()
    data = process(raw)
    processed = time.perf_counter()
    fit = fit_law(data)
    fitted = time.perf_counter()
    print(f"process {processed - start:.2f} s, fit {fitted - processed:.2f} s, ", end="")
    print(f"together {(fitted - start) / floor:.0f} times the cosine of the readings")
    print(f"largest memory {memory():.2f} GB (allowed 2); time allowed 10 s")
    ratio(
        f"a law with intervals from {len(readings):,} samples",
        (fitted - start) / floor,
        "one pass of NumPy's cosine over the readings",
        "what a record costs from its readings to the law",
    )
    for name, estimate in fit.parameters.items():
        print(f"  {name}: {estimate.value:.6g}")


if __name__ == "__main__":
    main(*(int(turns) for turns in sys.argv[1:]))
