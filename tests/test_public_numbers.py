"""No public function takes NaN, infinity, masked or complex numbers without a word."""

import itertools

import matplotlib.pyplot as plt
import numpy as np
import pytest
from asperity import AsperityError
from public_calls import calls

CALLS = calls()
NAN, INFINITY = float("nan"), float("inf")
SPOILT = {"nan": NAN, "infinity": INFINITY, "masked": np.ma.masked, "complex": 1.0 + 1.0j}
# A path has gaps, a chart has places without an answer; eigenvalues are complex. Percussions that
# are graded may be those of a solver that failed.
ALLOWED = {
    ("contact.grading.natural_map", "percussion", "nan"),
    ("contact.grading.natural_map", "percussion", "infinity"),
    # Errors that are known have infinitely many.
    ("identify.IdentifiedLaw", "degrees_of_freedom", "infinity"),
    ("track.MeasuredPath", "position", "nan"),
    ("track.MeasuredPath", "position_error", "nan"),
    ("GrowthChart", "growth", "nan"),
    ("plot.plot_growth_chart", "growth", "nan"),
    ("plot.plot_root_locus", "eigenvalues", "complex"),
}


def test_every_public_callable_has_a_valid_call():
    """One without would escape what is tested here: add it to tests/public_calls.py."""
    assert [key for key, call in CALLS.items() if call is None] == []


# Whole films are written by their own tests.
VALID = [key for key, call in CALLS.items() if call and key != "track.VirtualCamera.write"]


@pytest.mark.parametrize("key", VALID)
def test_the_calls_are_valid(key):
    CALLS[key].function(**CALLS[key].arguments())
    plt.close("all")


def spoil(value, bad):
    """Put something bad into the first place of an array, or in the place of a number."""
    value = value.tocsr().toarray() if hasattr(value, "tocsr") else value
    if value is None or np.ndim(value) == 0 or isinstance(value, str):
        return bad
    if bad is np.ma.masked:
        return np.ma.array(value, mask=np.arange(np.size(value)).reshape(np.shape(value)) == 0)
    spoilt = np.array(value, dtype=complex if isinstance(bad, complex) else float)
    spoilt.flat[0] = bad
    return spoilt


@pytest.mark.parametrize("key", [key for key, call in CALLS.items() if call and call.numbers])
def test_what_is_no_number_is_refused_by_name(key):
    call, passed = CALLS[key], []
    for name, kind in itertools.product(call.numbers, SPOILT):
        if (key, name, kind) in ALLOWED:
            continue
        arguments = call.arguments(name)
        spoilt = spoil(arguments.get(name), SPOILT[kind])
        try:
            call.function(**{**arguments, name: spoilt})
        except AsperityError as error:
            if name in (getattr(error, "argument", None), *str(error).split(": ")):
                continue
        passed.append((name, kind))
    assert passed == []
