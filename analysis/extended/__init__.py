"""Extension of the paper's evaluation: ``python -m analysis.extended --trials T --out DIR``."""
