"""What the page shows of a log, as columns: events, motions, rows of the timeline, notes."""
import os

from move_base_abstract.common.shown import shown_text

from .links import find_links
from .motions import Motions
from .packed import Packer
from .states import NAMES, find_timelines

_MOTION_COLUMNS = ('x', 'y', 'yaw', 'goal_x', 'goal_y', 'goal_yaw')


class Run:
    """One log as the page has it: packed for the script, ``facts`` and ``notes`` for people, ``box`` [m]."""

    def __init__(self, recording):
        self.name = shown_text(os.path.basename(recording.path))
        self.recording = recording
        self.motions = Motions(recording)
        self.timelines = find_timelines(recording, list(self.motions.tracks))
        self.links = find_links(recording, [line.name for line in self.timelines if line.is_robot])
        self.box = _box(self.motions, self.links)

    @property
    def facts(self):
        """What the log holds, in a few words each."""
        recording = self.recording
        robots = sum(timeline.is_robot for timeline in self.timelines)
        # Not the motions: a leg with corners is several of them.
        legs = sum(kind == 'departed' and name in self.motions.tracks for _, name, kind, _ in recording)
        nodes = len(self.timelines) - robots
        return [*([_count(robots, 'robot')] if robots or not nodes else []),
                *([_count(nodes, 'other name')] if nodes else []), _count(legs, 'leg'),
                _count(recording.events, 'event'),
                '{} s simulated'.format(_seconds(recording.end_ns - recording.begin_ns)),
                'repeatable' if recording.is_repeatable else 'not repeatable, or worse: see the notes']

    @property
    def notes(self):
        """What must be known to read the page rightly, as sentences."""
        recording, motions = self.recording, self.motions
        notes = ['The run: {}.'.format(remark) for remark in recording.remarks]
        if motions.even:
            notes.append('{} of which the log does not say by which limits: drawn straight and at an even speed, from '
                         'start to end (log_motion: true has the robots say it).'.format(_count(motions.even, 'leg')))
        if motions.astray:
            notes.append('{} not where the limits in the log say: drawn straight and at an even speed.'.format(
                _count(motions.astray, 'leg') + (' ends' if motions.astray == 1 else ' end')))
        if motions.startless:
            notes.append('{} of which the log does not say where the robot stood before: it is shown from its arrival '
                         'on.'.format(_count(motions.startless, 'leg')))
        if recording.left_out:
            notes.append('{} not in the list of events: too many for a page.'.format(
                _count(recording.left_out, 'message') + (' is' if recording.left_out == 1 else ' are')))
        if not motions.tracks:
            notes.append('No robot of this log says where it is: there is a timeline and a list of events, and no map.')
        return notes

    def packed(self):
        """Return the text that data.js unpacks."""
        packer, recording = Packer(), self.recording
        packer.add('event_time', 'f8', recording.times)
        packer.add('event_name', 'u4', recording.names)
        packer.add('event_kind', 'u4', recording.kinds)
        packer.add('event_values', 'text', recording.values)
        self._pack_motions(packer)
        self._pack_timelines(packer)
        return packer.text({
            'name': self.name, 'begin': recording.begin_ns, 'end': recording.end_ns, 'names': recording.name_of,
            'links': self.links, 'kinds': recording.kind_of, 'states': NAMES, 'limits': self.motions.limits,
            'rows': [{'name': timeline.name, 'robot': timeline.is_robot} for timeline in self.timelines]})

    def _pack_motions(self, packer):
        tracks = [self.motions.tracks[timeline.name] for timeline in self.timelines if timeline.is_robot]
        motions = [motion for track in tracks for motion in track.motions]
        packer.add('motion_first', 'u4', _firsts(track.motions for track in tracks))
        packer.add('motion_begin', 'f8', (motion.begin_ns for motion in motions))
        packer.add('motion_end', 'f8', (motion.end_ns for motion in motions))
        packer.add('motion_law', 'u4', (motion.law for motion in motions))
        packer.add('motion_is_last', 'u1', (motion.is_last for motion in motions))
        for place, name in enumerate(_MOTION_COLUMNS):
            packer.add('motion_' + name, 'f8', ((motion.start + motion.goal)[place] for motion in motions))

    def _pack_timelines(self, packer):
        lines = self.timelines
        spans = [span for line in lines for span in line.spans]
        packer.add('span_first', 'u4', _firsts(line.spans for line in lines))
        packer.add('span_begin', 'f8', (span.begin_ns for span in spans))
        packer.add('span_end', 'f8', (span.end_ns for span in spans))
        packer.add('span_state', 'u1', (span.state for span in spans))
        for name, values in (('failure', [line.failures for line in lines]), ('tick', [line.ticks for line in lines])):
            packer.add(name + '_first', 'u4', _firsts(values))
            packer.add(name + '_time', 'f8', (time_ns for times in values for time_ns in times))


def _firsts(groups):
    """Return where each group begins in all of them behind one another, and where the last one ends."""
    firsts = [0]
    for group in groups:
        firsts.append(firsts[-1] + len(group))
    return firsts


def _box(motions, links):
    """Return (x_min, y_min, x_max, y_max) [m] of all places of robots, and of fixed hosts of a radio; or None."""
    places = [place for track in motions.tracks.values() for motion in track.motions
              for place in (motion.start, motion.goal)]
    if not places:
        return None
    places += [(end['x'], end['y']) for link in links for end in link['ends'] if 'x' in end]
    return (min(place[0] for place in places), min(place[1] for place in places),
            max(place[0] for place in places), max(place[1] for place in places))


def _count(number, what):
    return '{:,} {}{}'.format(number, what, '' if number == 1 else 's').replace(',', '\u202f')


def _seconds(duration_ns):
    """Return a duration as text, in s, to the millisecond where that says anything."""
    return '{:,.3f}'.format(duration_ns / 1e9).rstrip('0').rstrip('.').replace(',', '\u202f')
