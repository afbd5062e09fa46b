"""RATT without a centre: the team plans by messages between neighbours.

Open ``agent.py`` first: one robot as a state machine without a clock. ``messages.py`` has its messages with their
sizes, ``channel.py`` lets each arrive once and in order, ``view.py`` finds component and tree from the link records,
and ``knowledge.py`` has the data of one robot. Two drivers run the same agent: ``simulator.py``, for which
``faults.py`` says what goes wrong, and ``processes.py``, real processes on loopback. ``plan.py`` is the door:
:func:`decentralised_ratt`.
"""
