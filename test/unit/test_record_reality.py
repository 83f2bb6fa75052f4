"""What tools/record_reality makes of plans, seeds and busy programs; without ROS, Stage or a recording."""
import csv
import gzip
import math
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

TOOL = Path(__file__).resolve().parents[2] / 'tools' / 'record_reality'


@pytest.fixture(scope='module', autouse=True)
def tool():
    """Make the modules of the tool importable by their own names, and forget them again."""
    before = set(sys.modules)
    sys.path.insert(0, str(TOOL))
    yield
    sys.path.remove(str(TOOL))
    for name in set(sys.modules) - before:
        if str(TOOL) in str(getattr(sys.modules[name], '__file__', '')):
            del sys.modules[name]


def drive(kind, place, robots, seed, seconds=200):
    """Return the goals of a mission whose goals are all reached after 10 s, as (s, robot, class, goal, pose before)."""
    from missions import mission, starts
    goals = mission(kind, place, robots, seed)
    poses = [(x, y, math.radians(yaw)) for x, y, yaw in starts(place, robots, seed)]
    under_way, found = {}, []
    for step in range(seconds * 10):
        now = step / 10.0
        for robot in [robot for robot, (end, _) in under_way.items() if end <= now]:
            poses[robot] = under_way.pop(robot)[1]
        idle = [robot for robot in range(robots) if robot not in under_way]
        for robot, name, goal in goals.goals(idle, poses, now):
            assert robot in idle
            found.append((now, robot, name, goal, poses[robot]))
            under_way[robot] = (now + 10.0, goal)
    return found


def test_a_plan_around_a_corner_is_described():
    from legs import describe
    plan = [(0.05 * n, 0.0) for n in range(101)] + [(5.0, 0.05 * n) for n in range(1, 61)]
    values = describe(plan, math.radians(170.0), math.radians(-90.0), lambda x, y: 1.0 + y - 0.1 * x)
    assert values['plan_m'] == pytest.approx(8.0)
    assert values['plan_turn_rad'] == pytest.approx(math.pi / 2.0)
    assert values['plan_corners'] == 1
    assert values['plan_clearance_m'] == pytest.approx(0.5)
    assert values['start_turn_rad'] == pytest.approx(math.radians(170.0))
    assert values['end_turn_rad'] == pytest.approx(math.pi)


def test_a_leg_says_what_the_odometry_says():
    from legs import COLUMNS, Leg
    leg = Leg(3, 'headon', (0.0, 0.0, 0.0), (-0.3, 0.0, 0.0), 1.0)
    for step in range(1, 21):  # 1 s backwards at 0.2 m/s, then 1 s on the spot
        leg.moved((-0.02 * min(step, 10), 0.0, 0.1 * max(0, step - 10)), *(
            (-0.2, 0.0) if step <= 10 else (0.0, 1.0)), 1.0 + step / 10.0)
    leg.near(1.2, 1, 2.0)
    leg.near(1.4, 2, 2.5)
    row = leg.row('run', 0, (4, 'text', 3.0), lambda x, y: 1.0, False)
    assert tuple(row) == COLUMNS
    wanted = {'driven_m': '0.200', 'turned_rad': '1.000', 'reverse_s': '1.0', 'spin_s': '1.0', 'duration_s': '2.0',
              'in_xy_tolerance_s': '2.0', 'min_robot_dist_m': '1.200', 'nearest_robot': '1', 'state_name': 'ABORTED',
              'plan_m': ''}
    assert {name: row[name] for name in wanted} == wanted


@pytest.mark.parametrize('kind, robots', [('random', 3), ('turns', 2), ('headon', 3), ('stander', 3), ('gather', 4),
                                          ('crossing', 3)])
def test_goals_follow_from_the_seed(kind, robots):
    from places import place
    where = place('aisles_2')
    first = drive(kind, where, robots, 5)
    assert first == drive(kind, where, robots, 5)
    assert first != drive(kind, where, robots, 6)
    assert len(first) >= 10 * robots
    assert all(where.clearance(*goal[:2]) >= 0.3 for _, _, _, goal, _ in first)


def test_goals_of_turns_lie_behind():
    from places import place
    turns = []
    for _, _, _, goal, pose in drive('turns', place('rooms_1'), 2, 1):
        way = math.atan2(goal[1] - pose[1], goal[0] - pose[0]) - pose[2]
        turns.append(abs(math.atan2(math.sin(way), math.cos(way))))
    # Behind a robot with its back to a wall there is nothing.
    assert sum(turn > math.radians(120.0) for turn in turns) >= 0.8 * len(turns)


def test_robots_head_on_change_places():
    from places import place
    goals = [row for row in drive('headon', place('aisles_1'), 2, 1) if row[2] == 'headon']
    for (_, one, _, goal, pose), (_, other, _, back, from_there) in zip(goals[::2], goals[1::2]):
        assert one != other
        # each keeps its own distance to the lane's middle line
        assert max(math.dist(goal[:2], from_there[:2]), math.dist(back[:2], pose[:2])) <= 1.2
        assert math.dist(goal[:2], pose[:2]) > 5.0


def test_the_maps_have_the_passages_that_the_readme_names():
    from places import place
    for name, narrowest, widest in (('aisles_1', 1.5, 3.0), ('rooms_1', 0.4, 2.0)):
        where = place(name)
        widths = [lane.width for lane in where.lanes]
        assert (min(widths), max(widths)) == (narrowest, widest)
        for lane in where.lanes:  # the clearance in the middle of the lane is half of its width, to a cell
            middle = [(a + b) / 2.0 for a, b in zip(lane.start, lane.end)]
            assert where.clearance(*middle) == pytest.approx(lane.width / 2.0, abs=0.11)


def test_a_step_is_over_when_all_sleep_or_have_had_a_step_of_a_core():
    from pace import Pace
    sleeper, busy = (subprocess.Popen([sys.executable, '-c', code], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
                     for code in ('print(flush=True); input()', 'print(flush=True)\nwhile True: pass'))
    try:
        for process in (sleeper, busy):
            process.stdout.readline()
        asleep, both = Pace([sleeper.pid]), Pace([sleeper.pid, busy.pid])
        assert asleep.wait() and both.wait(limit=0.0) is False
        used = [_seconds(busy.pid)]
        for _ in range(2):
            assert both.wait()
            used.append(_seconds(busy.pid))
        assert used[1] - used[0] >= 0.08 and used[2] - used[1] >= 0.01  # known to 0.01 s
        both.close()
        asleep.close()
    finally:
        for process in (sleeper, busy):
            process.kill()
            process.communicate()


def _seconds(pid):
    """Return the time that a process has had of a core."""
    fields = Path('/proc/{}/stat'.format(pid)).read_text().rsplit(') ', 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / 100.0


def test_all_missions_of_the_ranking_come_once_before_any_comes_again():
    import record_ranking
    rows = list(record_ranking.plan())
    keys = [(row['map'], row['robots'], row['policy']) for row in rows]
    assert len(set(keys[:20])) == 20 and all(keys[at] == keys[at % 20] for at in range(len(keys)))
    assert [row['repetition'] for row in rows[::20]] == list(range(1, len(rows) // 20 + 1))
    assert len({row['run'] for row in rows}) == len(rows)


def test_the_packed_missions_of_the_ranking_are_whole():
    from collections import Counter
    folder = TOOL.parents[1] / 'examples' / 'reality' / 'ranking'
    with open(folder / 'missions.csv', newline='') as stream:
        missions = list(csv.DictReader(stream))
    with gzip.open(folder / 'legs.csv.gz', 'rt', newline='') as stream:
        legs = Counter(leg['run'] for leg in csv.DictReader(stream))
    assert set(legs) == {mission['run'] for mission in missions}
    cells = Counter((mission['map'], mission['robots'], mission['policy']) for mission in missions)
    assert len(cells) == 20 and min(cells.values()) >= 4
    for mission in missions:
        assert int(mission['missed_loops']) == 0
        assert (float(mission['mission_s']) == 900.0) == (mission['ended'] == '0')
        assert mission['ended'] == '0' or int(mission['done']) + int(mission['failed']) == 12


class Topics:
    """Takes the place of rospy: publishers keep their messages, and ``heard`` calls the subscriber of a topic."""

    def __init__(self, monkeypatch):
        import robots
        self._hears, self.sent = {}, []
        monkeypatch.setattr(robots.rospy, 'Publisher', lambda topic, _kind, queue_size: SimpleNamespace(
            publish=lambda message: self.sent.append((topic, message))))
        monkeypatch.setattr(robots.rospy, 'Subscriber',
                            lambda topic, _kind, hear, queue_size: self._hears.update({topic: hear}))

    def heard(self, topic, message):
        """Hand a message to the robot 0."""
        self._hears['/robot_0/' + topic](message)


def goal_of(goal_id, x):
    """Return a goal [m] of a coordinator."""
    from robots import MoveBaseActionGoal
    message = MoveBaseActionGoal()
    message.goal_id.id = goal_id
    message.goal.target_pose.pose.position.x, message.goal.target_pose.pose.orientation.w = x, 1.0
    return message


def plan_to(x):
    """Return a plan of navfn along x, from 0 to ``x`` [m]."""
    from robots import Path as Plan
    plan = Plan()
    for n in range(int(10 * x) + 1):
        plan.poses.append(goal_of('', 0.1 * n).goal.target_pose)
    return plan


def result_of(goal_id, state):
    """Return the result of a goal."""
    from robots import MoveBaseActionResult
    message = MoveBaseActionResult()
    message.status.goal_id.id, message.status.status = goal_id, state
    return message


@pytest.fixture
def watched(monkeypatch):
    """Return (the topics, a robot at the origin whose goals come from another program)."""
    topics = Topics(monkeypatch)
    from robots import Odometry, WatchedRobot
    robot = WatchedRobot(0, SimpleNamespace(clearance=lambda _x, _y: 1.0), 'run')
    standing = Odometry()
    standing.pose.pose.orientation.w = 1.0
    topics.heard('odom', standing)
    robot.take(0.0)
    return topics, robot


@pytest.mark.parametrize('first', ['the goal', 'the plan'])
def test_a_goal_of_another_program_and_its_plan_are_one_leg_whichever_is_heard_first(watched, first):
    topics, robot = watched
    messages = [('move_base/goal', goal_of('a', 3.0)), ('move_base/NavfnROS/plan', plan_to(3.0))]
    for topic, message in messages if first == 'the goal' else messages[::-1]:
        topics.heard(topic, message)
    robot.take(1.0)
    assert (robot.leg.goal[0], robot.leg.sent, robot.leg.first_plan) == (3.0, 1.0, 1.0)
    topics.heard('move_base/result', result_of('another', 3))
    robot.take(2.0)
    assert robot.leg is not None
    topics.heard('move_base/result', result_of('a', 3))
    robot.take(5.0)
    assert robot.leg is None
    assert len(robot.rows) == 1
    assert topics.sent == []  # it only listens


def test_a_goal_that_is_sent_while_one_is_under_way_begins_its_leg_when_that_has_ended(watched):
    topics, robot = watched
    topics.heard('move_base/goal', goal_of('a', 3.0))
    robot.take(1.0)
    topics.heard('move_base/goal', goal_of('b', 2.0))
    topics.heard('move_base/NavfnROS/plan', plan_to(2.0))  # of the second: not one of the leg under way
    robot.take(2.0)
    assert (robot.leg.goal[0], robot.leg.plans) == (3.0, 0)
    topics.heard('move_base/result', result_of('a', 2))
    robot.take(3.0)
    assert (robot.leg.goal[0], robot.leg.sent, robot.leg.first_plan, robot.leg.number) == (2.0, 3.0, 3.0, 2)
    assert len(robot.rows) == 1
