"""Sphinx configuration of the documentation; `docs/build_site.py` collects its sources.

Sphinx is the generator because numpydoc and myst-nb, which render docstrings and notebooks, are
parts of it; with latex2mathml for mathematics nothing is loaded from a network.
"""

import sys
from pathlib import Path

SITE = Path(__file__).parent
sys.path.insert(0, str(SITE))

project = "slippulse"
author = "The slippulse developers"
extensions = ["sphinx.ext.autodoc", "sphinx.ext.autosummary", "numpydoc", "myst_nb"]
extensions += ["mathml", "docstrings"]
root_doc = "index"
exclude_patterns = ["docs/site/*", "**.ipynb_checkpoints"]
templates_path = [str(SITE)]

# Pages and notebooks
myst_enable_extensions = ["dollarmath", "colon_fence"]
myst_heading_anchors = 4
nb_custom_formats = {".py": ["jupytext.reads", {"fmt": "py:percent"}]}
nb_execution_mode = "cache"
nb_execution_timeout = 120
nb_execution_raise_on_error = True
nb_merge_streams = True
# The first run on a machine prints that kernels are compiled.
nb_output_stderr = "remove"

# The reference
autosummary_generate = True
autodoc_typehints = "none"
numpydoc_class_members_toctree = False
numpydoc_show_class_members = False
add_module_names = False
default_role = "py:obj"

# The look: everything is beside the pages, and the search runs in the browser.
html_theme = "pydata_sphinx_theme"
html_title = "slippulse"
html_static_path = [str(SITE / "style.css"), str(SITE / "keyboard.js")]
html_css_files = ["style.css"]
html_math_renderer = "mathml"
html_js_files = ["keyboard.js"]
# Browsers refuse to fetch the pages for a summary when the site is opened from a folder.
html_show_search_summary = False
html_show_sourcelink = False
html_copy_source = False
html_theme_options = {
    "logo": {"text": "slippulse"},
    "navbar_end": ["theme-switcher"],
    "footer_start": ["copyright"],
    "footer_end": [],
    "show_prev_next": True,
    "pygments_light_style": "a11y-high-contrast-light",
    "pygments_dark_style": "a11y-high-contrast-dark",
    "secondary_sidebar_items": ["page-toc"],
    "back_to_top_button": False,
}
copyright = "The slippulse developers, MIT licence"
