"""The report's pages: what it says, in the words of the templates beside this file. Markup is theirs, by Jinja2."""

import base64
from pathlib import Path
from typing import NamedTuple

import jinja2

from . import tables

TEMPLATES = Path(__file__).with_name('templates')


class Picture(NamedTuple):
    """A PNG and what it shows."""

    caption: str
    png: bytes

    @property
    def data_uri(self):
        """The picture as the address of itself, so that the page needs no other file."""
        return f'data:image/png;base64,{base64.b64encode(self.png).decode("ascii")}'


class Section(NamedTuple):
    """A heading and its parts, Tables and Pictures, in their order."""

    heading: str
    parts: tuple
    is_gallery: bool = False  # pictures stand side by side

    @property
    def tables(self):
        """Those parts that are Tables."""
        return [part for part in self.parts if isinstance(part, tables.Table)]


def render(name, title, sections):
    """Return the page of a name, report.html or report.md. Texts of users are escaped: they are no markup in either."""
    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(str(TEMPLATES)), trim_blocks=True,
                                     lstrip_blocks=True, autoescape=name.endswith('.html'),
                                     undefined=jinja2.StrictUndefined)
    environment.filters['text'] = _markdown_text
    return environment.get_template(f'{name}.j2').render(title=title, sections=sections).rstrip() + '\n'


def _markdown_text(value):
    """Return what stands for a value in Markdown: on one line, within its cell of a table, without HTML of its own."""
    text = ' '.join(str(value).splitlines())
    for character, shown in (('&', '&amp;'), ('<', '&lt;'), ('\\', '\\\\'), ('|', r'\|')):
        text = text.replace(character, shown)
    return text
