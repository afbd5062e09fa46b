"""What the searches answered on a fixed corpus, and what they answer now: so that they can be rebuilt safely."""
