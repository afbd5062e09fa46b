"""The inner minimisation: attacks on a given plan."""
