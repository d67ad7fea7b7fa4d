"""How Sphinx makes the book: see `build.py`, which runs it."""

import sys
from pathlib import Path

HERE = Path(__file__).parent
if str(HERE.parent) not in sys.path:  # where this folder is the package `book`
    sys.path.insert(0, str(HERE.parent))

project = "segmap"
author = "segmap maintainers"
html_title = "segmap"
language = "en"
root_doc = "index"
exclude_patterns = ["_static"]

extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "book.extension"]

# Chapters: as they are stored, and never run.
nb_execution_mode = "off"
nb_merge_streams = True
nb_mime_priority_overrides = [("*", "application/vnd.jupyter.widget-view+json", None)]
nb_ipywidgets_js: dict[str, dict[str, str]] = {}
nb_code_prompt_show = "code"
nb_code_prompt_hide = "fold"
myst_enable_extensions = ["dollarmath", "amsmath"]
myst_heading_anchors = 4
myst_heading_slug_func = "book.extension.slug"
suppress_warnings = ["misc.highlighting_failure", "myst.header"]

# API: what the docstrings say, types included.
autodoc_typehints = "none"
autodoc_preserve_defaults = True
napoleon_use_param = False
napoleon_use_rtype = False
napoleon_custom_sections = [("Attributes", "params_style")]
default_role = "py:obj"
add_module_names = False
toc_object_entries_show_parents = "hide"
python_maximum_signature_line_length = 80
python_display_short_literal_types = True

# Pages: nothing comes from another host.
html_theme = "furo"
html_theme_options = {"navigation_with_keys": True}
html_extra_path: list[str] = []
html_css_files = ["book.css"]
html_js_files = ["summaries.js", "book.js", "new_form.js"]
html_math_renderer = "mathml"
html_copy_source = False
html_show_sourcelink = False
html_show_copyright = False
html_show_sphinx = False
html_show_search_summary = False  # a page of a file cannot be fetched by another
html_search_scorer = str(HERE / "scorer.js")
html_last_updated_fmt = None
pygments_style = "tango"
pygments_dark_style = "native"
