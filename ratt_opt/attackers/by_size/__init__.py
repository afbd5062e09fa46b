"""Worst attacks on complete graphs, where outcomes differ by their group sizes."""
