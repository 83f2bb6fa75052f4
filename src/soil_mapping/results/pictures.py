"""Pictures of a trial as PNG files: truth, prediction, variance, and the trajectories and samples of the robots."""
from __future__ import annotations

from typing import Any

from matplotlib import cm
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from move_base_abstract.common.own_files import whole_file

DPI = 100
ROBOT_COLOURS = cm.tab10


def write_pictures(folder: Any, result: Any) -> None:
    """Write truth.png, prediction.png (on the truth's scale), variance.png and trajectories.png of a TrialResult."""
    scale = {'vmin': float(result.truth.min()), 'vmax': float(result.truth.max())}
    _write_map(folder / 'truth.png', result, result.truth, 'Truth', 'soil compaction [kPa]', scale)
    _write_map(folder / 'prediction.png', result, result.prediction, 'Prediction', 'soil compaction [kPa]', scale)
    _write_map(folder / 'variance.png', result, result.variance, 'Kriging variance', 'variance [kPa²]', {'vmin': 0.0})
    _write_map(folder / 'trajectories.png', result, result.truth, 'Robots and samples on the truth',
               'soil compaction [kPa]', {**scale, 'cmap': 'Greys'}, _draw_robots)


def _write_map(path: str, result: Any, values: Any, title: str, label: str, style: Any, draw: Any = None) -> None:
    figure = Figure(figsize=(8.0, 5.2), constrained_layout=True)
    axes = figure.add_subplot()
    rows, columns = values.shape
    extent = (0.0, columns * result.cell_m, 0.0, rows * result.cell_m)
    image = axes.imshow(values, origin='lower', extent=extent, **{'cmap': 'viridis', **style})
    figure.colorbar(image, label=label, shrink=0.8)
    axes.set(title=title, xlabel='x, east [m]', ylabel='y, north [m]')
    if draw:
        draw(axes, result)
    with whole_file(path, 'wb') as stream:
        FigureCanvasAgg(figure).print_png(stream, metadata={'Software': None})


def _draw_robots(axes: Any, result: Any) -> None:
    robots = sorted({point.robot for point in result.waypoints})
    for robot in robots:
        colour = ROBOT_COLOURS(robot % ROBOT_COLOURS.N)
        way = [point for point in result.waypoints if point.robot == robot]
        axes.plot([point.x for point in way], [point.y for point in way], color=colour, linewidth=1.0,
                  label=f'robot {robot}')
        axes.plot(way[0].x, way[0].y, marker='s', color=colour)
        own = [sample for sample in result.samples if sample.robot == robot]
        axes.plot([sample.x for sample in own], [sample.y for sample in own], 'o', color=colour, markersize=4.0)
    if robots:
        axes.legend(loc='upper right', fontsize='small')
