"""Players of a mission: planners, attackers, and the duration of attacks.

Open ``planners.py`` first: the library's planners by name, and the user's own; ``attackers.py`` is the same of
attackers, ``attack_models.py`` says what an attack leaves behind: nothing, itself for some steps, or failures.
"""
