"""What the library does without being asked is written to the logger ``asperity``.

Nothing is shown unless the program that uses the library asks for it:
``logging.basicConfig(level=logging.INFO)``.
"""

from __future__ import annotations

import logging

log = logging.getLogger("asperity")
"""The logger: warnings tell of results to doubt, information of decisions, the rest is detail."""
log.addHandler(logging.NullHandler())
