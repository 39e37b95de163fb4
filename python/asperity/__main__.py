"""``python -m asperity``."""

import sys

from asperity.commands.main import main

sys.exit(main())
