"""The exact max-min search."""
