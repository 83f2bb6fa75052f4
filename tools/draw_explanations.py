#!/usr/bin/python3
"""Draw docs/images/round.svg, windows.svg and rooms.svg: a round, windows, and the houses of the package.

usage: python3 tools/draw_explanations.py

The drawings are narrow, so that they can be read at 400 px. Their colours are variables. Within a page they are those
of the page, otherwise light or dark as the reader's system says. `make lint` compares the files with this program.
"""
import html
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
IMAGES = ROOT / 'docs' / 'images'
WIDTH = 380
STYLE = """<style>
:root { --ink: #1b1f24; --soft: #59636e; --paper: #ffffff;
  --blue: #0b5cad; --blue-fill: #dcebfa; --warm: #9a4a00;
  --warm-fill: #fbe6d0; --line: #b9c1ca; }
@media (prefers-color-scheme: dark) { :root { --ink: #e6e9ec; --soft: #a3adb8; --paper: #16191d; --blue: #7cb8f5;
  --blue-fill: #173352; --warm: #f0b070; --warm-fill: #4a2f12; --line: #4b5560; } }
.drawing text { font: 13px sans-serif; fill: var(--ink); } .drawing .b { font-weight: bold; }
.drawing .s { fill: var(--soft); font-size: 12px; } .drawing .m { text-anchor: middle; }

.drawing .blue { fill: var(--blue-fill); stroke: var(--blue); }
.drawing .warm { fill: var(--warm-fill); stroke: var(--warm); }
.drawing .paper { fill: var(--paper); } .drawing .box { fill: var(--paper); stroke: var(--line); }
.drawing .line { stroke: var(--line); fill: none; }
.drawing .arrow { stroke: var(--blue); stroke-width: 1.6; fill: none; } .drawing .head { fill: var(--blue); }
.drawing .back { stroke: var(--warm); stroke-width: 1.6; fill: none; } .drawing .backhead { fill: var(--warm); }
.drawing .leap { fill: var(--blue); }
.drawing .h { paint-order: stroke; stroke: var(--paper); stroke-width: 4px; }
.drawing .onblue { fill: var(--paper); font-weight: bold; }
</style>"""


class Drawing:
    """Lines of an SVG file."""

    def __init__(self, title, height):
        self._title, self._height, self._lines = title, height, []

    def text(self, x, y, words, kind=''):
        """Write words; letters of kind: b(old), s(oft), m(iddle), h (a halo, for words over lines)."""
        self._lines.append(f'<text x="{x}" y="{y}" class="{kind}">{html.escape(words)}</text>')

    def box(self, x, y, width, height, kind='box', words=(), text_kind='m'):
        """Draw a box with lines of words in its middle."""
        self._lines.append(f'<rect x="{x}" y="{y}" width="{width}" height="{height}" rx="4" class="{kind}"/>')
        for number, line in enumerate(words):
            line_y = y + height / 2 + 4.5 + 16 * (number - (len(words) - 1) / 2)
            self.text(x + width / 2, line_y, line, text_kind if number else text_kind + ' b')

    def line(self, x1, y1, x2, y2, kind='line', dashed=False):
        """Draw a line."""
        dash = ' stroke-dasharray="3 4"' if dashed else ''
        self._lines.append(f'<line x1="{x1}" y1="{y1}" x2="{x2}" y2="{y2}" class="{kind}"{dash}/>')

    def arrow(self, x1, y1, x2, y2, kind='arrow'):
        """Draw an arrow; kinds: arrow, back."""
        length = ((x2 - x1) ** 2 + (y2 - y1) ** 2) ** 0.5
        along_x, along_y = (x2 - x1) / length, (y2 - y1) / length
        base_x, base_y = x2 - 8 * along_x, y2 - 8 * along_y
        self.line(x1, y1, round(base_x, 1), round(base_y, 1), kind)
        corners = ' '.join(f'{x:.1f},{y:.1f}' for x, y in (
            (x2, y2), (base_x - 4 * along_y, base_y + 4 * along_x), (base_x + 4 * along_y, base_y - 4 * along_x)))
        self._lines.append(f'<polygon points="{corners}" class="{"head" if kind == "arrow" else "backhead"}"/>')

    def svg(self):
        """Return the file's text."""
        return '\n'.join([
            f'<svg xmlns="http://www.w3.org/2000/svg" class="drawing" role="img" viewBox="0 0 {WIDTH} {self._height}">',
            f'<title>{html.escape(self._title)}</title>', STYLE,
            f'<rect width="{WIDTH}" height="{self._height}" class="paper"/>', *self._lines, '</svg>', ''])


def a_round():
    """Draw two nodes and the time master in an instant with three rounds, and the leap after it."""
    drawing = Drawing('How a round works: grants, reports, and the leap to the next instant', 596)
    master, fleet, coordinator = 62, 190, 318
    for x, words in ((master, 'time master'), (fleet, 'robots'), (coordinator, 'your node')):
        drawing.box(x - 56, 4, 112, 28, 'box', (words,))
        drawing.line(x, 32, x, 532, dashed=True)
    drawing.box(2, 42, 376, 22, 'blue', ('it is 10 s: time stands still',))

    def step(y, number, to, there, back, work):
        drawing.text(4, y - 8, f'round {number}', 's')
        drawing.arrow(master, y, to, y)
        drawing.text((fleet if to == coordinator else (master + to) / 2) - 2, y - 6, there, 'm h')
        drawing.box(to - 30, y + 8, 60, 24, 'warm', (work,))
        drawing.arrow(to, y + 54, master, y + 54, 'back')
        for count, line in enumerate(back):
            drawing.text(master + 10, y + 70 + 15 * count, line, 'h')
    step(96, 1, fleet, 'grant', ('report: “robot 1 has arrived”,', 'and I have to go on at 14 s'), 'works')
    step(228, 2, coordinator, 'grant, with the mail “arrived”', ('report: “go to the dock”, I wait for mail',), 'works')
    step(344, 3, fleet, 'grant + mail', ('report: robot 1 drives to the dock;', 'I have to go on at 14 s'), 'works')
    drawing.text(WIDTH / 2, 478, 'All have reported. Nobody has mail, and nobody', 'm h')
    drawing.text(WIDTH / 2, 494, 'has anything left to do at 10 s.', 'm h')
    drawing.box(2, 508, 376, 26, 'leap')
    drawing.text(WIDTH / 2, 526, 'time leaps to 14 s, and round 4 begins', 'm onblue')
    drawing.text(WIDTH / 2, 556, 'However long a box takes by the wall clock, and', 's m')
    drawing.text(WIDTH / 2, 572, 'whoever reports first, this picture is the same.', 's m')
    return drawing.svg()


def windows():
    """Draw three nodes that work at the same time within windows, and messages that arrive one lookahead later."""
    drawing = Drawing('Windows: all nodes work at once, messages arrive one lookahead later', 330)
    left, width = 76, 92
    for count in range(4):
        x = left + width * count
        drawing.line(x, 40, x, 238, dashed=True)
        drawing.text(x, 256, f'{10 + count / 10:.1f} s' if count else '10 s', 'm s')
    for count in range(3):
        drawing.text(left + width * (count + 0.5), 20, f'window {count + 1}', 'm b')
        drawing.text(left + width * (count + 0.5), 36, '0.1 s long', 'm s')
    for row, (name, works) in enumerate((('robots', ((2, 76), (98, 60), (190, 66))),
                                         ('node A', ((14, 40), (142, 34), (204, 50))),
                                         ('node B', ((6, 50), (100, 44), (258, 14))))):
        y = 58 + 62 * row
        drawing.text(4, y + 20, name, 'b')
        drawing.line(left, y + 16, left + 3 * width, y + 16)
        for x, length in works:
            drawing.box(left + x, y + 4, length, 24, 'blue')
    drawing.arrow(left + 50, 86, left + 50 + width, 124)
    drawing.arrow(left + 166, 148, left + 166 + width, 186)
    drawing.text(4, 284, 'In a window each node works by itself, on a core of its own.')
    drawing.text(4, 300, 'What is sent at s arrives at s + 0.1 s: in the next window,')
    drawing.text(4, 316, 'so nobody can be too late for it.')
    return drawing.svg()


def rooms():
    """Draw the houses of the package; each house is above those that it may use."""
    drawing = Drawing('The houses of the package: each knows only what lies below it', 392)
    drawing.text(4, 18, 'as users write them', 's')
    drawing.box(2, 26, 120, 46, 'warm', ('your nodes', 'rospy, roscpp, any'))
    drawing.box(130, 26, 120, 46, 'warm', ('your Python', 'no ROS'))
    drawing.box(258, 26, 120, 46, 'warm', ('the study', 'of soil mapping'))
    drawing.text(4, 96, 'experiments and tools', 's')
    drawing.box(2, 104, 376, 46, 'box', ('experiments · chaos · report · tests',
                                         'replay · calibration · scenarios · plans'))
    drawing.text(4, 174, 'the drop-in', 's')
    drawing.box(2, 182, 376, 46, 'box', ('robots under the interface of move_base',
                                         'topics, actions, parameters, tf, RViz'))
    houses = (('the clock', ('launch files', 'preloaded libraries', 'time master', 'rounds, windows, radio')),
              ('the robots', ('fleet, processes', 'orders, tasks, traffic', 'goals, faults, energy',
                              'maps, motion, engine')))
    for left, (name, rows) in zip((2, 194), houses):
        drawing.box(left, 236, 184, 118, 'blue')
        drawing.text(left + 92, 252, name, 'm b')
        for number, words in enumerate(rows):
            drawing.box(left + 8, 258 + 23 * number, 168, 20, 'box')
            drawing.text(left + 92, 272.5 + 23 * number, words, 'm')
    drawing.box(2, 362, 376, 24, 'box')
    drawing.text(190, 378, 'common: errors, files, options, the story of a run', 'm')
    return drawing.svg()


DRAWINGS = {'round.svg': a_round, 'windows.svg': windows, 'rooms.svg': rooms}

if __name__ == '__main__':
    for name, draw in DRAWINGS.items():
        (IMAGES / name).write_text(draw(), encoding='utf-8')
