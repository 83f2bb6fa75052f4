"""The findings in a scenario, in the words that the user reads."""
from __future__ import annotations

from typing import List, NamedTuple, Sequence, Tuple

#: the kinds of findings, in the order in which they are shown: (kind, headline)
KINDS = (
    ('start_in_wall', 'robots that start where they cannot be'),
    ('starts_overlap', 'robots that start on one another'),
    ('place_in_wall', 'places, chargers and goals that the map or the bounds refuse'),
    ('node_in_wall', 'nodes and lanes in walls'),
    ('off_net', 'places, chargers and goals off the net of lanes'),
    ('dead_end', 'dead ends of the net of lanes'),
    ('unreachable', 'places that no robot, or not every robot, can reach'),
    ('out_of_charge', 'chargers and charge'),
    ('can_lock', 'capacities that can lock'),
    ('bars_ways', 'places where a robot that stands bars the ways of others'),
    ('cannot_pass', 'robots that cannot pass each other'),
    ('beyond_calibration', 'goals beyond what a calibration was fitted to'),
    ('not_checked', 'what could not be checked'),
)


class Finding(NamedTuple):
    """One finding.

    ``kind``: one of KINDS; ``name``: of the robot, place or lane; ``what`` was found; ``where`` in the file it is
    defined; ``advice``: what to do. For the picture: ``points``: ((x, y), ...) [m, global frame]; ``ways``: lines of
    such points.
    """

    kind: str
    name: str
    what: str
    where: str
    advice: str
    points: Tuple[Tuple[float, float], ...] = ()
    ways: Tuple[Tuple[Tuple[float, float], ...], ...] = ()

    def text(self) -> str:
        """Return the finding as lines for a terminal."""
        return '{}: {}\n    where: {}\n    do: {}'.format(self.name, self.what, self.where, self.advice)

    def record(self) -> dict:
        """Return the finding as a mapping for JSON."""
        return {'kind': self.kind, 'name': self.name, 'what': self.what, 'where': self.where, 'advice': self.advice,
                'points': [list(point) for point in self.points]}


def in_order(findings: Sequence[Finding]) -> List[Finding]:
    """Return ``findings`` sorted by kind; those of one kind keep their order."""
    order = [kind for kind, _ in KINDS]
    return sorted(findings, key=lambda one: order.index(one.kind))


def listed(names: Sequence[str], most: int = 5) -> str:
    """Return the first ``most`` names as a text: 'a, b and 3 more'."""
    names = list(names)
    if len(names) <= most:
        return ', '.join(names)
    return '{} and {} more'.format(', '.join(names[:most]), len(names) - most)
