"""Sphinx's settings for the site; tools/build_docs.py puts it beside what it has staged."""
project = 'move_base_abstract'
extensions = ['myst_parser', 'sphinx.ext.autodoc']
root_doc = 'index'
source_suffix = {'.md': 'markdown', '.rst': 'restructuredtext'}
include_patterns = ['index.md', 'look.md', 'README.md', 'CONTRIBUTING.md', 'CHANGELOG.rst', 'docs/**']
exclude_patterns = ['docs/site/**', 'examples/**', 'config/**']
html_theme = 'furo'
html_extra_path = ['extra']  # live pages, made with the site
html_static_path = ['docs/site/static']
html_css_files = ['site.css']
html_title = 'move_base_abstract'
html_show_sourcelink = False
html_copy_source = False
myst_heading_anchors = 5
autodoc_member_order = 'bysource'
autodoc_typehints = 'none'
autodoc_mock_imports = ['simpy']  # of PyPI only
# Formulas, tables of options and file formats are shown as they are typed.
highlight_language = 'none'
# Debian 12's furo has no dark colours of its own, and a script that browsers refuse: site.js stands in where it did not
# run.
html_js_files = ['site.js']
html_theme_options = {'dark_css_variables': {
    'color-foreground-primary': '#dfe3e8', 'color-foreground-secondary': '#a8b0b9',
    'color-foreground-muted': '#98a2ad',
    'color-foreground-border': '#6b7580', 'color-background-primary': '#14171a',
    'color-background-secondary': '#1b1f23',
    'color-background-hover': '#252a30', 'color-background-hover--transparent': '#252a3000',
    'color-background-border': '#343b42', 'color-background-item': '#4b535c',
    'color-announcement-background': '#000000dd',
    'color-announcement-text': '#eeebee', 'color-brand-primary': '#7cb8f5', 'color-brand-content': '#7cb8f5',
    'color-highlighted-background': '#173f66', 'color-highlight-on-target': '#333300', 'color-problematic': '#f07070',
    'color-inline-code-background': '#23282d', 'color-api-background': '#1b1f23', 'color-api-keyword': '#a8b0b9',
    'color-admonition-background': '#1b1f23', 'color-card-background': '#1b1f23',
}}
