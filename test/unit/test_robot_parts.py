"""The one place where a robot and what works on its goals are put together."""
import pytest

from move_base_abstract.common.errors import FrameError
from move_base_abstract.config.settings import read_settings
from move_base_abstract.engine.simulation import Simulation
from move_base_abstract.fleet import Fleet
from move_base_abstract.fleet.robot_parts import make_robot_parts
from move_base_abstract.goals.client import NoClient
from move_base_abstract.goals.events import Ended, robot_stream
from move_base_abstract.goals.outcome import GoalState
from move_base_abstract.scenario import make_scenario

S = 1_000_000_000


class Answers(NoClient):
    """Notes what the ledger says."""

    def __init__(self):
        super().__init__('made-at')
        self.said = []

    def publish_status(self):
        self.said.append('status')

    def ended(self, event):
        self.said.append((event.goal_id, event.state, event.time_ns))


def no_lookup(frame_id, _stamp_ns):
    raise FrameError(frame_id)


@pytest.fixture
def answers():
    return Answers()


def make(answers, **raw):
    settings = read_settings(raw, '/r')
    stream = robot_stream()
    stream.subscribe('clients', {Ended: answers.ended})
    return make_robot_parts(settings, 'r', 3, Simulation(5 * S), stream, answers, no_lookup)


def test_the_parts_belong_together_and_follow_the_settings(answers):
    parts = make(answers, start_x=1.0, max_speed=2.0, tf_prefix='r', robot_base_frame='base', odom_frame='odometry',
                 global_frame='world')
    assert (parts.robot.index, parts.robot.name, parts.robot.pose_at(5 * S).x) == (3, 'r', 1.0)
    assert parts.navigator.robot is parts.robot
    frames = parts.frames
    assert (frames.global_frame, frames.odom_frame, frames.base_frame) == ('world', 'r/odometry', 'r/base')


def test_endings_go_to_the_answers_and_goals_without_a_name_get_one(answers):
    ledger = make(answers).ledger
    record = ledger.receive('', 0, 5 * S)
    assert (record.goal_id, answers.said) == ('made-at-5000000000', ['status'])
    ledger.receive('next', 0, 6 * S)
    assert answers.said[1:] == [('made-at-5000000000', GoalState.PREEMPTED, 6 * S), 'status', 'status']


@pytest.mark.parametrize('timeout, shown', [(5.0, 2), (0.5, 1)])
def test_what_has_ended_stays_on_the_list_as_long_as_the_setting_says(answers, timeout, shown):
    ledger = make(answers, status_list_timeout=timeout).ledger
    ledger.receive('a', 0, 5 * S)
    ledger.receive('b', 0, 6 * S)
    assert len(ledger.records(7 * S)) == shown


def test_the_plain_fleet_knows_a_robots_frames_by_the_names_of_its_settings():
    fleet = Fleet(make_scenario({'robots': [{'name': 'bot', 'max_speed': 1.0, 'tf_prefix': 'bot',
                                             'robot_base_frame': 'base'}]}))
    fleet.robot('bot').send(2.0, 0.0, frame='bot/base')
    fleet.run()
    assert (fleet.robot('bot').pose.x, fleet.trace[-1].values[1]) == (2.0, 'SUCCEEDED')
