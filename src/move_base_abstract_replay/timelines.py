"""The rows of the timeline: what robots did and when, and when other names were in the log."""
import json
import re

from move_base_abstract.runs.run_difference import MESSAGES
from move_base_abstract.runs.states import IDLE
from move_base_abstract.runs.story import owner

#: the kinds of events of the radio; hosts get no rows in the timeline
RADIO = ('radio', 'radio_lost', 'link', 'host')


class Timeline:
    """One row of the timeline.

    A robot has ``spans`` (those of its Story, without those in which it is idle) and ``failures`` [ns]; other names
    have ``ticks`` [ns].
    """

    def __init__(self, name, robot=None, is_robot=False):
        self.name = name
        self.is_robot = is_robot
        self.spans = [span for span in robot.spans if span.state != IDLE] if robot else []
        self.failures = robot.missed if robot else []
        self.ticks = []


def find_timelines(recording, story, robots):
    """Return the Timelines of a Recording: those of ``robots`` (names) in natural order, then those of other names.

    Of these, names with rows of their own come before nodes of which the log has only messages. ``story``: the Story of
    the Recording, closed, with spans.
    """
    known = story.robots
    found = {name: Timeline(name, known.get(name), True) for name in sorted(robots, key=natural)}
    owners, others, nodes = {}, {}, {}
    for time_ns, name, kind, values in recording:
        if kind in MESSAGES:
            sender = (json.loads(values) or [''])[0]
            nodes.setdefault(sender, Timeline(sender)).ticks.append(time_ns)
        elif kind not in RADIO:
            if name not in owners:
                owners[name] = owner(name, found)
            if owners[name] is None:
                others.setdefault(name, Timeline(name)).ticks.append(time_ns)
    rest = [others[name] for name in sorted(others, key=natural)]
    return [*found.values(), *rest, *(nodes[name] for name in sorted(nodes, key=natural) if name)]


def natural(name):
    """Return a key that sorts names with their numbers by value: robot_2 before robot_10."""
    return [(0, int(text), '') if text[0] in '0123456789' else (1, 0, text) for text in
            re.findall(r'[0-9]+|[^0-9]+', name)], name
