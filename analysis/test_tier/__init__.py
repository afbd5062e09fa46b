"""Which tests run by default: their costs, the faults they find, and the list that both make."""
