"""Short tier of tests: their costs, the faults they find, and the list that both make."""
