"""The page: a single HTML file that shows one or two runs. It needs no other file and no network."""
from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, Dict, List, Optional, Sequence, Tuple, Union

import jinja2
import numpy as np

from move_base_abstract.common import own_files
from move_base_abstract.maps.map_files import load_map, read_description
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.runs import run_difference
from move_base_abstract.runs.run_difference import told_lines
from move_base_abstract.runs.states import IDLE, NAMES, STATES

from .packed import Packer
from .page_data import Run
from .recording import ReplayError, read_recording
from .world import Box, World, box_of, find_world

if TYPE_CHECKING:
    from move_base_abstract.common.type_names import StrPath
    from move_base_abstract.runs.run_difference import Difference
    from move_base_abstract.scenario import Scenario

    from .recording import Recording

_TEMPLATES = Path(__file__).with_name('templates')
_SCRIPTS = ('data', 'words', 'vector', 'canvas', 'labels', 'world', 'world_view', 'robots', 'map_view',
            'timeline', 'event_list', 'player')
_FIRST_LINE = b'<!doctype html><!-- move_base_abstract replay -->'
_MOST_LOGS = 2
_MOST_CELLS = 2048  # along a side of the map
_UNKNOWN = 255  # on the page; other cells are 0 to 100 as in a nav_msgs/OccupancyGrid
#: a map: (the text for data.js, its Box, warnings)
Ground = Tuple[str, Optional[Box], List[Any]]


def write_page(logs: Sequence[Path], output: Path, map_file: Any = None,
               scenario: Optional[Union[Scenario, Path]] = None) -> List[Any]:
    """Write the page ``output`` for one or two event logs (paths); return notes for the user, as texts.

    ``map_file``: the YAML file of the map behind the robots, or None. ``scenario``: the world that is shown (a path, or
    a Scenario); None: ``scenario.yaml`` beside the first log, if there is one. Only a page that this program has made
    is replaced.

    :raises EventLogError: if a log cannot be read. :raises ConfigurationError: if the map or the scenario cannot be
        read, or ``output`` is another file. :raises OutputError: if the page cannot be written.
    """
    paths = [str(log) for log in logs]
    if not 1 <= len(paths) <= _MOST_LOGS:
        raise ReplayError('got {} logs; allowed: one, or two to be compared'.format(len(paths)))
    own_files.check_file(str(output), lambda line: line.startswith(_FIRST_LINE))
    recordings = [read_recording(log) for log in paths]
    world = find_world(scenario, recordings)
    map_file = map_file or world.map_file
    ground = packed_map(map_file) if map_file else None
    text = render(recordings, ground, find_difference(recordings) if len(paths) > 1 else None, world)
    # A log may contain bytes that are not valid text.
    with own_files.whole_file(output, 'w', encoding='utf-8', errors='backslashreplace') as stream:
        stream.write(text)
    return ground[2] if ground else []


def find_difference(recordings: Sequence[Recording]) -> Tuple[Optional[Difference], int]:
    """Return the first run_difference.Difference of the logs of two Recordings, and the number of events before it.

    If the logs are the same, the difference is None.
    """
    one, other = recordings
    compared = run_difference.compare(one.path, other.path)
    return compared.difference, compared.events + compared.messages


def render(recordings: Sequence[Recording],
           ground: Optional[Ground] = None,
           difference: Optional[Tuple[Optional[Difference], int]] = None, world: World = World()) -> str:
    """Return the page of one or two Recordings in a World, as text.

    ``ground``: the result of packed_map(), or None; ``difference``: the result of find_difference(), or None.
    """
    runs = [Run(recording, world) for recording in recordings]
    notes = ['{}: {}'.format(run.name, note) if len(runs) > 1 else note for run in runs for note in run.notes]
    boxes = [run.box for run in runs if run.box]
    boxes += [ground[1]] if boxes and ground and ground[1] else []
    box = box_of(corner for one in boxes for corner in (one[:2], one[2:]))
    first, before = difference or (None, 0)
    about = {'box': box, 'difference': first and {
        'time': first.time_ns, 'event': -1 if any(run.recording.left_out for run in runs) else before}}
    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(str(_TEMPLATES)), autoescape=True,
                                     trim_blocks=True, lstrip_blocks=True, undefined=jinja2.StrictUndefined)
    return environment.get_template('replay.html.j2').render(
        runs=[{'name': run.name, 'facts': run.facts, 'text': run.packed()} for run in runs],
        notes=notes, box=box, states=_legend(runs), difference=first and _told(first),
        marked=any(line.failures for run in runs for line in run.timelines),
        packed_map=ground and ground[0], world=_packed_world(world),
        signs=_signs(runs, world), about=json.dumps(about), style=_state_colours() + _file('replay.css'),
        script=_states_of_script() + '\n'.join(_file(name + '.js') for name in _SCRIPTS)) + '\n'


def _signs(runs: Sequence[Run], world: World) -> Dict[str, bool]:
    """Return {sign: whether it is on the map and needs an explanation}."""
    return {'counts': any(thing['capacity'] is not None for thing in world.things),
            'charge': any(start.battery is not None for start in world.starts.values()),
            'orders': any(run.phases for run in runs)}


def _packed_world(world: World) -> str:
    return Packer().text({'things': world.things, 'nodes': world.nodes, 'levels': world.levels})


def _file(name: str) -> str:
    return (_TEMPLATES / name).read_text(encoding='utf-8').strip()


def _legend(runs: Sequence[Run]) -> List[str]:
    """Return the names of the states that the timelines show."""
    seen = {IDLE, *(span.state for run in runs for line in run.timelines for span in line.spans)}
    return [name for number, name in enumerate(NAMES) if number in seen]


def _state_colours() -> str:
    """Return the style sheet that has the colours of states, on light and dark screens and on paper."""
    light, dark, paper = (':root{} {{ {} }}\n'.format(where, ' '.join(
        '--{}: {};'.format(state.name, state.colours[number]) for state in STATES))
        for number, where in enumerate(('', '', '.print')))
    return light + '@media (prefers-color-scheme: dark) { ' + dark + '}\n' + paper


def _states_of_script() -> str:
    """Return the table of states for the script."""
    return 'const STATES = {}, IDLE = {};\n'.format(json.dumps(
        [{'name': state.name, 'standsOut': state.stands_out} for state in STATES]), IDLE)


def _told(difference: Difference) -> Dict[str, Union[List[str], int, str]]:
    """Return the words of the page about a Difference."""
    return {'at': '{:.9f} s'.format(difference.time_ns * 1e-9), 'place': difference.place,
            'told': [told_lines(event).partition(': ')[2] if event else 'no more events'
                     for event in (difference.first, difference.second)]}


def packed_map(path: StrPath) -> Ground:
    """Return the Ground of the map of a YAML file: its text for data.js, its Box, and warnings.

    :raises ConfigurationError: if it cannot be read; the text names the file.
    """
    description = read_description(os.fspath(path))
    grid = load_map(description)
    step = -(-max(grid.width, grid.height) // _MOST_CELLS)
    cells = _coarser(grid.cells, step)
    packer = Packer()
    packer.add('cells', 'u1', np.where(cells < 0, _UNKNOWN, cells).astype(np.uint8).tobytes())
    corners = [grid.origin.compose(Pose2D(x, y)) for x in (0.0, grid.size[0]) for y in (0.0, grid.size[1])]
    text = packer.text({'columns': cells.shape[1], 'rows': cells.shape[0], 'resolution': grid.resolution * step,
                        'width': grid.size[0], 'height': grid.size[1],
                        'origin': [grid.origin.x, grid.origin.y, grid.origin.yaw]})
    return text, box_of((one.x, one.y) for one in corners), list(description.warnings)


def _coarser(cells: np.ndarray, step: int) -> np.ndarray:
    """Return the cells with each ``step`` by ``step`` of them joined: the most occupied one counts."""
    if step == 1:
        return cells
    rows, columns = (-(-side // step) * step for side in cells.shape)
    whole = np.full((rows, columns), -1, np.int8)
    whole[:cells.shape[0], :cells.shape[1]] = cells
    return whole.reshape(rows // step, step, columns // step, step).max(axis=(1, 3))
