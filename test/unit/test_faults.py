"""Errors that nobody expected: wherever one comes up, it ends one goal with its text, and all else goes on."""
import os
import sys

import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.fleet import Fleet, fleet as fleet_module
from move_base_abstract.maps.planning import StraightLinePlanner
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.scenario import make_scenario
from move_base_abstract.tasks.arrivals import Task
from test_encounters import DEAR, calibration

S = 1_000_000_000
CORE = os.path.dirname(os.path.dirname(fleet_module.__file__)) + os.sep
#: the machine that runs events and calls; what goes wrong there is for who called it
MACHINE = {'event_queue.py', 'simulation.py', 'guard.py', 'arguments.py', 'units.py', 'fleet.py', 'chance.py',
           'shown.py', 'alarm.py', 'lazy_exports.py', 'stream.py', 'user_calls.py'}
#: where work begins, and where a state that others go by is set: what goes wrong before their first line undoes nothing
ENTRIES = {('navigator.py', 'receive'), ('travel.py', 'release'), ('room.py', 'give_back'),
           ('ledger.py', 'receive'), ('ledger.py', 'finish'),
           ('place_tasks.py', 'take'), ('room.py', '_admit'), ('room.py', 'ask'),
           ('room.py', '_look'), ('room.py', '_changed'), ('place_tasks.py', 'shut_down'),
           ('traveller.py', '_happen'), ('control.py', '_decide'), ('travel.py', '_change_holds'),
           ('member.py', '_now_ns'), ('member.py', '_worker'), ('member.py', 'send'), ('member.py', 'send_task'),
           ('room.py', '_make_way'), ('room.py', '_refuse'), ('failing.py', '_no'), ('failing.py', 'repair'),
           ('failing.py', '_forget'), ('battery.py', '_is_heard'), ('arrivals.py', 'check_task'),
           ('geometry.py', 'quaternion_of_yaw'), ('control.py', 'goal_number')}
WORLD = {
    'zones': [{'name': 'gate', 'rectangle': [4.0, -9.0, 8.0, 9.0], 'capacity': 1},
              {'name': 'plug', 'rectangle': [-2.0, -9.0, 2.0, 9.0], 'charger': True}],
    'places': [{'name': 'dock', 'x': 12.0, 'reach': 20.0, 'capacity': 1, 'duration': 5.0}],
    'defaults': {'max_speed': 2.0, 'acceleration': 1.0, 'turn_rate': 1.0, 'battery_capacity': 1.0, 'seed': 3,
                 'duration_factor': 1.2, 'failure_times': [3.0], 'failure_kind': 'stall', 'repair_time': 2.0},
    'robots': [{'name': 'r{}'.format(k), 'start_y': 2.0 * k} for k in range(3)]}
NAMES = ['r0', 'r1', 'r2']
TASKS = {name: Task(name + '-task', 0, 'dock', Pose2D()) for name in NAMES}


class Injected(Exception):
    pass


class World:
    """Robots that go through a gate, work and go back; ``fail_at``: the number of the call in which something fails.

    ``room``: the folder of the code in which it fails, '': in any.
    """

    def __init__(self, fail_at, raw=WORLD, room=''):
        self.reported, self.raised, self.calls, self.place = [], [], 0, None
        self._fail_at, self._code = fail_at, os.path.join(CORE, room)
        self.fleet = Fleet(make_scenario(raw), start_ns=0)
        self.fleet.simulation._on_fault = lambda who, error: self.reported.append((who, error))
        for name, y in zip(NAMES, (0.0, 2.0, 4.0)):
            self.fleet.at(0, lambda fleet, name=name, y=y: fleet.robot(name).send(12.0, y, goal_id=name + '-out'))
            self.fleet.at(60 * S, lambda fleet, name=name: fleet.robot(name).send_task(TASKS[name]))
            self.fleet.at(90 * S, lambda fleet, name=name, y=y: fleet.robot(name).send(0.0, y, goal_id=name + '-back'))
        before = sys.gettrace()
        sys.settrace(self._look)
        try:
            while True:
                try:
                    self.fleet.run()
                    break
                except Injected as error:
                    self.raised.append(error)
        finally:
            sys.settrace(before)

    def _look(self, frame, _event, _argument):
        code = frame.f_code
        file = os.path.basename(code.co_filename)
        if not code.co_filename.startswith(self._code) or file in MACHINE or (file, code.co_name) in ENTRIES:
            return
        if code.co_name in ('<genexpr>', '<listcomp>'):
            return
        self.calls += 1
        if self.calls == self._fail_at:
            self.place = '{}:{} {}'.format(file, frame.f_lineno, code.co_name)
            raise Injected('broken')

    def check(self):
        fleet = self.fleet
        assert not self.raised and len(self.reported) == 1
        assert not any(state.waiting for state in fleet.zones)
        for name in NAMES:
            member = fleet.robot(name)
            navigator = member.navigator
            assert not navigator.is_active and not navigator.travel.held_for and navigator.robot.leg is None
            assert member._tasks.ledger.active is None and not member._tasks.is_waiting
            pose = fleet.robot(name).pose
            for zone, state in zip(fleet.scenario.zones, fleet.zones):
                assert zone.contains(pose.x, pose.y) == (name in state.robots)
        ends = {entry.values[0]: entry.values[1:] for entry in fleet.trace if entry.kind in ('ended', 'task_ended')}
        bad = {key: end for key, end in ends.items() if end[0] != 'SUCCEEDED'}
        assert len({key.split('-')[0] for key in bad}) <= 1, bad
        assert all(end[1] == 'The goal cannot be worked on: Injected: broken' for end in bad.values()), bad
        start = fleet.now_ns
        for name in NAMES:
            fleet.robot(name).send(5.0 * NAMES.index(name), -20.0, goal_id=name + '-new')
        fleet.run(start + 600 * S)
        new = [entry.values[1] for entry in fleet.trace if entry.kind == 'ended' and entry.values[0].endswith('-new')]
        assert new == ['SUCCEEDED'] * 3


def test_whatever_breaks_wherever_one_goal_ends_with_its_text_and_all_else_goes_on():
    break_in_turn(61)


def test_whatever_breaks_where_robots_meet_one_goal_ends_with_its_text(tmp_path):
    left_out = 'max_speed', 'acceleration', 'turn_rate', 'duration_factor'
    break_in_turn(211, {**WORLD, 'seed': 5, 'encounters': 'calibrated', 'defaults': {
        'calibration': calibration(tmp_path, DEAR),
        **{name: value for name, value in WORLD['defaults'].items() if name not in left_out}}}, 'encounters')


def break_in_turn(step, *arguments):
    """Have each ``step``-th call break in a world of its own; the world must be in order after it."""
    calls = World(0, *arguments).calls
    assert calls > 3000
    for number in range(1, calls, step):
        world = World(number, *arguments)
        try:
            world.check()
        except AssertionError as error:
            raise AssertionError('broken in call {}: {}'.format(number, world.place)) from error


class Broken(StraightLinePlanner):
    """Has no way to some goals."""

    def corners(self, start, goal):
        if goal.x == 13.0:
            raise OverflowError('cannot convert float infinity to integer')
        return super().corners(start, goal)


def fleet_of(*names, **arguments):
    robots = [{'name': name, 'max_speed': 2.0} for name in names]
    places = [{'name': 'dock', 'duration': 5.0}]
    return Fleet(make_scenario({'robots': robots, 'places': places}), start_ns=0, **arguments)


def ends(fleet):
    return [(entry.time_ns / S, entry.robot, *entry.values[1:]) for entry in fleet.trace if entry.kind == 'ended']


def test_a_goal_that_breaks_its_planner_is_aborted_with_the_text_and_logged_with_the_traceback(caplog):
    fleet = fleet_of('a', 'b', planner=Broken())
    fleet.robot('a').send(2.0, 0.0)
    fleet.at(S // 2, lambda fleet: (fleet.robot('a').send(13.0, 0.0), fleet.robot('b').send(4.0, 0.0)))
    fleet.run()
    text = 'The goal cannot be worked on: OverflowError: cannot convert float infinity to integer'
    assert ends(fleet)[1:] == [(0.5, 'a', 'ABORTED', text), (2.5, 'b', 'SUCCEEDED', 'Goal reached.')]
    assert (fleet.robot('a').pose.x, fleet.robot('a').distance) == (1.0, 1.0)
    assert text in caplog.text and 'Traceback' in caplog.text
    fleet.robot('a').send(2.0, 0.0)
    fleet.run()
    assert ends(fleet)[-1][2] == 'SUCCEEDED'


def test_a_factor_beyond_all_bounds_is_refused_where_it_is_read(tmp_path):
    path = tmp_path / 'quantiles.yaml'
    path.write_text('quantiles: [[0.0, 1.0], [1.0, 1.0e+300]]')
    with pytest.raises(ConfigurationError, match='<= 1e6'):
        make_scenario({'robots': [
            {'name': 'a', 'duration_distribution': 'quantiles', 'duration_quantiles': str(path)}]})


@pytest.mark.parametrize('call, text', [
    (lambda fleet: fleet.robot('a').send('1', 2), "x: got '1'; allowed: a number"),
    (lambda fleet: fleet.robot('a').send(1, None), 'y: got None; allowed: a number'),
    (lambda fleet: fleet.robot('a').send(1, 10 ** 400), 'y: got a whole number of about 401 digits'),
    (lambda fleet: fleet.robot('a').send(1, 2, yaw=True), 'yaw: got True'),
    (lambda fleet: fleet.robot('a').send(1, 2, goal_id=7), 'goal_id: got 7; allowed: a text'),
    (lambda fleet: fleet.robot('a').send(1, 2, frame=b'map'), "frame: got b'map'; allowed: a text"),
    (lambda fleet: fleet.robot('a').place((1, 2)), 'pose: got .1, 2.; allowed: Pose2D'),
    (lambda fleet: fleet.robot('a').hold(3), 'reason: got 3; allowed: a text'),
    (lambda fleet: fleet.robot('a').send_task('dock'), "task: got 'dock'; allowed: Task"),
    (lambda fleet: fleet.robot('a').send_task(Task('t', 0, 'dock', Pose2D(), 1.5)),
     'task: duration_ns: got 1.5; allowed: a'),
    (lambda fleet: fleet.robot('a').send_task(Task('t', 0, 'dock', Pose2D(), 0, '3')),
     "task: power: got '3'; allowed: a number"),
    (lambda fleet: fleet.at(1e9, print), 'time_ns: got 1000000000.0; allowed: a whole number .ns.'),
    (lambda fleet: fleet.run(1e9), 'until_ns: got 1000000000.0; allowed: a whole number .ns.'),
    (lambda fleet: fleet.run_for('1'), "seconds: got '1'; allowed: a number"),
    (lambda fleet: Fleet(start_ns=0.0), 'start_ns: got 0.0; allowed: a whole number .ns.')])
def test_what_is_of_another_kind_is_refused_at_once_and_changes_nothing(call, text):
    fleet = fleet_of('a')
    with pytest.raises(ConfigurationError, match=text):
        call(fleet)
    fleet.run()
    assert fleet.now_ns == 0 and not ends(fleet)


def test_a_goal_whose_predecessors_result_cannot_be_told_is_not_lost(rig, monkeypatch):
    robot = rig()
    with monkeypatch.context() as patch:
        patch.setattr(type(robot.ledger), '_tell_end', lambda ledger, record, stamp_ns: 1 / 0)
        robot.send('one', 10.0, 0.0)
        robot.send('two', 20.0, 0.0)
    assert [(record.goal_id, record.state.name) for record in robot.ledger.records(0)] == [
        ('one', 'PREEMPTED'), ('two', 'ABORTED')]
    robot.send('three', 2.0, 0.0)
    assert ('result', 'three', 'SUCCEEDED', 'Goal reached.', S) in robot.advance(5.0)


def test_what_repeats_goes_on_after_an_error():
    fleet = fleet_of('a')
    beats = []

    def beat(due_ns, _now_ns):
        beats.append(due_ns)
        if len(beats) == 2:
            raise ValueError('once')

    fleet.simulation.series(0, 1.0, beat).start(0)
    fleet.run(4 * S)
    assert beats == [0, S, 2 * S, 3 * S, 4 * S]
