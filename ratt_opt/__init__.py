"""Plan robot teams that keep tracking targets under attack, and prove how good each plan is.

Every public name stands in ``__init__.pyi`` and is loaded on first use: importing ``ratt_opt`` stays
light, and the certificate verifier shares no import with the solvers whose claims it checks.
"""


def __getattr__(name: str) -> object:
    # The stub is read on first use too, so that an interrupt just after the start of a command finds its guards.
    import lazy_loader

    from ratt_opt._cache import provide_cache

    provide_cache()
    load, names, every = lazy_loader.attach_stub(__name__, __file__)
    globals().update(__getattr__=load, __dir__=names, __all__=every)
    return every if name == "__all__" else load(name)


def __dir__() -> list[str]:
    return list(__getattr__("__all__"))  # type: ignore[call-overload, no-any-return]
