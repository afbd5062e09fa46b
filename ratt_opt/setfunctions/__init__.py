"""Set functions, their properties with witnesses, and their curvatures."""
