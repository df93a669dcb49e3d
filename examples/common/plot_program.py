"""How a plot.py ends: what its user can mend is one sentence and the exit status 2."""

import sys


def run(main):
    try:
        main()
    except (OSError, ValueError, KeyError, IndexError) as error:
        print(f"plot.py: {error}", file=sys.stderr)
        sys.exit(2)
