"""Worst attacks on other graphs, by partitions of the team into groups."""
