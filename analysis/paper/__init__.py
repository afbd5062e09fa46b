"""Section VI of the paper, figure by figure: ``python -m analysis.paper --trials T --out DIR``."""
