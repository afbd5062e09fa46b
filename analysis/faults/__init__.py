"""A fault campaign: what strangers, full disks, interrupts and kills can do to the command line and to sweeps.

``python -m analysis.faults --cases 20000 --seed 1 --out DIR`` runs the command line in this process on damaged files,
odd flags, closed streams, small file-size limits and interrupts at random times. It opens damaged journals. Now and
then it starts processes, sweeps among them, to kill, to interrupt or to deprive of their streams. Case ``k`` of seed
``s`` is always the same, except for the moment of an interrupt. A fault is an exit code that is not documented, a
traceback, or a refusal of more than one printable line; more than 20 s; a certificate accepted whose claim is false; a
file replaced that should not be; files of two runs without a mark; or a row lost or repeated. The command prints a
table and exits with 1 when there is a fault.

Open ``campaign.py`` first: how a case is run and judged. ``inside.py`` and ``processes.py`` have the kinds of cases,
``damage.py`` how files are damaged, ``truth.py`` what a stated problem is truly worth, ``results.py`` what must hold of
a folder of results, ``__main__.py`` the command.
"""
