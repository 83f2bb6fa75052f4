"""Which robots' ways come near each other, and when. Tracks are found by square cells, not by checking all pairs."""
from __future__ import annotations

import math
from typing import Dict, List, Optional, Tuple

from .nearness import Window, windows
from .track import Span, Track

_MOST_CELLS = 64  # per span; a track with a larger span is compared with all others
Cell = Tuple[int, int]


class Neighbours:
    """The tracks of robots, by index; finds those that may come within ``radius`` [m] of each other."""

    def __init__(self, radius: float) -> None:
        self._radius = radius
        #: the side of a cell [m], and the length of the longest span
        self.side = 2.0 * radius
        self._tracks: Dict[int, Track] = {}
        self._cells: Dict[Cell, Dict[int, List[Span]]] = {}
        self._of: Dict[int, List[Cell]] = {}  # the cells through which the track of a robot leads
        self._everywhere: Dict[int, bool] = {}  # robots whose tracks are in too many cells

    def put(self, index: int, track: Track) -> None:
        """Note that the robot ``index`` follows ``track`` from now on."""
        self.drop(index)
        self._tracks[index] = track
        own: Dict[Cell, List[Span]] = {}
        for span in track.spans:
            cells = self._covered(span, 0.0)
            if cells is None:
                self._everywhere[index] = True
                return
            for cell in cells:
                own.setdefault(cell, []).append(span)
        self._of[index] = list(own)
        for cell, spans in own.items():
            self._cells.setdefault(cell, {})[index] = spans

    def drop(self, index: int) -> None:
        """Forget the track of the robot ``index``."""
        self._tracks.pop(index, None)
        self._everywhere.pop(index, None)
        for cell in self._of.pop(index, ()):
            robots = self._cells[cell]
            del robots[index]
            if not robots:
                del self._cells[cell]

    def near(self, index: int, now_ns: int) -> List[Tuple[int, List[Window]]]:
        """Return [(index of another robot, [Window, ...] in order), ...], by index.

        The windows are the spans of time from ``now_ns`` [ns] on in which the other robot may come near the robot
        ``index``.
        """
        track = self._tracks[index]
        if index in self._everywhere:
            far = [other for other in self._tracks if other != index]
            found: Dict[int, Dict[Tuple[int, int], Window]] = {}
        else:
            far = [other for other in self._everywhere if other != index]
            found = self._in_cells(index, track, now_ns)
        near = [(other, sorted(own.values())) for other, own in found.items()]
        for other in far:
            last = self._tracks[other]
            pair = (track, last) if index < other else (last, track)
            near.append((other, list(windows(*pair, now_ns, max(now_ns, track.end_ns, last.end_ns) + 1))))
        return sorted(near)

    def _in_cells(self, index: int, track: Track, now_ns: int) -> Dict[int, Dict[Tuple[int, int], Window]]:
        found: Dict[int, Dict[Tuple[int, int], Window]] = {}
        for span in track.spans:
            if span.end_ns <= now_ns:
                continue
            box = _box(span, self._radius)
            for cell in self._covered(span, self._radius) or ():
                for other, spans in self._cells.get(cell, _NOBODY).items():
                    if other == index:
                        continue
                    for one in spans:
                        if one.begin_ns < span.end_ns and one.end_ns > span.begin_ns and one.end_ns > now_ns and (
                                _touches(box, one)):
                            found.setdefault(other, {})[span.begin_ns, one.begin_ns] = Window(
                                max(span.begin_ns, one.begin_ns, now_ns), min(span.end_ns, one.end_ns),
                                *((span, one) if index < other else (one, span)))
        return found

    def _covered(self, span: Span, margin: float) -> Optional[List[Cell]]:
        """Return the cells that the box of a span, enlarged by ``margin`` [m], touches; None: too many."""
        left, low, right, high = (math.floor(edge / self.side) for edge in _box(span, margin))
        if (right - left + 1) * (high - low + 1) > _MOST_CELLS:
            return None
        return [(column, row) for column in range(left, right + 1) for row in range(low, high + 1)]


_NOBODY: Dict[int, List[Span]] = {}


def _box(span: Span, margin: float) -> Tuple[float, float, float, float]:
    _, _, _, x, y, to_x, to_y, aside = span
    margin += aside
    return (min(x, to_x) - margin, min(y, to_y) - margin, max(x, to_x) + margin, max(y, to_y) + margin)


def _touches(box: Tuple[float, float, float, float], span: Span) -> bool:
    left, low, right, high = box
    other_left, other_low, other_right, other_high = _box(span, 0.0)
    return not (other_right < left or other_left > right or other_high < low or other_low > high)
