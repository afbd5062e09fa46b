"""How code runs here: interrupts answered, worker processes, progress told."""
