"""Choose what to protect: robots and links ranked, and the best few to protect or to add.

Open ``criticality.py`` first: it ranks one robot or link at a time. ``robot_choice.py`` and ``best_links.py`` choose
several: every known attack that a choice does not block is still possible. ``upgrades.py`` says what protecting and
adding change for the adversary, ``known_attacks.py`` what an attack keeps of its strength, and ``choice_search.py``
finds the links that block the worst of the attacks known.
"""
