"""Plan robot teams that keep tracking targets under attack, and prove how good each plan is.

Every public name stands in ``__init__.pyi``, by topic (``ratt_opt.TOPICS``), and is loaded on first use: importing
``ratt_opt`` stays light, and the certificate verifier shares no import with the solvers whose claims it checks.
"""


def __getattr__(name: str) -> object:
    # The stub is read on first use too, so that an interrupt just after the start of a command finds its guards.
    from pathlib import Path

    import lazy_loader

    from ratt_opt.running.interrupts import interrupts_between_packages
    from ratt_opt.running.topics import names_of, read_topics

    attached, names, _ = lazy_loader.attach_stub(__name__, __file__)

    def load(name: str) -> object:
        return interrupts_between_packages(attached, name)

    topics = read_topics(Path(__file__).with_suffix(".pyi").read_text(encoding="utf-8"))
    globals().update(__getattr__=load, __dir__=names, TOPICS=topics, __all__=names_of(topics))
    return globals()[name] if name in ("TOPICS", "__all__") else load(name)


def __dir__() -> list[str]:
    return list(__getattr__("__all__"))  # type: ignore[call-overload, no-any-return]
