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
# Debian's build of the theme leaves its dark colours to an attribute of the page that follows no
# setting of the reader; these, of the program's own pages, follow it.
html_theme_options = {
    "dark_css_variables": {
        "color-foreground-primary": "#e6e9ed",
        "color-foreground-secondary": "#a0a9b4",
        "color-foreground-muted": "#8a939e",
        "color-foreground-border": "#5a636e",
        "color-background-primary": "#14171b",
        "color-background-secondary": "#1a1e23",
        "color-background-hover": "#242930",
        "color-background-hover--transparent": "#24293000",
        "color-background-border": "#363d46",
        "color-background-item": "#444c57",
        "color-brand-primary": "#6bb1ff",
        "color-brand-content": "#6bb1ff",
        "color-highlighted-background": "#083563",
        "color-highlight-on-target": "#333300",
        "color-card-border": "#363d46",
        "color-card-background": "#1d2127",
        "color-table-border": "#363d46",
        "color-table-header-background": "#1d2127",
    },
}
html_title = f"hshfit {release}".strip()
html_static_path = [os.path.dirname(os.path.abspath(__file__)) + "/site.css"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sphinx = False
html_last_updated_fmt = None
highlight_language = "none"
# Blocks in pages leave parts out with an ellipsis, which no lexer of their language knows.
suppress_warnings = ["misc.highlighting_failure"]
