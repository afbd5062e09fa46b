"""Benchmarks: each prints ratios against a named plain version in the same run."""
