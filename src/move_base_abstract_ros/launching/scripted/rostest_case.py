"""`lockstep_launch` as a test of rostest: the result file has a case for each thing that a run promises.

    <test pkg="move_base_abstract" type="lockstep_launch" test-name="mission" time-limit="120"
          args="--check $(find my_study)/launch/system.launch robots:=3"/>

The run has a ROS master of its own; rostest's time limit holds for it. There is a case for the end of the run, for each
property that is broken and, if the run ran, for each built-in property that was asked for (--check: all) and each
statement that was made.
"""
import collections
import json
import os
import signal
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

from move_base_abstract.common import processes
from move_base_abstract.common.shown import shown_text
from move_base_abstract.runs.built_in import BUILT_IN

from .. import command_line

_OUTPUT = '--gtest_output=xml:'
_LAST_LINES = 15
_GOOD, _BROKEN = 0, 4  # of lockstep_launch


def is_asked(words):
    """Return whether rostest has given these words of a command line."""
    return any(word.startswith(_OUTPUT) for word in words)


def run(words, launch):
    """Run the launch file; exit with 0, or with 1 if a property is broken or the run did not come to its end.

    launch(words): runs lockstep_launch with these words in this process, and returns its Launched.
    """
    results = [word[len(_OUTPUT):] for word in words if word.startswith(_OUTPUT)]
    # rostest adds options of its own, and remappings that begin with two underscores.
    words = [word for word in words if not word.startswith(('--gtest_', '__')) and word != '--text']
    name = next((word[len('__name:='):] for word in sys.argv if word.startswith('__name:=')), 'lockstep_launch')
    cases = _run(words, launch)
    _write(results[-1], name, cases)
    for case, problem in cases.items():
        print('{}: {}'.format(case, 'broken: ' + problem if problem else 'kept'))
    if any(cases.values()):
        print('next: the same run: ' + command_line.typed('lockstep_launch', words))
    sys.exit(1 if any(cases.values()) else 0)


def _run(words, launch):
    """Run lockstep_launch in a fork; return {case: what is wrong, or ''}."""
    read, write = os.pipe()
    with tempfile.TemporaryFile('w+') as outcome:
        def child():
            for number in (1, 2):
                os.dup2(write, number)
            launched = launch(words)
            json.dump({**launched.judged.told(), 'debugged': launched.debugged}, outcome)
            outcome.flush()
            sys.exit(launched.code)
        process = processes.Held(processes.Forked(processes.fork(child, new_session=True)))
        os.close(write)
        last, signals = collections.deque(maxlen=_LAST_LINES), []
        for each in (signal.SIGINT, signal.SIGTERM):  # from rostest, when time is up: no process must stay behind
            signal.signal(each, lambda number, _: (signals.append(number), process.send_signal(signal.SIGINT)))
        with open(read, errors='replace') as lines:
            for line in lines:
                print(line, end='', flush=True)
                last.append(line.rstrip('\n'))
        code = process.wait()
        outcome.seek(0)
        told = json.loads(outcome.read() or '{"judged": [], "broken": [], "statements": []}')
    ended = '' if code in (_GOOD, _BROKEN) and not signals else 'the run did not come to its end ({}):\n{}'.format(
        'it was ended from outside' if signals else 'exit code {}'.format(code), '\n'.join(map(shown_text, last)))
    return {'the run comes to its end': ended, **_cases(told)}


def _cases(told):
    judged = told['judged']
    cases = {'{}: {}'.format(one.name, one.sentence): '' for one in BUILT_IN.values() if one.name in judged}
    for node, kind, text, _outcome in told['statements']:
        if kind in judged:  # a `sometimes` is not: a single run cannot break it
            cases['{}: {}: {}'.format(kind, node, text)] = ''
    for one in told['broken']:
        kind = one['property']
        case = '{}: {}'.format(kind, BUILT_IN[kind].sentence) if kind in BUILT_IN else '{}: {}: {}'.format(
            kind, one['node'], one['text'])
        cases[case] = cases.get(case) or '\n'.join(
            [one['words'], *(['before that, in the debugger: ' + told['debugged']] if told.get('debugged') else [])])
    return cases


def _write(path, name, cases):
    """Write the result file in JUnit's format."""
    suite = ElementTree.Element('testsuite', name=name, tests=str(len(cases)), errors='0',
                                failures=str(sum(map(bool, cases.values()))), time='0')
    for case, problem in cases.items():
        element = ElementTree.SubElement(suite, 'testcase', classname=name, name=case, time='0')
        if problem:
            failure = ElementTree.SubElement(element, 'failure', type='broken', message=problem.splitlines()[0])
            failure.text = problem
    os.makedirs(os.path.dirname(os.path.abspath(path)), exist_ok=True)
    part = path + '.part'
    ElementTree.ElementTree(suite).write(part, encoding='utf-8', xml_declaration=True)
    os.replace(part, path)
