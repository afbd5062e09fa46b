"""Upper bounds on what any plan can reach, and guarantees known before planning."""
