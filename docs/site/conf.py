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
