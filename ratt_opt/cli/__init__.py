"""The command line ``ratt-opt``: parse, call, print.

Open ``program.py`` first: the list of commands, exit codes, errors in one line. A command stands with its kin:
``planning.py`` (demo, bound), ``scenarios.py`` (new, schema), ``attacking.py`` (attack), ``proofs.py`` (verify, audit).
``options.py`` has the options that several commands share, ``terminal.py`` where text goes.
"""

from ratt_opt.cli.program import app, main, run

__all__ = ["app", "main", "run"]
