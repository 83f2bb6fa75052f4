"""What the report's sections are made of. A study that adds sections makes them of these."""

import io
import re
from typing import NamedTuple

import numpy as np

#: stands for the colour of the page's text in a figure; no picture has it by chance
_INK = '#010203'
_HASH_SALT = 'move_base_abstract'


class Cell(NamedTuple):
    """A cell of a table that leads somewhere."""

    text: str
    link: str


class Table(NamedTuple):
    """A table; cells are texts or Cells. How to read it says the note."""

    title: str
    header: tuple
    rows: tuple
    note: str = ''
    is_open: bool = False  # otherwise it is folded


class Figure(NamedTuple):
    """A picture as SVG (figure_of makes one of matplotlib's), with what it shows."""

    caption: str
    svg: str


class Html(NamedTuple):
    """Markup as it is. Whoever makes it sees to it that no text of others is in it unescaped."""

    markup: str


class Section(NamedTuple):
    """A heading and what stands under it: Tables, Figures, Html, and texts, each a paragraph."""

    heading: str
    parts: tuple


def figure_of(figure, caption):
    """Return the Figure of a matplotlib figure: no dates and no chance in it, its black becomes the page's ink."""
    import matplotlib  # takes half a second; only who draws with it waits
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    stream = io.StringIO()
    with matplotlib.rc_context({'svg.hashsalt': f'{_HASH_SALT} {caption}', 'svg.fonttype': 'none'}):
        for artist in figure.findobj():
            _in_ink(artist, matplotlib.colors)
        FigureCanvasSVG(figure).print_svg(stream)
    text = stream.getvalue()
    # The metadata has a date, and more that no page needs.
    text = re.sub(r'<metadata>.*?</metadata>', '', text[text.index('<svg'):], flags=re.DOTALL)
    text = re.sub(r'<g id="[^"]*"', '<g', text)  # every figure has these, and nothing refers to them
    return Figure(caption, text.replace(_INK, 'currentColor'))


def _in_ink(artist, colors):
    """Give what is black in an artist the colour that stands for ink, and what is white none."""
    for name in ('color', 'edgecolor', 'facecolor'):
        getter, setter = getattr(artist, f'get_{name}', None), getattr(artist, f'set_{name}', None)
        if not getter or not setter:
            continue
        try:
            rgba = np.atleast_2d(colors.to_rgba_array(getter()))
        except (TypeError, ValueError):
            continue
        if len(rgba) and (rgba[:, 3] > 0.0).all():
            if (rgba[:, :3] == 0.0).all():
                setter(_INK)
            elif (rgba[:, :3] == 1.0).all():
                setter('none')
