"""``python -m ratt_opt`` is ``ratt-opt``."""

from ratt_opt.cli import main

main()
