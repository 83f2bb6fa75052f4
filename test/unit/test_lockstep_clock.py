"""The robots' clock in lockstep, with a participant that only notes what it is told."""
import pytest

from move_base_abstract.fleet import Fleet
from move_base_abstract.fleet.robot_parts import make_robot_parts
from move_base_abstract.fleet.robot_rows import write
from move_base_abstract.goals.client import NoClient
from move_base_abstract.goals.events import robot_stream
from move_base_abstract.goals.navigator import GoalPose
from move_base_abstract.motion.geometry import quaternion_of_yaw
from move_base_abstract.scenario import make_scenario
from move_base_abstract_ros.clocks.lockstep_clock import LockstepClock

S = 1_000_000_000
SCENARIO = {'defaults': {'max_speed': 2.0}, 'robots': [{'name': 'r', 'count': 3}]}


class FakeParticipant:
    """Grants by hand."""

    def __init__(self, now_ns=S):
        self.now_ns = now_ns
        self.source = None
        self.logged = []
        self.constants = []
        self.waits = []

    def set_source(self, source):
        self.source = source

    def constant(self, topic):
        self.constants.append(topic)

    def log(self, robot, kind, values=(), sub=0):
        self.logged.append((self.now_ns, robot, kind, tuple(values), sub))

    def wait_until(self, condition, timeout, what):
        self.waits.append((condition(), timeout, what))

    def grant(self, now_ns):
        self.now_ns = now_ns
        self.source.run(now_ns)

    def run(self):
        """Leap from event to event until there is none."""
        while self.source.next_due_ns() is not None:
            self.grant(self.source.next_due_ns())


@pytest.fixture
def participant():
    return FakeParticipant()


@pytest.fixture
def clock(participant):
    made = LockstepClock(lambda: participant)
    assert made.start()
    return made


def make_navigator(clock, index, spec):
    """Return the navigator of a robot that writes into the clock's event log."""
    stream = robot_stream()
    write(stream, 'trace', clock.record(index))
    return make_robot_parts(spec.settings, spec.name, index, clock.simulation, stream, NoClient(spec.name),
                            None).navigator


def test_the_simulation_starts_with_the_clock_and_is_the_participants_source(clock, participant):
    assert (clock.simulation.now_ns, participant.source, clock.next_due_ns()) == (S, clock, None)
    assert participant.constants == ['/tf_static']


def test_what_is_due_happens_at_its_instant_in_the_order_of_the_robots(clock, participant):
    happened = []
    for due_ns, index in ((3 * S, 0), (2 * S, 7), (2 * S, 1)):
        clock.simulation.queue.schedule(due_ns, index, lambda *times, index=index: happened.append((index, *times)))
    assert clock.next_due_ns() == 2 * S
    participant.grant(2 * S)
    assert happened == [(1, 2 * S, 2 * S), (7, 2 * S, 2 * S)]
    assert (clock.next_due_ns(), clock.now_ns()) == (3 * S, 2 * S)


def test_what_is_due_comes_before_a_command_of_the_same_instant_but_not_before_a_look(clock, participant):
    happened = []
    clock.simulation.queue.schedule(2 * S, 0, lambda *_times: happened.append('due'))
    participant.now_ns = 2 * S
    assert (clock.look_ns(), happened) == (S, [])
    assert (clock.now_ns(), happened) == (2 * S, ['due'])


def test_the_event_log_is_the_trace_of_the_plain_fleet(clock, participant):
    goals = {'r_0': (4.0, 3.0), 'r_1': (0.0, 10.0), 'r_2': (0.0, 0.0)}
    scenario = make_scenario(SCENARIO)
    fleet = Fleet(scenario)
    for name, place in goals.items():
        fleet.robot(name).send(*place, goal_id='goal')
    fleet.at(3 * S, lambda fleet: fleet.robot('r_1').cancel())
    fleet.run()
    navigators = {spec.name: make_navigator(clock, index, spec) for index, spec in enumerate(scenario.robots)}
    for name, place in goals.items():
        navigators[name].receive('goal', 0, GoalPose('map', 0, place, quaternion_of_yaw(0.0)), clock.simulation.now_ns)
    clock.simulation.queue.schedule(3 * S, 99, lambda due_ns, _now_ns: navigators['r_1'].cancel('', 0, due_ns))
    participant.run()
    assert [entry[:4] for entry in participant.logged] == fleet.trace
    assert {entry[1]: entry[4] for entry in participant.logged} == {'r_0': 0, 'r_1': 1, 'r_2': 2}


def test_rows_are_those_of_the_robots_or_in_the_order_in_which_they_happen(clock, participant):
    row = (0, 'robot_3', 'left', 'zone gate')
    clock.record(3)(row)
    clock.keep_causal_rows()
    clock.record(3)(row)
    assert [row[-1] for row in participant.logged] == [3, 0]


def test_waits_are_the_participants_and_nothing_waits_for_the_wall(clock, participant):
    clock.wait_until(lambda: 'the condition', 0.25, 'the frame')
    assert participant.waits == [('the condition', 0.25, 'the frame')]
    assert clock.wall_to_ns(5.0) == 0
