"""The ledger as ``audit.json`` and as pages; computes no verdict. Open ``document.py`` first.

``document.py`` types the JSON data and ``records.py`` writes it from decisions. ``findings.py`` sums up what the
records settle, ``words.py`` puts one record in words, ``html_page.py`` and ``markdown_page.py`` print both.
"""
