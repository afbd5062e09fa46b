"""What was found, as data: below what draws it and what hands it to the user."""
