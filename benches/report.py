"""The form in which benches report ratios to performance.py, which writes docs/performance.md."""


def ratio(case: str, value: float, beside: str, meaning: str) -> None:
    """Print a ratio: of what, to what, and what a user learns from it."""
    print(f"ratio\t{case}\t{value:.3f}\t{beside}\t{meaning}", flush=True)
