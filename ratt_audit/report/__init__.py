"""The ledger as ``audit.json`` and as pages; computes no verdict. Open ``records.py`` first.

``records.py`` types the JSON data and writes it from decisions; ``findings.py`` sums up what the records settle, and
``pages.py`` prints both as HTML and Markdown.
"""
