"""The best few links to protect or to add: every known attack that they do not block is still possible.

Open ``best_links.py`` first: the public functions, and the loop of choosing links and attacking the team that has them.
``upgrades.py`` says what protecting and adding change for the adversary, ``known_attacks.py`` what an attack keeps of
its strength, and ``choice_search.py`` finds the links that block the worst of the attacks known.
"""
