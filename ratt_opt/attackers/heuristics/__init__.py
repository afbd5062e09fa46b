"""Attacks without a claim: bounded-rational (the paper's), greedy, random; the state they share."""
