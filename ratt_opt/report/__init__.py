"""Tables and figures from results; nothing is solved here."""
