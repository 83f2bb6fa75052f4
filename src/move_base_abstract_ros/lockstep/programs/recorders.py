"""rosbag's recorders among a launch file's nodes, and the topics that they would record although they bypass lockstep.

A recorder that takes part writes the same bytes in each run, as long as it records only topics of lockstep.
"""
from __future__ import annotations

import os
import re
from types import SimpleNamespace
from typing import Any, List, Sequence, Tuple

PAST_LOCKSTEP = ('/clock', '/rosout', '/rosout_agg')
_TIME_MASTERS = '/time_master/.*'
_WITH_VALUE = 'xoObLl'  # short options whose value follows
_LONG_WITH_VALUE = ('--output', '--buff', '--chunk', '--limit', '--min', '--max', '--topic', '--size', '--dur',
                    '--node')
_SCRIPT = re.compile(rb'\brosbag\b[^\n]{0,40}\brecord\b')
# A line of a shell script that becomes `rosbag record`, or passes its node's name on to it.
_FOLLOWED = re.compile(rb'^[ \t]*(exec[ \t]+rosbag[ \t]+record\b.*|rosbag[ \t]+record\b.*\$[@*].*)$', re.MULTILINE)
_LARGEST = 1 << 20  # number of bytes of a script that are searched


def is_recorder(node: Any) -> bool:
    """Return whether a roslaunch Node is rosbag's recorder."""
    return (node.package, node.type) == ('rosbag', 'record')


def is_program(path: str) -> bool:
    """Return whether a path is that of rosbag's recorder."""
    return path.endswith('/rosbag/record')


def starts_recorder(path: str) -> bool:
    """Return whether a script contains a call of rosbag's recorder."""
    try:
        with open(path, 'rb') as stream:
            text = stream.read(_LARGEST)
    except OSError:
        return False
    return text.startswith(b'#!') and _SCRIPT.search(text) is not None


def becomes_recorder(text: bytes) -> bool:
    """Return whether a shell script's text makes its node ``rosbag record``; ``rosrun rosbag`` is not followed."""
    return _FOLLOWED.search(text) is not None


class Words:
    """The command line of a recorder: the topics that it names, whether it finds others, and those it leaves out."""

    def __init__(self, words: Sequence[str]) -> None:
        self.words = list(words)
        self.topics = []
        self.finds = False
        self.exclude: Any = None  # (index of the word, the regular expression)
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

    def _take_long(self, at: int, word: str) -> bool:
        """Take a long option; return whether the next word is its value. rosbag takes shortened options, too."""
        name, equals, value = word.partition('=')
        self.finds = self.finds or name in ('--all', '--regex') or name.startswith(('--a', '--reg', '--node'))
        if name.startswith('--e'):
            self.exclude = (at, value) if equals else (at + 1, self._word(at + 1))
            return not equals
        return not equals and name.startswith(_LONG_WITH_VALUE)

    def _take_short(self, at: int, word: str) -> bool:
        for place, letter in enumerate(word[1:], 1):
            self.finds = self.finds or letter in 'ae'
            if letter in _WITH_VALUE:
                value = word[place + 1:]
                if letter == 'x':
                    self.exclude = (at, value) if value else (at + 1, self._word(at + 1))
                return not value
        return False

    def _word(self, at: int) -> str:
        return self.words[at] if at < len(self.words) else ''

    def without(self, expressions: Any) -> Any:
        """Return the words, changed so that the recorder leaves out topics that match one of these expressions."""
        words = list(self.words)
        if self.exclude is None:
            words += ['-x', '|'.join(expressions)]
        else:
            at, old = self.exclude
            new = '|'.join(['(?:{})'.format(old), *expressions])
            if at < len(words):
                words[at] = words[at][:len(words[at]) - len(old)] + new
        return words


def _past(excluded: Sequence[Any]) -> List[str]:
    return [*PAST_LOCKSTEP, *(topic for topic in excluded if topic.startswith('/'))]


def past_lockstep(arguments: Sequence[str], namespace: str,
                  excluded: Sequence[Any] = ()) -> Tuple[List[str], List[str]]:
    """Return the topics of a recorder that bypass lockstep: (those left out if it takes part, those that it names).

    :param arguments: the recorder's words.
    :param namespace: the namespace of its node.
    :param excluded: the topics that the time master excludes.
    """
    from rosgraph.names import ns_join  # only here: the launcher of a binary needs none of it
    words, past = Words(arguments), _past(excluded)
    if words.finds:
        return [*past, _TIME_MASTERS[:-2] + '...'], []
    return [], [topic for topic in words.topics
                if ns_join(namespace, topic) in past or re.match(_TIME_MASTERS, topic)]


def without_past_lockstep(arguments: Any, excluded: Any = ()) -> Any:
    """Return a recorder's words, changed so that it does not look for topics that bypass lockstep.

    Messages on these differ from run to run. Topics that the words name stay.
    """
    words = Words(arguments)
    if not words.finds:
        return list(arguments)
    return words.without([*map(re.escape, _past(excluded)), _TIME_MASTERS])


def behind_front_end(path: str, arguments: Any) -> Any:
    """Return (program, words) of the recorder that rosbag's own script ``rosbag record`` would start.

    Return None if ``path`` is another script.
    """
    if os.path.basename(path) != 'rosbag' or arguments[:1] != ['record']:
        return None
    from rosbag import rosbag_main
    found = []

    def take(command: Any) -> Any:
        found.append(command)
        return SimpleNamespace(wait=lambda: None)
    rosbag_main.subprocess = SimpleNamespace(Popen=take)  # rosbag itself translates the options for the program
    rosbag_main.signal = SimpleNamespace(signal=lambda *_: None, SIGTERM=None, SIGINT=None)
    rosbag_main.record_cmd(arguments[1:])
    return found[0][0], found[0][1:]
