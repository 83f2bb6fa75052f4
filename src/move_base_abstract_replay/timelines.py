"""The rows of the timeline, and of a radio when its links were up: what happened to a name, and when."""
from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, Dict, List, Optional, Sequence

from move_base_abstract.common.ros_names import natural_order
from move_base_abstract.runs.run_difference import MESSAGES
from move_base_abstract.runs.states import IDLE
from move_base_abstract.runs.story import owner

from .recording import is_number

if TYPE_CHECKING:
    from move_base_abstract.runs.robot_story import Robot
    from move_base_abstract.runs.story import Story

    from .recording import Recording

#: the kinds of events of the radio; hosts get no rows in the timeline
RADIO = ('radio', 'radio_lost', 'link', 'host')


class Timeline:
    """One row of the timeline.

    A robot has ``spans`` (those of its Story, without those in which it is idle) and ``failures`` [ns]; other names
    have ``ticks`` [ns].
    """

    def __init__(self, name: str, robot: Optional[Robot] = None, is_robot: bool = False) -> None:
        self.name = name
        self.is_robot = is_robot
        self.spans = [span for span in robot.spans if span.state != IDLE] if robot else []
        self.failures = robot.missed if robot else []
        self.ticks: List[Any] = []


def find_timelines(recording: Recording, story: Story, robots: Sequence[str]) -> List[Timeline]:
    """Return the Timelines of a Recording: those of ``robots`` (names) in natural order, then those of other names.

    Of these, names with rows of their own come before nodes of which the log has only messages. ``story``: the Story of
    the Recording, closed, with spans.
    """
    known = story.robots
    found = {name: Timeline(name, known.get(name), True) for name in sorted(robots, key=natural_order)}
    owners: Dict[Any, Any] = {}
    others: Dict[Any, Any] = {}
    nodes: Dict[Any, Any] = {}
    for time_ns, name, kind, values in recording:
        if kind in MESSAGES:
            sender = (json.loads(values) or [''])[0]
            nodes.setdefault(sender, Timeline(sender)).ticks.append(time_ns)
        elif kind not in RADIO:
            if name not in owners:
                owners[name] = owner(name, found)
            if owners[name] is None:
                others.setdefault(name, Timeline(name)).ticks.append(time_ns)
    rest = [others[name] for name in sorted(others, key=natural_order)]
    return [*found.values(), *rest, *(nodes[name] for name in sorted(nodes, key=natural_order) if name)]


def find_links(recording: Any, robots: Any) -> Any:
    """Return [{'ends': [end, end], 'times': [ns], 'up': [bool]}] for the links whose ends can be shown.

    An end is {'robot': its number among ``robots`` (names)}, or {'name', 'x', 'y'} [m] for a host that stands still.
    Any program may write rows; those of another form are left out.
    """
    numbers = {name: number for number, name in enumerate(robots)}
    places: Dict[Any, Any] = {}
    links: Dict[Any, Any] = {}
    for time_ns, name, kind, text in recording:
        if kind not in ('link', 'host'):
            continue
        values = json.loads(text)
        if kind == 'host' and len(values) == 2 and all(map(is_number, values)):
            places[name] = {'name': name, 'x': values[0], 'y': values[1]}
        elif kind == 'link' and len(values) == 3 and all(isinstance(one, str) for one in values):
            times, states = links.setdefault(tuple(values[:2]), ([], []))
            times.append(time_ns)
            states.append(values[2] == 'up')
    ends = {**places, **{name: {'robot': number} for name, number in numbers.items()}}
    return [{'ends': [ends[one] for one in pair], 'times': times, 'up': states}
            for pair, (times, states) in links.items() if all(one in ends for one in pair)]
