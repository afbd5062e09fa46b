"""The physical model: robots, targets and sensors that become a problem.

Open ``model.py`` first: ``Scenario`` and what it computes (predictions, information matrices). ``problem_record.py``
has what it shares with ``information_input.py`` (matrices in place of physics), ``record.py`` the base of every
file's content. ``sensor.py`` and ``motion.py`` are the physics, ``simulation.py`` draws what could really happen.
Scenarios come from ``files.py``, ``limited_view.py`` (random, sensors that turn), ``generator.py`` (random, the
paper's), ``networks.py`` (random, on the networks of radio teams), ``on_graph.py`` (on a given graph, as that of
``graph_files.py``) or ``mrclam.py`` (real robots); plans from ``plan_file.py``.
"""
