"""``python -m tests.studies.run_toy --out DIR``: the toy study from the command line."""

import sys

from ratt_opt.studies.command import Entry, main
from tests.studies.toy import STUDY

if __name__ == "__main__":
    sys.exit(main("The toy study.", [Entry(STUDY, lambda rows, folder: print(len(rows), folder.name))], trials=3))
