"""The documentation site: ``python -m sphinx -W -b html docs site``, without a network."""

import ratt_opt

project = "ratt-opt"
author = copyright = "the ratt-opt developers"  # noqa: A001  (Sphinx asks for this name)
release = ratt_opt.__version__
extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
exclude_patterns = ["_build"]
html_theme = "pydata_sphinx_theme"
html_theme_options = {"show_toc_level": 2, "navigation_with_keys": False, "show_prev_next": False}
html_sidebars = {"**": ["sidebar-nav-bs"]}
html_copy_source = False
myst_heading_anchors = 3
nb_execution_mode = "off"  # code blocks are executed by the tests
autodoc_typehints = "none"  # signatures stay readable; docstrings give shapes and units
suppress_warnings = ["ref.python"]  # "name" and "unit" are attributes of several criteria
autodoc_member_order = "bysource"
