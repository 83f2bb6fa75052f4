"""The data of a log for the page, as columns: events, motions, rows of the timeline, notes."""
from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Dict, List, Optional, Sequence

from move_base_abstract.common.shown import shown_text
from move_base_abstract.motion.pieces import Piece
from move_base_abstract.motion.told import told
from move_base_abstract.runs import debug_command
from move_base_abstract.runs.story import Story

from .charges import Charges
from .motions import Motions
from .packed import Packer
from .stays import count_orders, find_limits, find_phases, find_stays
from .timelines import find_links, find_timelines
from .world import Box, World, box_of

if TYPE_CHECKING:
    from .recording import Recording

NOBODY = 2 ** 32 - 1  # stands for a robot's number where there is no robot


class Run:
    """The data of one log for the page: packed() for the script, ``facts`` and ``notes`` for people, ``box`` [m]."""

    def __init__(self, recording: Recording, world: World = World()) -> None:
        self.name = shown_text(os.path.basename(recording.path))
        self.recording = recording
        self.world = world
        self._charges = Charges(world, recording.begin_ns)
        self.motions = Motions(recording, world, self._charges)
        story = story_of(recording, world)
        self.stays = find_stays(story, world)
        self.limits = find_limits(recording, world)
        self.phases, self.counts = find_phases(story.orders), count_orders(story.orders)
        self.timelines = find_timelines(recording, story, list(self.motions.tracks))
        self.links = find_links(recording, [line.name for line in self.timelines if line.is_robot])
        self.box = _box(self.motions, self.links, world)

    @property
    def facts(self) -> List[str]:
        """The facts about the log, in a few words each."""
        recording = self.recording
        robots = sum(timeline.is_robot for timeline in self.timelines)
        legs = sum(kind == 'departed' and name in self.motions.tracks for _, name, kind, _ in recording)
        nodes = len(self.timelines) - robots
        return [*([_count(robots, 'robot')] if robots or not nodes else []),
                *([_count(nodes, 'other name')] if nodes else []), _count(legs, 'leg'),
                _count(recording.events, 'event'),
                '{} s simulated'.format(_seconds(recording.end_ns - recording.begin_ns)),
                'repeatable' if recording.is_repeatable else 'not repeatable, or worse: see the notes']

    @property
    def notes(self) -> List[str]:
        """What a reader must know to understand the page, as sentences."""
        recording, motions = self.recording, self.motions
        notes = ['The run: {}.'.format(remark) for remark in recording.remarks]
        if motions.even:
            notes.append('{} without its motion in the log: drawn straight, at an even speed (log_motion: true '
                         'writes it; logs of earlier releases have none).'.format(_count(motions.even, 'leg')))
        if motions.startless:
            notes.append('{} before which the log does not say where the robot stood: the robot is shown from its '
                         'arrival on.'.format(_count(motions.startless, 'leg')))
        if recording.left_out:
            notes.append('{} not in the list of events: too many for a page.'.format(
                _count(recording.left_out, 'message') + (' is' if recording.left_out == 1 else ' are')))
        if not motions.tracks:
            notes.append('No robot of this log says where it is: there is a timeline and a list of events, but no map.')
        return notes

    def packed(self) -> str:
        """Return the text that data.js unpacks."""
        packer, recording = Packer(), self.recording
        packer.add('event_time', 'f8', recording.times)
        packer.add('event_name', 'u4', recording.names)
        packer.add('event_kind', 'u4', recording.kinds)
        packer.add('event_values', 'text', (
            '[{}]'.format(values.count('[') - 1) if recording.kind_of[kind] == 'pieces' else values
            for kind, values in zip(recording.kinds, recording.values)))  # the map has them
        self._pack_motions(packer)
        self._pack_timelines(packer)
        self._pack_stays(packer)
        self._pack_charges(packer)
        self._pack_orders(packer)
        return packer.text({
            'name': self.name, 'begin': recording.begin_ns, 'end': recording.end_ns, 'names': recording.name_of,
            'links': self.links, 'kinds': recording.kind_of, 'is_whole': not recording.left_out,
            'debug': debug_command.of_log(os.path.abspath(recording.path)),
            'orders': list({phase.order: None for phase in self.phases}),
            'rows': [{'name': timeline.name, 'robot': timeline.is_robot} for timeline in self.timelines]})

    def _pack_motions(self, packer: Packer) -> None:
        tracks = [self.motions.tracks[timeline.name] for timeline in self.timelines if timeline.is_robot]
        driven = [one for track in tracks for one in track.driven]
        pieces = [told(one.motion) for one in driven]
        packer.add('motion_first', 'u4', _firsts(track.driven for track in tracks))
        packer.add('motion_begin', 'f8', (one.motion.depart_ns for one in driven))
        packer.add('motion_end', 'f8', (one.end_ns for one in driven))
        packer.add('piece_first', 'u4', _firsts(pieces))
        for place, name in enumerate(Piece._fields):
            packer.add('piece_' + name, 'f8', (piece[place] for own in pieces for piece in own))

    def _pack_timelines(self, packer: Packer) -> None:
        lines = self.timelines
        spans = [span for line in lines for span in line.spans]
        packer.add('span_first', 'u4', _firsts(line.spans for line in lines))
        packer.add('span_begin', 'f8', (span.begin_ns for span in spans))
        packer.add('span_end', 'f8', (span.end_ns for span in spans))
        packer.add('span_state', 'u1', (span.state for span in spans))
        for name, values in (('failure', [line.failures for line in lines]), ('tick', [line.ticks for line in lines])):
            packer.add(name + '_first', 'u4', _firsts(values))
            packer.add(name + '_time', 'f8', (time_ns for times in values for time_ns in times))

    def _pack_stays(self, packer: Packer) -> None:
        numbers = self._numbers
        stays = [stay for stay in self.stays if stay.robot in numbers]
        _pack_spans(packer, 'stay', stays)
        packer.add('stay_robot', 'u4', (numbers[stay.robot] for stay in stays))
        packer.add('stay_thing', 'u4', (stay.thing for stay in stays))
        packer.add('stay_kind', 'u1', (stay.kind for stay in stays))
        packer.add('limit_time', 'f8', (one.time_ns for one in self.limits))
        packer.add('limit_thing', 'u4', (one.thing for one in self.limits))
        packer.add('limit_speed', 'f8', (one.speed for one in self.limits))

    def _pack_charges(self, packer: Packer) -> None:
        knots = [self._charges.knots.get(name, []) for name in self._numbers]
        packer.add('charge_first', 'u4', _firsts(knots))
        packer.add('charge_time', 'f8', (time_ns for own in knots for time_ns, _ in own))
        packer.add('charge_share', 'f8', (share for own in knots for _, share in own))

    def _pack_orders(self, packer: Packer) -> None:
        phases, numbers = self.phases, self._numbers
        names = {name: number for number, name in enumerate({phase.order: None for phase in phases})}
        _pack_spans(packer, 'phase', phases)
        packer.add('phase_order', 'u4', (names[phase.order] for phase in phases))
        packer.add('phase_robot', 'u4', (numbers.get(phase.robot, NOBODY) for phase in phases))
        for name in ('kind', 'stop', 'stops'):
            packer.add('phase_' + name, 'u4', (getattr(phase, name) for phase in phases))
        for name in ('x', 'y'):
            packer.add('phase_' + name, 'f8', (getattr(phase, name) for phase in phases))
        packer.add('count_time', 'f8', (row[0] for row in self.counts))
        packer.add('count', 'u4', (value for row in self.counts for value in row[1:]))

    @property
    def _numbers(self) -> Dict[str, int]:
        """{robot: its number in the page}."""
        return {timeline.name: number for number, timeline in enumerate(self.timelines) if timeline.is_robot}


def story_of(recording: Recording, world: World = World()) -> Story:
    """Return the Story of a Recording in a World, with spans and stays."""
    story = Story(recording.begin_ns, list(world.starts), keeps_spans=True)
    for row in recording.rows():
        story.take(*row)
    story.close(recording.end_ns)
    return story


def _pack_spans(packer: Packer, name: str, spans: Sequence[Any]) -> None:
    """Pack the begins and ends of spans as one row of changes: at which time which span begins (1) or ends (0)."""
    changes = sorted([(span.end_ns, 0, number) for number, span in enumerate(spans)]
                     + [(span.begin_ns, 1, number) for number, span in enumerate(spans)])
    packer.add(name + '_change_time', 'f8', (time_ns for time_ns, _, _ in changes))
    packer.add(name + '_change_is_begin', 'u1', (is_begin for _, is_begin, _ in changes))
    packer.add(name + '_change_of', 'u4', (number for _, _, number in changes))


def _firsts(groups: Any) -> List[int]:
    """Return where each group begins if all are joined, and where the last one ends."""
    firsts = [0]
    for group in groups:
        firsts.append(firsts[-1] + len(group))
    return firsts


def _box(motions: Motions, links: Sequence[Any], world: World) -> Optional[Box]:
    """Return the Box around all robots, the world and a radio's fixed hosts, or None."""
    places = [place for track in motions.tracks.values() for one in track.driven for place in one.motion.way]
    places += world.points
    return box_of([*places, *((end['x'], end['y']) for link in links for end in link['ends'] if 'x' in end)]) \
        if places else None


def _count(number: int, what: str) -> str:
    return '{:,} {}{}'.format(number, what, '' if number == 1 else 's').replace(',', '\u202f')


def _seconds(duration_ns: int) -> str:
    """Return a duration as text in s, to the millisecond, without trailing zeros."""
    return '{:,.3f}'.format(duration_ns / 1e9).rstrip('0').rstrip('.').replace(',', '\u202f')
