"""The version, stated once: the build reads it from here."""

__version__ = "1.0.0"

CITATION = f"ratt-opt {__version__} (CITATION.cff); method: L. Zhou and V. Kumar, arXiv:2109.09838"
"""Citation that reports print."""
