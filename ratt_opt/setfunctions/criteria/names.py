"""The names of all criteria, for those who only list them: nothing is loaded here."""

from __future__ import annotations

__all__ = ["CLASSES"]

CLASSES = {"trace": "TraceObjective", "logdet": "LogDetObjective", "maxeig": "MaxEigenvalueObjective"}
"""Name of a criterion, and of its file -> its class. A new one is a file beside this one and a name in this line."""
