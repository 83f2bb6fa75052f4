"""The legend of the maps in RViz: titles with units, colour bars with values, and a key to the markers."""
from __future__ import annotations

from typing import Any

from geometry_msgs.msg import Point
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, MarkerArray

GAP = 0.05  # of the field's width, between the two maps
BAR_STEPS = 49
ALPHA, BACKGROUND = 0.8, 0.96  # as in rviz/soil_mapping.rviz, so that the bars look like the maps
INK = ColorRGBA(0.05, 0.05, 0.05, 1.0)
HEIGHT_Z = 0.4  # m, above the maps


def make_legend(grid: Any, unit: str, span: Any, variance_span: Any) -> Any:
    """Return the markers around the maps of a Grid, in the map frame.

    unit: that of the values. span, variance_span: (low, high), the values of the first and the last colour.
    """
    size = 0.042 * max(grid.width_m, grid.height_m / 2.0)  # height of a letter [m]
    beside = variance_offset_m(grid)
    markers = []
    for west, title, text_unit, (low, high) in ((0.0, 'Predicted values', unit, span),
                                               (beside, 'Kriging variance', unit + '²', variance_span)):
        middle = west + grid.width_m / 2.0
        markers.append(_text(f'{title} [{text_unit}]', middle, grid.height_m + 0.9 * size, size))
        markers.append(_bar(west + 0.25 * grid.width_m, 0.5 * grid.width_m, -1.2 * size, 0.7 * size))
        for x, value in ((west + 0.125 * grid.width_m, low), (west + 0.875 * grid.width_m, high)):
            markers.append(_text(f'{value:.4g} {text_unit}', x, -1.2 * size, 0.8 * size))
    key = 'black dot: sample     cube: task to do, line: way there, in the colour of its robot'
    markers.append(_text(key, grid.width_m + (beside - grid.width_m) / 2.0, -2.8 * size, 0.8 * size))
    for number, marker in enumerate(markers):
        marker.ns, marker.id = 'legend', number
    return MarkerArray(markers)


def variance_offset_m(grid: Any) -> Any:
    """Return the distance by which the map of the variance is shown east of the map frame's origin [m]."""
    return (1.0 + GAP) * grid.width_m


def _marker(kind: str) -> Any:
    marker = Marker(type=kind, action=Marker.ADD)
    marker.header.frame_id = 'map'
    marker.pose.orientation.w = 1.0
    marker.color = INK
    return marker


def _text(text: str, x: float, y: float, size_m: Any) -> Any:
    marker = _marker(Marker.TEXT_VIEW_FACING)
    marker.text = text
    marker.scale.z = size_m
    marker.pose.position = Point(x, y, HEIGHT_Z)
    return marker


def _bar(west: Any, length_m: Any, y: float, height_m: Any) -> Any:
    """Return a bar of RViz's costmap colours, from the colour of 1 to that of 98."""
    marker = _marker(Marker.CUBE_LIST)
    step = length_m / BAR_STEPS
    marker.scale.x, marker.scale.y, marker.scale.z = step, height_m, 0.01
    for index in range(BAR_STEPS):
        share = 0.01 + 0.97 * index / (BAR_STEPS - 1)
        marker.points.append(Point(west + (index + 0.5) * step, y, 0.0))
        colour = (ALPHA * part + (1.0 - ALPHA) * BACKGROUND for part in (share, 0.0, 1.0 - share))
        marker.colors.append(ColorRGBA(*colour, 1.0))
    return marker
