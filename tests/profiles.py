"""What `make test` takes of what only repeats one property; `make long` takes the others."""

import pytest


def every(step, cases):
    """Return the cases of a parametrisation, all but every n-th of them marked `long`."""
    return [
        case if k % step == 0 else pytest.param(*_values(case), marks=pytest.mark.long)
        for k, case in enumerate(cases)
    ]


def _values(case):
    return case if isinstance(case, tuple) else (case,)


def counts(few, many):
    """Parametrise a test by how many random cases it tries: few, and many if it takes long."""
    return pytest.mark.parametrize("count", [few, pytest.param(many, marks=pytest.mark.long)])
