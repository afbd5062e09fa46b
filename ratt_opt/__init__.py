"""Plan robot teams that keep tracking targets under attack, and prove how good each plan is.

Every public name stands in ``__init__.pyi`` and is loaded on first use: importing ``ratt_opt`` stays
light, and the certificate verifier shares no import with the solvers whose claims it checks.
"""

from pathlib import Path

import lazy_loader

from ratt_opt._topics import as_text, names_of, read_topics

__getattr__, __dir__, _ = lazy_loader.attach_stub(__name__, __file__)
TOPICS = read_topics(Path(__file__).with_suffix(".pyi").read_text(encoding="utf-8"))
__all__ = names_of(TOPICS)  # noqa: PLE0605  (the call returns a list)
__doc__ = (
    f"{__doc__}\nThe names by topic, as ``ratt_opt.TOPICS`` and ``ratt_opt.__all__`` have them:\n\n{as_text(TOPICS)}"
)
