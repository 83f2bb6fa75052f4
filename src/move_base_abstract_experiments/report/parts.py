"""The building blocks of the report's sections. A study that adds sections of its own makes them from these."""
from __future__ import annotations

import io
import re
from typing import Any, Iterable, List, NamedTuple, Optional

import numpy as np

#: stands for the colour of the page's text in a figure; a colour that no picture is likely to use
_INK = '#010203'
_HASH_SALT = 'move_base_abstract'


class Cell(NamedTuple):
    """A cell of a table with a link."""

    text: str
    link: Optional[str]  # an address; '' or None: only the text is shown


class Table(NamedTuple):
    """A table; its cells are texts or Cells."""

    title: str
    header: tuple  # one text per column
    rows: tuple  # of tuples of cells
    note: str = ''  # how to read the table
    is_open: bool = False  # whether the page shows it unfolded


class Figure(NamedTuple):
    """A picture as SVG, with a caption. figure_of makes it from a matplotlib figure."""

    caption: str
    svg: str


class Html(NamedTuple):
    """HTML that goes into the page as it is. The caller must escape all text in it that comes from elsewhere."""

    markup: str


class Section(NamedTuple):
    """A section of the page: a heading and its parts."""

    heading: str
    parts: tuple  # of Tables, Figures, Html, and texts, each of which is a paragraph


def figure_of(figure: Any, caption: str) -> Figure:
    """Return the Figure of a matplotlib figure. Equal figures give equal bytes; black becomes the text's colour."""
    import matplotlib  # takes half a second, so only callers that need it wait
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    stream = io.StringIO()
    with matplotlib.rc_context({'svg.hashsalt': f'{_HASH_SALT} {caption}', 'svg.fonttype': 'none'}):
        for artist in figure.findobj():
            _in_ink(artist, matplotlib.colors)
        FigureCanvasSVG(figure).print_svg(stream)
    text = stream.getvalue()
    # The metadata has a date, and other things that the page does not need.
    text = re.sub(r'<metadata>.*?</metadata>', '', text[text.index('<svg'):], flags=re.DOTALL)
    text = re.sub(r'<g id="[^"]*"', '<g', text)  # every figure has the same IDs, and nothing refers to them
    return Figure(caption, text.replace(_INK, 'currentColor'))


def _in_ink(artist: Any, colors: Any) -> None:
    """Give the black parts of an artist the colour that stands for the page's text, and make its white parts clear."""
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


def there(parts: Iterable[Any]) -> List[Any]:
    """Return the parts that are not None or empty."""
    return [part for part in parts if part]
