"""The compiled loops: C, compiled when the package is installed, and the functions that check what they are given."""
