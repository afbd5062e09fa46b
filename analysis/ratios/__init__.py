"""Ratios beyond the library's: the best of three planners, exchanges, and bad instances of larger teams."""
