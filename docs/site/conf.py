# Sphinx reads this; make_site.py beside it gathers the pages.
import os
import re

project = "Wheeltap"
copyright = "The Wheeltap authors"
author = "The Wheeltap authors"
version = release = os.environ.get("WHEELTAP_VERSION", "")
extensions = ["myst_parser", "sphinx.ext.autodoc"]
source_suffix = {".md": "markdown"}
root_doc = "index"
exclude_patterns = ["Thumbs.db"]
myst_heading_anchors = 6
# Declarations are C++, not always whole ones.
suppress_warnings = ["myst.header", "misc.highlighting_failure"]
# Blocks that are indented are commands and formulas.
highlight_language = "none"
nitpicky = False
autodoc_member_order = "bysource"
autodoc_typehints = "none"
autodoc_preserve_defaults = True

html_theme = "furo"
html_title = f"Wheeltap {version}".strip()
html_static_path = ["_static"]
html_css_files = ["wheeltap.css"]
html_copy_source = False
html_show_sourcelink = False
html_show_sphinx = False
# A page that is read from a disk may not fetch others.
html_show_search_summary = False
html_last_updated_fmt = None
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#1f5f8b", "color-brand-content": "#1f5f8b"},
    "dark_css_variables": {"color-brand-primary": "#7fb8e0", "color-brand-content": "#7fb8e0"},
}
html_search_scorer = os.path.join(os.path.dirname(os.path.abspath(__file__)), "scorer.js")


def docstring(app, what, name, obj, options, lines):
    """Docstrings are plain text: tables of arguments are shown as they stand, and no sign means anything."""
    paragraphs = "\n".join(lines).strip("\n").split("\n\n")
    lines.clear()
    for paragraph in paragraphs:
        columns = re.search(r"\S {2,}\S|^ ", paragraph, re.M)
        if columns:
            lines += ["::", "", *("   " + line for line in paragraph.splitlines()), ""]
        else:
            lines += [*re.sub(r"([*|_\\])", r"\\\1", paragraph).splitlines(), ""]


def setup(app):
    app.connect("autodoc-process-docstring", docstring)
