"""What the library does without being asked is written to the logger ``asperity``.

Nothing is shown unless the program that uses the library asks for it:
``logging.basicConfig(level=logging.INFO)``.
"""

from __future__ import annotations

import logging

log = logging.getLogger("asperity")
"""The logger: warnings for doubtful results, information for decisions, debug for the rest."""
log.addHandler(logging.NullHandler())
