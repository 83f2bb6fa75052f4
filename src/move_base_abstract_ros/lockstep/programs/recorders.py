"""rosbag's recorders among a launch file's nodes: what they record of what goes past lockstep, and what nobody covers.

A recorder that takes part writes the same bytes in each run, as long as it records what goes through lockstep.
"""
import os
import re
from types import SimpleNamespace

PAST_LOCKSTEP = ('/clock', '/rosout', '/rosout_agg')
_TIME_MASTERS = '/time_master/.*'
_WITH_VALUE = 'xoObLl'  # short options whose value follows
_LONG_WITH_VALUE = ('--output', '--buff', '--chunk', '--limit', '--min', '--max', '--topic', '--size', '--dur',
                    '--node')
_SCRIPT = re.compile(rb'\brosbag\b[^\n]{0,40}\brecord\b')
# A line of a shell script that becomes `rosbag record`, or hands its name on to it.
_FOLLOWED = re.compile(rb'^[ \t]*(exec[ \t]+rosbag[ \t]+record\b.*|rosbag[ \t]+record\b.*\$[@*].*)$', re.MULTILINE)
_LARGEST = 1 << 20  # bytes of a script that are looked at


def is_recorder(node):
    """Whether a roslaunch Node is rosbag's recorder."""
    return (node.package, node.type) == ('rosbag', 'record')


def is_program(path):
    """Whether a path is that of rosbag's recorder."""
    return path.endswith('/rosbag/record')


def starts_recorder(path):
    """Whether a script has a call of rosbag's recorder in it."""
    try:
        with open(path, 'rb') as stream:
            text = stream.read(_LARGEST)
    except OSError:
        return False
    return text.startswith(b'#!') and _SCRIPT.search(text) is not None


def becomes_recorder(text):
    """Whether the text of a shell script says that its node is `rosbag record`; `rosrun rosbag` is not followed."""
    return _FOLLOWED.search(text) is not None


class Words:
    """The command line of a recorder: which topics it names, whether it finds others, and what it leaves out."""

    def __init__(self, words):
        self.words = list(words)
        self.topics = []
        self.finds = False
        self.exclude = None  # (index of the word, the regular expression)
        skip = False
        for at, word in enumerate(self.words):
            if skip:
                skip = False
            elif word.startswith('--'):
                skip = self._take_long(at, word)
            elif word.startswith('-') and len(word) > 1:
                skip = self._take_short(at, word)
            elif ':=' not in word:
                self.topics.append(word)

    def _take_long(self, at, word):
        """Return whether the next word is this one's value. rosbag takes shortened options too."""
        name, equals, value = word.partition('=')
        self.finds = self.finds or name in ('--all', '--regex') or name.startswith(('--a', '--reg', '--node'))
        if name.startswith('--e'):
            self.exclude = (at, value) if equals else (at + 1, self._word(at + 1))
            return not equals
        return not equals and name.startswith(_LONG_WITH_VALUE)

    def _take_short(self, at, word):
        for place, letter in enumerate(word[1:], 1):
            self.finds = self.finds or letter in 'ae'
            if letter in _WITH_VALUE:
                value = word[place + 1:]
                if letter == 'x':
                    self.exclude = (at, value) if value else (at + 1, self._word(at + 1))
                return not value
        return False

    def _word(self, at):
        return self.words[at] if at < len(self.words) else ''

    def without(self, expressions):
        """Return the words with topics left out that one of these regular expressions fits."""
        words = list(self.words)
        if self.exclude is None:
            words += ['-x', '|'.join(expressions)]
        else:
            at, old = self.exclude
            new = '|'.join(['(?:{})'.format(old), *expressions])
            if at < len(words):
                words[at] = words[at][:len(words[at]) - len(old)] + new
        return words


def past_lockstep(arguments, namespace, excluded=()):
    """Return what of a recorder's topics goes past lockstep, when its words say so: (left out, named by it).

    :param excluded: topics that the time master does not count.
    """
    from rosgraph.names import ns_join  # only here: the launcher of a binary needs none of it
    words = Words(arguments)
    past = [*PAST_LOCKSTEP, *(topic for topic in excluded if topic.startswith('/'))]
    if words.finds:
        return [*past, _TIME_MASTERS[:-2] + '...'], []
    return [], [topic for topic in words.topics
                if ns_join(namespace, topic) in past or re.match(_TIME_MASTERS, topic)]


def without_past_lockstep(arguments, excluded=()):
    """Return the words of a recorder that does not look for what goes past lockstep: that differs from run to run."""
    words = Words(arguments)
    if not words.finds:
        return list(arguments)
    past = [*PAST_LOCKSTEP, *(topic for topic in excluded if topic.startswith('/'))]
    return words.without([*map(re.escape, past), _TIME_MASTERS])


def behind_front_end(path, arguments):
    """Return (program, words) of the recorder that a script starts if it is rosbag's own `rosbag record`, or None."""
    if os.path.basename(path) != 'rosbag' or arguments[:1] != ['record']:
        return None
    from rosbag import rosbag_main
    found = []

    def take(command):
        found.append(command)
        return SimpleNamespace(wait=lambda: None)
    rosbag_main.subprocess = SimpleNamespace(Popen=take)  # it says itself what its options are to the program
    rosbag_main.signal = SimpleNamespace(signal=lambda *_: None, SIGTERM=None, SIGINT=None)
    rosbag_main.record_cmd(arguments[1:])
    return found[0][0], found[0][1:]
