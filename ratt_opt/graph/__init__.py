"""The communication graph: how cut links split a team into groups."""
