"""Plan robot teams that keep tracking targets under attack, and prove how good each plan is.

Every public name stands in ``__init__.pyi`` and is loaded on first use: importing ``ratt_opt`` stays
light, and the certificate verifier shares no import with the solvers whose claims it checks.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
