"""What a comparison of two laws and many short runs cost beside the identification of long ones.

Run: python benches/python_laboratory.py [SAMPLES]
"""

import resource
import subprocess
import sys
import tempfile
from pathlib import Path

import asperity as asp
from asperity.identify import VirtualTribometer, write_raw
from report import ratio

LAW = asp.FrictionLaw(asp.Ellipse(0.5, 0.4), asp.Ellipse(3.0, 2.0))
PER_TURN, RUNS = 25_000, 20


def record(folder: Path, samples: int, seed: int) -> Path:
    """Write a run of turns of 25,000 samples with its configuration; return its file."""
    virtual = VirtualTribometer(
        LAW,
        normal_force=10.0,
        turns=samples // PER_TURN,
        turn_rate=0.5,
        sample_rate=0.5 * PER_TURN,
        no_load_time=0.0,
        drift=0.0,
        seed=seed,
    )
    write_raw(virtual.record(), folder)
    return folder / "run_1.csv"


def timed(*words: object) -> float:
    """Return the processor time of a command, which may warn."""
    start = sum(resource.getrusage(resource.RUSAGE_CHILDREN)[:2])
    command = [sys.executable, "-m", "asperity", *map(str, words)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode not in (0, 1) or "Traceback" in done.stderr:
        sys.exit(done.stderr)
    return sum(resource.getrusage(resource.RUSAGE_CHILDREN)[:2]) - start


def identify(runs: list[Path], out: Path) -> float:
    """Return the time of an identification with the configuration of the first run."""
    return timed("identify", *runs, "--config", runs[0].parent / "tribometer.toml", "--out", out)


def main(samples: int = 1_000_000) -> None:
    """Compare two laws; identify one from twenty runs and from one as long as all of them."""
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        pair = [record(folder / f"pair_{k}", samples, k) for k in range(2)]
        alone = sum(identify([run], folder / f"law_{k}") for k, run in enumerate(pair))
        laws = [folder / f"law_{k}" / "law.toml" for k in range(2)]
        compared = timed("compare", *laws, "--out", folder / "comparison")
        ratio(
            f"two laws from {samples:,} samples each and their comparison",
            (alone + compared) / alone,
            "their identification alone",
            "what `asperity compare` adds to `asperity identify`",
        )
        short = [record(folder / f"short_{k}", samples // 10, k) for k in range(RUNS)]
        long = record(folder / "long", samples // 10 * RUNS, RUNS)
        many, one = identify(short, folder / "many"), identify([long], folder / "one")
        ratio(
            f"a law from {RUNS} runs of {samples // 10:,} samples",
            many / one,
            "one from a run as long as all of them",
            "what mountings cost",
        )
        print(f"identify {alone:.1f} s, compare {compared:.1f} s; runs {many:.1f} s, {one:.1f} s")


if __name__ == "__main__":
    main(*(int(number) for number in sys.argv[1:]))
