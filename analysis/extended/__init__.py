"""What the paper could not show: ``python -m analysis.extended --trials T --out DIR``."""
