"""The documentation site: ``python -m sphinx -W -b html docs site``, without a network."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "_extension"))

import ratt_opt

project = "ratt-opt"
author = copyright = "the ratt-opt developers"  # noqa: A001  (Sphinx asks for this name)
release = ratt_opt.__version__
extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx_gallery.gen_gallery", "ratt_pages"]
exclude_patterns = ["_build", "_extension", "examples", "gallery/*.ipynb", "gallery/*.py"]
html_theme = "pydata_sphinx_theme"
html_title = "ratt-opt"  # short, so that it fits beside the search on a phone
html_theme_options = {
    "show_toc_level": 2,
    "navigation_with_keys": False,
    "show_prev_next": False,
    "header_links_before_dropdown": 7,
    "navbar_align": "left",
    "navbar_persistent": ["search-button"],
}
html_sidebars = {"**": ["sidebar-nav-bs"]}
html_static_path = ["_static"]
html_css_files = ["wide.css"]
html_copy_source = False
html_math_renderer = "mathml"  # browsers draw it themselves: nothing is fetched
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3
nb_execution_mode = "off"  # code blocks are executed by the tests, notebooks by the gate; examples here
autodoc_typehints = "none"  # signatures stay readable; docstrings give shapes and units
autodoc_member_order = "bysource"
suppress_warnings = ["ref.python"]  # "name" and "unit" are attributes of several criteria
sphinx_gallery_conf = {
    "examples_dirs": "examples",
    "gallery_dirs": "gallery",
    "filename_pattern": r"\.py$",
    "image_scrapers": ("ratt_pages",),
    "abort_on_example_error": True,
    "download_all_examples": False,
    "write_computation_times": False,
    "show_signature": False,
    "min_reported_time": 1e9,
}
