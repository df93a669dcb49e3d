"""How a plot.py, or another script that draws, ends: what its user can mend is one sentence and the exit status 2."""

import os
import sys


def run(main):
    try:
        main()
    except (OSError, ValueError, KeyError, IndexError) as error:
        print(f"{os.path.basename(sys.argv[0])}: {error}", file=sys.stderr)
        sys.exit(2)
