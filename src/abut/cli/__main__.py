"""python -m abut.cli"""

import sys

from abut.cli import main

sys.exit(main())
