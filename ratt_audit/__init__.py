"""The paper's proof as data, decided by machine; open ``ledger.py`` first.

``entries.py`` lists what is decided, ``decisions.py`` decides one entry, and ``whole_lines.py`` asks whether a refuted
line also fails in a whole instance.

``appendix/`` and ``enumeration/`` say what the paper claims; ``engine/`` decides claims about all set functions of a
class; ``real_objectives/`` tries them on EKF objectives; ``report/`` turns decisions into ``audit.json`` and its pages.
How bad a planner can be at most is computed by ``ratt_opt.worst_ratio``.
"""
