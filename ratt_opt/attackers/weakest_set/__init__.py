"""The k robots of one plan that are worth least: bounds, enumeration, exchanges, branch and bound."""
