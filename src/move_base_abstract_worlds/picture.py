"""Draw a scenario: map, lanes with their direction, zones, places, chargers, starts; and the findings in red."""
from __future__ import annotations

import math
import textwrap
from typing import TYPE_CHECKING, Any, Dict, List, Sequence, Tuple

from move_base_abstract.common import own_files
from move_base_abstract.common.errors import ConfigurationError

if TYPE_CHECKING:
    from move_base_abstract.maps.lane_map import LaneMap

    from .findings import Finding
    from .world import Start, World

_SOFTWARE = 'move_base_abstract scenario'
_SIZE = 10.0  # inches; the longer side
_DPI = 120
_MOST_NAMES = 60  # if there are more nodes or targets, their names are not written
_MOST_LISTED = 14  # the number of findings in words below the picture
_KEY = ('orange: starts; black squares: places; green: chargers; blue: zones and lanes with a capacity; arrows: '
        'one-way lanes; red: findings')
_RED, _GREEN, _BLUE, _DARK = '#d62728', '#2ca02c', '#1f77b4', '#333333'


def write_picture(world: World, findings: Sequence[Finding], path: str) -> None:
    """Write the PNG file ``path`` with the :class:`.World` and the findings in it.

    Only a picture that this program has made is replaced.

    :raises ConfigurationError: if ``path`` is another file, or matplotlib is not installed.
    :raises OutputError: if it cannot be written.
    """
    own_files.check_file(path, lambda line: line.startswith(b'\x89PNG') and _is_own(path))
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise ConfigurationError('--picture: matplotlib is not installed; install it (pip install matplotlib), or '
                                 'leave --picture out') from None
    box = _box(world)
    width, height = _size(box)
    lines = _lines(findings, width)
    below = 0.35 + 0.17 * len(lines)
    figure = Figure(figsize=(width, height + below), dpi=_DPI)
    axes = figure.add_axes([0.6 / width, (below + 0.35) / (height + below), 1.0 - 0.8 / width,
                            (height - 0.7) / (height + below)])
    _draw(axes, world, findings)
    axes.set(xlim=box[::2], ylim=box[1::2], aspect='equal', xlabel='x [m]', ylabel='y [m]')
    axes.tick_params(labelsize=7)
    axes.set_title(_plain(world.path[-80:] + '\n' + _KEY), fontsize=7)
    for number, (line, colour) in enumerate(lines):
        figure.text(0.02, (below - 0.15 - 0.17 * number) / (height + below), line, fontsize=7, color=colour, va='top')
    with own_files.whole_file(path, 'wb') as stream:
        figure.savefig(stream, format='png', metadata={'Software': _SOFTWARE})


def _is_own(path: str) -> bool:
    with open(path, 'rb') as stream:
        return _SOFTWARE.encode() in stream.read(1000)


def _box(world: World) -> Tuple[float, float, float, float]:
    """Return (x_min, y_min, x_max, y_max) [m] around everything that is drawn, with a margin."""
    points = [start.xy for start in world.starts] + [target.xy for target in world.targets]
    points += [(pose.x, pose.y) for net in world.nets.values() for pose in net.nodes.values()]
    points += [point for net in world.nets.values() for edge in net.edges for point in edge.points]
    points += [point for zone in world.scenario.zones for point in zone.outline.points]
    if world.occupancy is not None:
        rows, columns = world.occupancy.height, world.occupancy.width
        points += [world.occupancy.from_cells(column, row) for column in (0, columns) for row in (0, rows)]
    xs, ys = zip(*points or [(0.0, 0.0)])
    margin = 0.03 * max(max(xs) - min(xs), max(ys) - min(ys)) or 1.0
    return min(xs) - margin, min(ys) - margin, max(xs) + margin, max(ys) + margin


def _size(box: Tuple[float, float, float, float]) -> Tuple[float, float]:
    """Return (width, height) of the picture [inches]."""
    wide, high = box[2] - box[0], box[3] - box[1]
    scale = _SIZE / max(wide, high)
    return max(6.0, wide * scale), min(_SIZE, max(3.0, high * scale))


def _lines(findings: Sequence[Finding], width: float) -> List[Tuple[str, str]]:
    """Return the lines below the picture: [(text, colour), ...]."""
    if not findings:
        return [('nothing found', _GREEN)]
    lines = [('{}  {}: {}'.format(number, one.name, one.what), _RED)
             for number, one in enumerate(findings[:_MOST_LISTED], 1)]
    if len(findings) > _MOST_LISTED:
        lines.append(('... and {} more'.format(len(findings) - _MOST_LISTED), _RED))
    return [(textwrap.shorten(_plain(text), int(17 * width), placeholder=' ...'), colour) for text, colour in lines]


def _plain(text: str) -> str:
    """Return ``text`` so that matplotlib does not take parts of it for mathematics."""
    return text.replace('$', r'\$')


def _draw(axes: Any, world: World, findings: Sequence[Finding]) -> None:
    if world.occupancy is not None:
        _draw_map(axes, world.occupancy)
    for zone in world.scenario.zones:
        colour = _GREEN if zone.charger is not None else _BLUE
        axes.fill(*zip(*zone.outline.points), facecolor=colour, alpha=0.2, edgecolor=colour, linewidth=0.8, zorder=1)
    for net in world.nets.values():
        _draw_net(axes, net)
    _draw_targets(axes, world)
    _draw_starts(axes, world.starts)
    _draw_findings(axes, findings)


def _draw_map(axes: Any, occupancy: Any) -> None:
    import numpy as np
    from matplotlib.transforms import Affine2D
    shades = np.full(occupancy.cells.shape, 1.0)
    shades[occupancy.cells < 0] = 0.85
    shades[occupancy.cells > 0] = 1.0 - 0.55 * occupancy.cells[occupancy.cells > 0] / 100.0
    image = axes.imshow(shades, cmap='gray', vmin=0.0, vmax=1.0, origin='lower', interpolation='nearest',
                        extent=(0.0, occupancy.size[0], 0.0, occupancy.size[1]), zorder=0)
    origin = occupancy.origin
    image.set_transform(Affine2D().rotate(origin.yaw).translate(origin.x, origin.y) + axes.transData)


def _draw_net(axes: Any, net: LaneMap) -> None:
    for edge in net.edges:
        limited = edge.capacity is not None
        axes.plot(*zip(*edge.points), color=_BLUE if limited else '#777777', linewidth=1.0, zorder=2)
        if edge.one_way:
            (ax, ay), (bx, by) = _middle_piece(edge.points)
            axes.annotate('', ((ax + bx) / 2.0 + (bx - ax) * 0.02, (ay + by) / 2.0 + (by - ay) * 0.02),
                          ((ax + bx) / 2.0, (ay + by) / 2.0), zorder=7,
                          arrowprops={'arrowstyle': '-|>', 'color': _BLUE if limited else '#555555', 'lw': 0.8,
                                      'mutation_scale': 13})
    axes.plot([pose.x for pose in net.nodes.values()], [pose.y for pose in net.nodes.values()], '.', color=_DARK,
              markersize=3, zorder=3)
    if len(net.nodes) <= _MOST_NAMES:
        for name, pose in net.nodes.items():
            _write(axes, name, pose.x, pose.y, '#777777', 5)


def _middle_piece(points: Any) -> Tuple[Tuple[float, float], Tuple[float, float]]:
    """Return the longest straight piece of a lane."""
    return max(zip(points, points[1:]), key=lambda piece: math.dist(*piece))


def _draw_targets(axes: Any, world: World) -> None:
    shapes = {'place': ('s', _DARK), 'charger': ('P', _GREEN), 'goal': ('x', '#777777')}
    for what, (shape, colour) in shapes.items():
        targets = [target for target in world.targets if target.what == what]
        if not targets:
            continue
        axes.plot(*zip(*(target.xy for target in targets)), shape, color=colour, markersize=4, zorder=4,
                  linestyle='none')
        if len(targets) <= _MOST_NAMES and what != 'goal':
            for target in targets:
                _write(axes, target.name, *target.xy, colour, 6)


def _draw_starts(axes: Any, starts: Sequence[Start]) -> None:
    for start in starts:
        yaw = math.degrees(start.spec.settings.start.yaw) - 90.0
        axes.plot(*start.xy, marker=(3, 0, yaw), color='#ff7f0e', markersize=5, zorder=5)
    if len(starts) <= 20:
        for start in starts:
            _write(axes, start.spec.name, *start.xy, '#b35900', 6)


def _draw_findings(axes: Any, findings: Sequence[Finding]) -> None:
    numbers: Dict[Any, Any] = {}  # {place: numbers of the findings there}
    for number, one in enumerate(findings, 1):
        for way in one.ways:
            axes.plot(*zip(*way), color=_RED, linewidth=2.0, alpha=0.7, zorder=6)
        for point in one.points:
            axes.plot(*point, 'o', markerfacecolor='none', markeredgecolor=_RED, markersize=9, zorder=7)
        at = one.points[0] if one.points else _centre(one.ways[0]) if one.ways else None
        if at is not None and number <= _MOST_LISTED:
            numbers.setdefault(at, []).append(str(number))
    for (x, y), texts in numbers.items():
        axes.annotate(','.join(texts), (x, y), (-5, -5), textcoords='offset points', ha='right', va='top', fontsize=8,
                      color=_RED, fontweight='bold', zorder=8)


def _centre(way: Any) -> Any:
    (ax, ay), (bx, by) = _middle_piece(way)
    return (ax + bx) / 2.0, (ay + by) / 2.0


def _write(axes: Any, text: str, x: float, y: float, colour: str, size: int) -> None:
    axes.annotate(_plain(text), (x, y), (3, 3), textcoords='offset points', fontsize=size, color=colour, zorder=8,
                  clip_on=True)
