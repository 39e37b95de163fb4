"""Zero-phase low-pass filter."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.errors import ParameterError

# Reflected samples at either end, in periods of the cut-off frequency.
_PADDING = 3.0


def low_pass(
    values: ArrayLike,
    *,
    sample_rate: float,
    cut_off: float,
    order: int = 4,
    cut_off_of: str = "single",
) -> Array:
    """Return a signal after a Butterworth filter that ran forwards and backwards, without delay.

    The amplitude is multiplied by |H|², H the response of one pass. A record of 60 s or of 30
    periods of the cut-off frequency has a middle that does not feel its ends.

    Args:
        values: evenly sampled signal, time first; shape ``(n, ...)``.
        sample_rate: in Hz.
        cut_off: cut-off frequency in Hz, below half the sample rate.
        order: of one pass.
        cut_off_of: ``"single"``: at the cut-off one pass has 1/√2 of the amplitude and both passes
            have 1/2; ``"double"``: both passes together have 1/√2.

    Raises:
        ParameterError: if the cut-off is not below half the sample rate.

    >>> import numpy as np
    >>> from asperity.identify import low_pass
    >>> t = np.arange(60_000) / 1000.0
    >>> smooth = low_pass(np.sin(2.0 * np.pi * t), sample_rate=1000.0, cut_off=1.0)
    >>> round(float(smooth[30_250]), 6)
    0.5
    """
    from scipy.signal import sosfiltfilt

    signal = arrays.array(values, "values")
    sections = butterworth(sample_rate, cut_off, order=order, cut_off_of=cut_off_of)
    if signal.ndim == 0 or len(signal) < 2:
        raise ParameterError("values", "must hold two samples or more")
    padding = min(math.ceil(_PADDING * sample_rate / cut_off), len(signal) - 1)
    return np.asarray(sosfiltfilt(sections, signal, axis=0, padlen=padding), dtype=np.float64)


def butterworth(
    sample_rate: float, cut_off: float, *, order: int = 4, cut_off_of: str = "single"
) -> Array:
    """Return the second-order sections of one pass of `low_pass`, shape ``(m, 6)``.

    >>> from asperity.identify.forces.filters import butterworth
    >>> butterworth(1000.0, 10.0).shape
    (2, 6)
    """
    from scipy.signal import butter

    rate = arrays.positive(sample_rate, "sample_rate")
    frequency = arrays.positive(cut_off, "cut_off")
    order = arrays.count(order, "order")
    arrays.choice(cut_off_of, "cut_off_of", ("single", "double"))
    if frequency >= 0.5 * rate:
        raise ParameterError(
            "cut_off", f"must lie below half the sample rate of {rate:.6g} Hz, got {cut_off!r}"
        )
    if cut_off_of == "double":
        # 1/(1 + w²ⁿ) = 1/√2 at the cut-off of both passes, w being warped by the bilinear rule.
        warped = math.tan(math.pi * frequency / rate) / (math.sqrt(2.0) - 1.0) ** (0.5 / order)
        frequency = math.atan(warped) * rate / math.pi
    sections = butter(order, frequency, fs=rate, output="sos")
    return np.asarray(sections, dtype=np.float64)
