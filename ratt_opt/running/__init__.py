"""Running code here: interrupts, worker processes, progress."""
