"""Brackets of marginals by separable minorants."""
