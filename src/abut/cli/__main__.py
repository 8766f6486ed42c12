"""python -m abut.cli"""

import sys

from abut.__main__ import main

sys.exit(main())
