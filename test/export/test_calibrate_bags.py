"""Legs from bags: goals, results, poses and plans of several robots, and messages about what a bag lacks."""
import random
import sys
from pathlib import Path

import pytest
import rosbag
import rospy

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / 'src'))

from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped  # noqa: E402
from move_base_msgs.msg import MoveBaseActionGoal, MoveBaseActionResult  # noqa: E402
from nav_msgs.msg import Odometry, Path as PathMessage  # noqa: E402

from move_base_abstract.common.errors import ConfigurationError  # noqa: E402
from move_base_abstract.fleet import Fleet  # noqa: E402
from move_base_abstract.motion.geometry import quaternion_of_yaw  # noqa: E402
from move_base_abstract.scenario import make_scenario  # noqa: E402
from move_base_abstract_calibration.bags import read_legs  # noqa: E402
from move_base_abstract_calibration.legs import way_along  # noqa: E402

GOALS = [(10.0, 0.0, 1.0), (10.0, 8.0, -2.0), (0.0, 3.0, 0.5)]


def put(pose, x, y, yaw):
    """Fill in a geometry_msgs/Pose (m, m, rad)."""
    pose.position.x, pose.position.y = x, y
    (pose.orientation.x, pose.orientation.y, pose.orientation.z, pose.orientation.w) = quaternion_of_yaw(yaw)


class Recorder:
    """Records a robot of the plain fleet into a bag."""

    def __init__(self, bag, frame, pose_kind, pose_topic):
        self._bag, self._frame, self._pose_kind, self._pose_topic = bag, frame, pose_kind, pose_topic
        self.fleet = Fleet(make_scenario({'robots': [
            {'name': 'bot', 'max_speed': 1.0, 'acceleration': 0.5, 'turn_rate': 1.0}]}))

    def tell(self, kind, topic, fill):
        message = kind()
        now_ns = self.fleet.now_ns
        message.header.stamp = rospy.Time(now_ns // 10 ** 9, now_ns % 10 ** 9)
        fill(message)
        self._bag.write('/bot/' + topic, message, message.header.stamp)

    def tell_pose(self):
        def fill(message):
            message.header.frame_id = self._frame
            pose = self.fleet.robot('bot').pose
            put(message.pose.pose, pose.x, pose.y, pose.yaw)
        self.tell(self._pose_kind, self._pose_topic, fill)

    def tell_plan(self, goal):
        def fill(message):
            start = self.fleet.robot('bot').pose
            places = [(start.x, start.y), (start.x, start.y + 5.0), goal[:2]]
            message.poses = [PoseStamped() for _ in places]
            for pose, place in zip(message.poses, places):
                put(pose.pose, *place, 0.0)
        self.tell(PathMessage, 'move_base/NavfnROS/plan', fill)

    def drive(self, goal, state, with_plan):
        """Send a goal and record the robot until it ends; return how long it takes [s]."""
        self.tell_pose()
        begin_ns = self.fleet.now_ns
        name = self.fleet.robot('bot').send(*goal)

        def fill_goal(message):
            message.goal_id.id = name
            message.goal.target_pose.header.frame_id = 'map'
            put(message.goal.target_pose.pose, *goal)

        def fill_result(message):
            message.status.goal_id.id, message.status.status = name, state
        self.tell(MoveBaseActionGoal, 'move_base/goal', fill_goal)
        if with_plan:
            self.tell_plan(goal)
        while self.fleet.trace[-1].kind != 'ended':
            self.fleet.run_for(0.1)
            self.tell_pose()
        self.tell(MoveBaseActionResult, 'move_base/result', fill_result)
        return (self.fleet.now_ns - begin_ns) / 1e9


def write(path, frame='map', pose_kind=Odometry, pose_topic='odom', with_plan=False):
    """Write a bag of three goals, the last of which fails; return their durations [s]."""
    with rosbag.Bag(str(path), 'w') as bag:
        recorder = Recorder(bag, frame, pose_kind, pose_topic)
        return [recorder.drive(goal, state, with_plan) for goal, state in zip(GOALS, (3, 3, 4))]


def test_each_goal_with_a_result_is_a_leg(tmp_path):
    durations = write(tmp_path / 'run.bag')
    legs, notes = read_legs(tmp_path / 'run.bag')
    assert notes == []
    assert [leg.duration for leg in legs] == pytest.approx(durations)
    assert [(leg.goal.x, leg.goal.y, round(leg.goal.yaw, 9)) for leg in legs] == GOALS
    assert [(leg.succeeded, leg.failed) for leg in legs] == [(True, False), (True, False), (False, True)]
    assert {leg.robot for leg in legs} == {'/bot'}
    for leg in legs:
        straight = way_along(leg.start, (), leg.goal)
        assert leg.way == pytest.approx(straight, abs=0.01)
        assert leg.end.distance_to(leg.goal) < 0.01


def test_a_plan_says_the_way(tmp_path):
    write(tmp_path / 'run.bag', with_plan=True)
    leg = read_legs(tmp_path / 'run.bag')[0][0]
    assert leg.way.length == pytest.approx(5.0 + 125.0 ** 0.5)
    assert leg.way.start_turn == pytest.approx(1.5707963, abs=1e-6)


def test_amcls_pose_comes_before_odometry_and_other_frames_are_told(tmp_path):
    write(tmp_path / 'run.bag', 'odom')
    assert read_legs(tmp_path / 'run.bag')[1] == [
        '{}: goals of /bot are in map, its poses (/bot/odom) in odom: taken for the same frame'.format(
            tmp_path / 'run.bag')]
    write(tmp_path / 'other.bag', pose_kind=PoseWithCovarianceStamped, pose_topic='amcl_pose')
    assert len(read_legs(tmp_path / 'other.bag')[0]) == len(GOALS)


def test_goals_and_poses_that_are_none_are_left_out(tmp_path):
    durations = write(tmp_path / 'run.bag')
    with rosbag.Bag(str(tmp_path / 'run.bag'), 'a') as bag:
        end = rospy.Time.from_sec(bag.get_end_time())
        for name, yaw in (('lying', 0.0), ('nowhere', float('nan'))):
            goal, result = MoveBaseActionGoal(), MoveBaseActionResult()
            goal.goal_id.id = result.status.goal_id.id = name
            put(goal.goal.target_pose.pose, yaw, 0.0, 0.0)
            goal.goal.target_pose.header.frame_id = 'map'
            if name == 'lying':
                goal.goal.target_pose.pose.orientation.w = 0.0
            goal.header.stamp, result.header.stamp = end, end + rospy.Duration(1)
            result.status.status = 4
            bag.write('/bot/move_base/goal', goal, goal.header.stamp)
            bag.write('/bot/move_base/result', result, result.header.stamp)
        odometry = Odometry()
        odometry.header.stamp, odometry.header.frame_id = rospy.Time(2), 'map'
        odometry.pose.pose.position.x = float('nan')
        bag.write('/bot/odom', odometry, end)
    legs, notes = read_legs(tmp_path / 'run.bag')
    assert [leg.duration for leg in legs] == pytest.approx(durations)
    assert notes == ['{}: 2 goals of /bot are not poses in the plane, and are left out'.format(tmp_path / 'run.bag')]


def test_poses_that_were_recorded_late_count_by_their_stamps(tmp_path):
    write(tmp_path / 'run.bag')
    legs, _ = read_legs(tmp_path / 'run.bag')
    with rosbag.Bag(str(tmp_path / 'run.bag')) as bag, rosbag.Bag(str(tmp_path / 'late.bag'), 'w') as late:
        end, odometry = bag.get_end_time(), 0
        for topic, message, time in bag.read_messages():
            odometry += topic == '/bot/odom'
            is_late = topic == '/bot/odom' and odometry % 2
            late.write(topic, message, rospy.Time.from_sec(end + 1.0) if is_late else time)
    assert [leg._replace(recording='') for leg in read_legs(tmp_path / 'late.bag')[0]] == [
        leg._replace(recording='') for leg in legs]


def test_a_damaged_bag_is_named(tmp_path):
    write(tmp_path / 'run.bag')
    whole = (tmp_path / 'run.bag').read_bytes()
    chance = random.Random(2)
    said = 0
    for number in range(60):
        damaged = bytearray(whole[:chance.randrange(len(whole))] if number % 4 == 0 else whole)
        for _ in range(30):
            damaged[chance.randrange(len(damaged))] = chance.randrange(256)
        (tmp_path / 'run.bag').write_bytes(damaged)
        try:
            read_legs(tmp_path / 'run.bag')
        except ConfigurationError as error:
            said += 'run.bag' in str(error)
    assert said > 20


def test_what_a_bag_lacks_is_said(tmp_path):
    with pytest.raises(ConfigurationError, match='none.bag: cannot be read'):
        read_legs(tmp_path / 'none.bag')
    (tmp_path / 'text.bag').write_text('no bag')
    with pytest.raises(ConfigurationError, match='cannot be read as a bag'):
        read_legs(tmp_path / 'text.bag')
    write(tmp_path / 'run.bag')
    with pytest.raises(ConfigurationError, match='no poses of /bot; allowed: one of /bot/pose'):
        read_legs(tmp_path / 'run.bag', 'pose')
    with rosbag.Bag(str(tmp_path / 'empty.bag'), 'w') as bag:
        bag.write('/odom', Odometry(), rospy.Time(1))
    with pytest.raises(ConfigurationError, match='no goals'):
        read_legs(tmp_path / 'empty.bag')


# ---- bad recordings, written on purpose

def edited(path, change):
    """Write the bag anew; ``change(topic, message, time [s])`` returns the rows that replace a row."""
    with rosbag.Bag(str(path)) as bag:
        rows = [(topic, message, time.to_sec()) for topic, message, time in bag.read_messages()]
    with rosbag.Bag(str(path), 'w') as bag:
        for row in rows:
            for topic, message, time in change(*row):
                bag.write(topic, message, rospy.Time.from_sec(time))


def shifted(message, seconds):
    """Return ``message``, whose stamp is now later by ``seconds``."""
    message.header.stamp += rospy.Duration.from_sec(seconds)
    return message


def doubts(path):
    """Return the doubt of each leg of a bag."""
    return [leg.doubt for leg in read_legs(path)[0]]


def test_a_clock_that_leaps_within_a_leg_is_seen(tmp_path):
    first, second, _ = write(tmp_path / 'run.bag')
    leap = 1.0 + first + 0.5 * second

    def by_stamps(topic, message, time):
        return [(topic, shifted(message, 900.0) if time > leap else message, time)]

    def by_both(topic, message, time):
        later = 900.0 if time > leap else 0.0
        return [(topic, shifted(message, later), time + later)]
    for change in (by_stamps, by_both):
        write(tmp_path / 'run.bag')
        edited(tmp_path / 'run.bag', change)
        assert doubts(tmp_path / 'run.bag') == ['', 'clock_leap', '']


@pytest.mark.parametrize('recorder_too', [False, True])
def test_a_clock_that_starts_anew_spoils_what_lies_in_its_times(tmp_path, recorder_too):
    write(tmp_path / 'run.bag')
    with rosbag.Bag(str(tmp_path / 'run.bag')) as bag:
        rows = list(bag.read_messages())
        end = bag.get_end_time()
    with rosbag.Bag(str(tmp_path / 'run.bag'), 'w') as bag:
        for topic, message, time in rows:
            bag.write(topic, message, time)
        for topic, message, time in rows:  # the same messages again, by a clock that begins again
            if topic.endswith('goal'):
                message.goal_id.id += '-again'
            elif topic.endswith('result'):
                message.status.goal_id.id += '-again'
            bag.write(topic, message, time if recorder_too else time + rospy.Duration.from_sec(end))
    assert set(doubts(tmp_path / 'run.bag')) == {'clock_back'}


@pytest.mark.parametrize('order', [
    lambda rows: rows[::-1], lambda rows: rows[len(rows) // 2:] + rows[:len(rows) // 2],
    lambda rows: sorted(rows, key=lambda row: row[0], reverse=True)], ids=['backwards', 'halves', 'by topic'])
def test_a_bag_whose_messages_are_out_of_order_is_read_by_time(tmp_path, order):
    write(tmp_path / 'run.bag')
    expected = read_legs(tmp_path / 'run.bag')
    with rosbag.Bag(str(tmp_path / 'run.bag')) as bag:
        rows = list(bag.read_messages())
    with rosbag.Bag(str(tmp_path / 'run.bag'), 'w', chunk_threshold=4000) as bag:
        for topic, message, time in order(rows):
            bag.write(topic, message, time)
    assert read_legs(tmp_path / 'run.bag') == expected


def test_poses_of_another_robot_in_the_namespace_leave_none_of_its_legs(tmp_path):
    def add(topic, message, time):
        if topic != '/bot/odom':
            return [(topic, message, time)]
        other = Odometry(header=message.header)
        put(other.pose.pose, message.pose.pose.position.x + 20.0, 7.0, 0.0)
        return [(topic, message, time), (topic, other, time)]
    write(tmp_path / 'run.bag')
    edited(tmp_path / 'run.bag', add)
    legs, notes = read_legs(tmp_path / 'run.bag')
    assert legs == []
    assert len(notes) == 1 and 'two robots in the namespace /bot (the poses go elsewhere and back' in notes[0]
    assert notes[0].endswith('its 3 legs are left out')


def test_two_nodes_that_tell_poses_at_once_are_two_robots(tmp_path):
    write(tmp_path / 'run.bag')
    with rosbag.Bag(str(tmp_path / 'run.bag')) as bag:
        rows = list(bag.read_messages())
    for names, found in (((b'/amcl', b'/twin'), 0), ((b'/amcl', b'/amcl'), 3)):
        with rosbag.Bag(str(tmp_path / 'run.bag'), 'w') as bag:
            for number, (topic, message, time) in enumerate(rows):
                header = {'topic': topic, 'type': message._type, 'md5sum': message._md5sum,
                          'message_definition': message._full_text, 'callerid': names[number % 2]}
                bag._topic_connections.pop(topic, None)  # otherwise Python's rosbag would use the first header again
                bag.write(topic, message, time, connection_header=header)
        legs, notes = read_legs(tmp_path / 'run.bag')
        assert len(legs) == found
        assert [note for note in notes if 'nodes tell poses at once: /amcl, /twin' in note] == notes[:not found]


def test_poses_that_jump_and_poses_that_are_too_rare_are_seen(tmp_path):
    first, second, _ = write(tmp_path / 'run.bag')
    amid = 1.0 + first + 0.5 * second

    def jump(topic, message, time):
        if topic == '/bot/odom' and amid < time < amid + 0.15:
            message.pose.pose.position.x += 5.0
        return [(topic, message, time)]

    def rare(topic, message, time):
        return [] if topic == '/bot/odom' and amid < time < amid + 3.0 else [(topic, message, time)]
    for change, doubt in ((jump, 'teleport'), (rare, 'rare')):
        write(tmp_path / 'run.bag')
        edited(tmp_path / 'run.bag', change)
        assert doubts(tmp_path / 'run.bag') == ['', doubt, '']


def test_a_robot_that_stands_long_has_no_leap(tmp_path):
    write(tmp_path / 'run.bag')
    with rosbag.Bag(str(tmp_path / 'run.bag')) as bag:
        rows = list(bag.read_messages(topics=['/bot/odom']))
    still = next(time.to_sec() for (_, one, time), (_, other, _) in zip(rows, rows[1:])
                 if one.pose.pose.position == other.pose.pose.position and time.to_sec() > 3.0)

    def stands(topic, message, time):
        wait = 60.0 if time > still else 0.0  # s, without odometry
        return [(topic, shifted(message, wait), time + wait)]
    edited(tmp_path / 'run.bag', stands)
    assert doubts(tmp_path / 'run.bag') == ['', '', '']


def test_goals_without_results_and_results_without_goals_are_counted(tmp_path):
    def drop(topic, message, time):
        is_gone = (topic.endswith('goal') and message.goal_id.id == 'bot-1') or (
            topic.endswith('result') and message.status.goal_id.id == 'bot-3')
        return [] if is_gone else [(topic, message, time)]
    write(tmp_path / 'run.bag')
    edited(tmp_path / 'run.bag', drop)
    legs, notes = read_legs(tmp_path / 'run.bag')
    assert len(legs) == 1
    name = str(tmp_path / 'run.bag')
    assert notes == [
        name + ': 1 goals of /bot have no result, and are left out: of a robot that hung there, success is said too '
        'high',
        name + ': 1 results of /bot have no goal, and are left out']


def test_goals_before_the_first_pose_are_counted(tmp_path):
    first, *_ = write(tmp_path / 'run.bag')
    edited(tmp_path / 'run.bag', lambda topic, message, time: [] if topic == '/bot/odom' and time < 1.0 + 0.5 * first
           else [(topic, message, time)])
    legs, notes = read_legs(tmp_path / 'run.bag')
    assert len(legs) == 2
    assert notes == ['{}: 1 goals of /bot were sent before the first pose, and are left out'.format(
        tmp_path / 'run.bag')]
