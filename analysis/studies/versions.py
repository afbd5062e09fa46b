"""The versions that a row depends on; also how a remote worker proves that it has the package."""

from __future__ import annotations

import platform

import numpy as np

import ratt_opt

__all__ = ["VERSIONS"]

VERSIONS = f"ratt_opt {ratt_opt.__version__}, numpy {np.__version__}, python {platform.python_version()}"
