"""Golden corpus: the recorded answers of the searches, compared with today's, so that they can be rebuilt safely."""
