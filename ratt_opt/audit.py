"""The audit of the paper's proof, which is a package of its own: ``ratt_audit``."""

from ratt_audit.ledger import Ledger, run_audit

__all__ = ["Ledger", "run_audit"]
