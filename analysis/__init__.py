"""Studies that reproduce the paper and go past it; not installed.

An interrupt (Ctrl-C) ends each of its programs with one line and 130, also while modules are still imported.
"""

import sys
from types import TracebackType

INTERRUPTED = 130


def _end(kind: type[BaseException], error: BaseException, traceback: TracebackType | None) -> None:
    """Print an uncaught error: one line for an interrupt, all else as Python shows it."""
    if not _is_interrupt(error):
        sys.__excepthook__(kind, error, traceback)
        return
    print("error: interrupted", file=sys.stderr, flush=True)
    sys.exit(INTERRUPTED)


def _is_interrupt(error: BaseException | None) -> bool:
    """Tell whether an error comes from an interrupt, such as that of an import it broke off."""
    while error is not None and not isinstance(error, KeyboardInterrupt):
        error = error.__cause__ or error.__context__
    return error is not None


sys.excepthook = _end
