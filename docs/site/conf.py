"""Configuration of Sphinx for the pages that make.py collects."""
import os

project = "hshfit"
author = "the hshfit contributors"
copyright = author  # noqa: A001
release = version = os.environ.get("HSHFIT_VERSION", "")
extensions = ["myst_parser"]
# Anchors of headings as GitHub makes them, so that links work in both places.
myst_heading_anchors = 4
html_theme = "furo"
html_title = f"hshfit {release}".strip()
html_static_path = [os.path.dirname(os.path.abspath(__file__)) + "/site.css"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sphinx = False
html_last_updated_fmt = None
highlight_language = "none"
# Blocks in pages leave parts out with an ellipsis, which no lexer of their language knows.
suppress_warnings = ["misc.highlighting_failure"]
