"""Logs and pages of replays for the tests in a browser."""
import random

from move_base_abstract.fleet import Fleet
from move_base_abstract.scenario import make_scenario
from move_base_abstract_replay.page import write_page
from test_replay_recording import S, log_text

LIMITS = {'max_speed': 1.5, 'acceleration': 0.4, 'turn_rate': 0.8, 'log_motion': True}


def small_run(last=(4.0, 4.0)):
    """Return the trace of three robots; ``last`` is the last goal of the first robot, (x, y) [m]."""
    fleet = Fleet(make_scenario({'defaults': LIMITS, 'robots': [{'name': 'robot', 'count': 3, 'start_x': 4.0,
                                                                 'start_y': 4.0, 'step_y': 4.0}]}))
    fleet.robot('robot_0').send(30.0, 20.0, 1.0)
    fleet.robot('robot_1').send(4.0, 36.0)
    fleet.at(10 * S, lambda fleet: fleet.robot('robot_1').send(56.0, 4.0))
    fleet.at(60 * S, lambda fleet: fleet.robot('robot_0').send(*last))
    fleet.run()
    return fleet.trace


def many_legs(robots=20, legs=100_000):
    """Return the events of ``legs`` legs, for which the log has no limits of motion."""
    draw, entries, now_ns = random.Random(5), [], S
    for name in ('robot_{}'.format(number) for number in range(robots)):
        entries.append((now_ns, name, 'stands', (0.0, 0.0, 0.0)))
    for leg in range(legs // robots):
        for number in range(robots):
            name, goal = 'robot_{}'.format(number), (draw.uniform(0.0, 60.0), draw.uniform(0.0, 40.0), 0.0)
            entries += [(now_ns, name, 'departed', goal), (now_ns + S * 3 // 4, name, 'stands', goal),
                        (now_ns + S * 3 // 4, name, 'ended', ('g-{}'.format(leg), 'SUCCEEDED', 'Goal reached.'))]
        now_ns += S
    return sorted(entries, key=lambda entry: entry[0])


def page(folder, name, *runs, map_file=None):
    """Write a page with the events of some runs; return its path."""
    logs = []
    for number, entries in enumerate(runs):
        logs.append(folder / '{}_{}.jsonl'.format(name, number))
        logs[-1].write_text(log_text(entries))
    write_page(logs, folder / (name + '.html'), map_file)
    return folder / (name + '.html')
