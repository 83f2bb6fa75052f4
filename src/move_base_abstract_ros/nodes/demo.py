"""The demo: a mission of several robots, faster than real time, on a ROS master of its own.

    demo [--clock lockstep|scaled] [--factor F] [--csv FILE | --mission FILE | --world warehouse] [--map FILE]
         [--robots N] [--goals K] [--orders N] [--policy NAME] [--seed S] [--speed V] [--routes] [--rviz]
         [--event-log FILE] [--replay FILE]

Exit codes: 0 the mission is done; 1 it failed (the reason is printed); 2 wrong arguments; 130 interrupted by Ctrl-C;
143 ended by SIGTERM.
"""

import argparse
import contextlib
import sys
import time

import rospy

from move_base_abstract import mission
from move_base_abstract.common.errors import telling
from move_base_abstract.common.kinds import integer, number
from move_base_abstract.common.options import POSITIVE, word_of
from move_base_abstract.orders.policies import POLICIES
from move_base_abstract_experiments.trials.metrics import summarise
from move_base_abstract_ros import lockstep
from move_base_abstract_ros.loopback import Loopback, LoopbackError
from move_base_abstract_ros.nodes.demo_run import nodes, report, warehouse
from move_base_abstract_ros.nodes.demo_run.mission import MissionFailed, MissionRun
from move_base_abstract_ros.nodes.demo_run.run_log import RunLog
from move_base_abstract_ros.replacing import rospy_start

LAST_LOOK_SECONDS = 1.0  # wall
_FACTOR = word_of(number(0.01, 1e6))  # the limits of the time master
_COUNT = word_of(number(1, 10000, whole=True))  # of robots, of goals of each robot, and of orders


def main():
    """Run the demo and exit with its code."""
    arguments = _parse(rospy.myargv()[1:])
    try:
        with telling('demo', MissionFailed, LoopbackError, code=1):
            sys.exit(_run(arguments))
    except KeyboardInterrupt:
        print('\ndemo: interrupted', file=sys.stderr)
        sys.exit(130)


def _run(arguments):
    """Start all nodes, carry the mission out, report, and make the replay page; return the exit code."""
    with RunLog(arguments.replay, arguments.event_log) as log:
        if arguments.world:
            _run_warehouse(arguments, log)
        else:
            _run_mission(arguments, _choose_mission(arguments), log)
    return 0


def _run_mission(arguments, plan, log):
    begin = time.monotonic()
    map_path, why = nodes.choose_map(arguments.map, 'field.yaml' if arguments.csv else 'farm_yard.yaml', plan)
    print(why, flush=True)
    if arguments.routes and map_path is None:
        raise MissionFailed('--routes needs a map on which all places of the mission are free')
    clock = nodes.clock_parameters(arguments.clock, arguments.factor, ['/fleet', '/demo'], log.path, log.note)
    settings = nodes.robot_settings(arguments.speed, map_path is not None, arguments.routes, arguments.rviz)
    with _master(arguments, log, lambda ros: nodes.start(ros, plan, clock, settings, map_path, arguments.rviz),
                 ['/fleet/events']) as (ros, participant):
        run = MissionRun(plan, participant)
        run.wait_until_ready(ros.check)
        print(f'{len(plan.robots)} robots at {arguments.speed:g} m/s, {plan.goal_count} goals, {_speed(clock)}; '
              f'started in {time.monotonic() - begin:.1f} s; ROS master {ros.uri}', flush=True)
        _carry_out(run, ros, report.make_progress(plan.goal_count, 'goals', sys.stderr))
        log.await_rows('ended', plan.goal_count)
    log.close()
    simulated_s, wall_s = run.elapsed()
    told = summarise(log.path, {robot.name: (robot.start.x, robot.start.y) for robot in plan.robots}).robots
    print(report.table([(robot.plan.name, robot.goals_done, len(robot.plan.goals), told[robot.plan.name]['distance_m'],
                         told[robot.plan.name]['moving_s']) for robot in run.robots], simulated_s))
    print(log.make_page(map_path))
    print(report.closing_line(simulated_s, wall_s, log.messages()), flush=True)


def _run_warehouse(arguments, log):
    begin = time.monotonic()
    scenario, map_path = warehouse.make(log.folder, arguments.robots, arguments.orders or warehouse.ORDERS,
                                        1 if arguments.seed is None else arguments.seed, arguments.speed,
                                        arguments.rviz)
    clock = nodes.clock_parameters(arguments.clock, arguments.factor, [*warehouse.PARTICIPANTS, '/demo'], log.path,
                                   log.note)
    with _master(arguments, log, lambda ros: warehouse.start(ros, scenario, clock, map_path, arguments.policy,
                                                             arguments.rviz),
                 ['/fleet/events', '/dispatcher/events']) as (ros, participant):
        run = warehouse.OrdersRun(scenario, participant)
        print(f'warehouse: {run.robots} robots, {run.count} orders, {_speed(clock)}; started in '
              f'{time.monotonic() - begin:.1f} s; ROS master {ros.uri}', flush=True)
        _carry_out(run, ros, report.make_progress(run.count, 'orders', sys.stderr))
    log.close()
    print(report.aligned(*warehouse.table_of(*log.rows())))
    print(log.make_page(map_path, scenario))
    print(report.closing_line(*run.elapsed(), log.messages()), flush=True)


@contextlib.contextmanager
def _master(arguments, log, start, topics):
    """Start a ROS master, and on it all nodes, by ``start(ros)``. The context gives (Loopback, participant or None).

    In lockstep this process takes part. On the scaled clock ``log`` (RunLog) listens to ``topics``.
    """
    with Loopback() as ros:
        ros.adopt()
        start(ros)
        rospy_start.prepare()
        rospy.init_node('demo', disable_signals=True)
        try:
            if arguments.clock == 'scaled':
                log.listen(*topics)
            yield ros, lockstep.join() if arguments.clock == 'lockstep' else None
        except rospy.ROSInterruptException:
            _name_who_died(ros)
            raise MissionFailed('the run ended before the mission did') from None
        except Exception:
            print(f"demo: the nodes' logs are kept in {ros.log_dir}", file=sys.stderr)
            raise
        finally:
            rospy.signal_shutdown('demo over')


def _name_who_died(ros):
    """Raise ChildEnded if a node has died. It looks for a while: a lost connection is noticed before the death."""
    deadline = time.monotonic() + LAST_LOOK_SECONDS
    while time.monotonic() < deadline:
        ros.check()
        time.sleep(0.02)


def _speed(clock):
    """Return the speed that the clock's parameters ask for, in words."""
    if clock['mode'] == 'scaled':
        return f"factor {clock['factor']:g}"
    return f"lockstep, at most {clock['speed_limit']:g}x" if clock['speed_limit'] else 'lockstep'


def _carry_out(run, ros, progress):
    """Carry ``run`` out to its end, show its ``progress``, and raise ChildEnded if a node dies."""
    def tick():
        ros.check()
        progress.show(run.done, *run.elapsed())

    try:
        run.run(tick)
        progress.show(run.done, *run.elapsed())
    finally:
        progress.close()


def _choose_mission(arguments):
    """Return the mission that the arguments ask for."""
    if arguments.csv:
        points = mission.read_field_points(arguments.csv)
        print(f'field: {len(points)} points of {arguments.csv}, {max(point.x for point in points):.1f} m x '
              f'{max(point.y for point in points):.1f} m')
        return mission.mission_from_points(points, arguments.robots or 5, arguments.goals or 6,
                                           1 if arguments.seed is None else arguments.seed)
    name = 'demo_routes_mission.yaml' if arguments.routes else 'demo_mission.yaml'
    path = arguments.mission or nodes.shipped('config', name)
    return mission.read_mission(path).first_robots(arguments.robots)


def _parse(words):
    parser = argparse.ArgumentParser(prog='demo', description='Run a mission of several robots faster than real time '
                                     'on a ROS master of its own (127.0.0.1, free port).')
    parser.add_argument('--clock', choices=('lockstep', 'scaled'), default='lockstep',
                        help='leap from event to event, or run at a factor (default: %(default)s)')
    parser.add_argument('--factor', type=_FACTOR, metavar='F',
                        help='simulated seconds per wall second, 0.01..1e6; in lockstep an upper limit '
                        '(default: no limit; scaled: 20; with --rviz 20)')
    source = parser.add_mutually_exclusive_group()
    source.add_argument('--csv', metavar='FILE', help='visit points of this field: columns lat, lon [deg] and a value')
    source.add_argument('--mission', metavar='FILE', help='mission file (default: the one that ships with the package)')
    source.add_argument('--world', choices=(warehouse.KIND,), help='drive in a warehouse that is made by sizes, with '
                        'orders that arrive and a dispatcher')
    parser.add_argument('--orders', type=_COUNT, metavar='N', help='number of orders within an hour; only with --world '
                        f'(default: {warehouse.ORDERS})')
    parser.add_argument('--policy', choices=POLICIES, help="the dispatcher's policy; only with --world")
    parser.add_argument('--robots', type=_COUNT, metavar='N',
                        help='number of robots (default: 5, or all of the mission; with --world 50)')
    parser.add_argument('--goals', type=_COUNT, metavar='K', help='goals of each robot, only with --csv (default: 6)')
    parser.add_argument('--seed', type=word_of(integer(0)), metavar='S',
                        help='seed of the choice of points or of the orders, only with --csv or --world (default: 1)')
    parser.add_argument('--map', metavar='FILE', help='YAML file of the map (default: one that ships with the package)')
    parser.add_argument('--routes', action='store_true', help='drive around obstacles of the map, not straight')
    parser.add_argument('--rviz', action='store_true', help='show the run in RViz, which must be installed')
    parser.add_argument('--event-log', metavar='FILE', help='write the events of the run to this file, for `replay`; '
                        'only in lockstep')
    parser.add_argument('--speed', type=POSITIVE, default=2.0, metavar='V', help='m/s (default: %(default)g)')
    parser.add_argument('--replay', metavar='FILE', help='the page that is made at the end (default: '
                        'demo_replay.html in the folder move_base_abstract of ROS_HOME)')
    arguments = parser.parse_args(words)
    if arguments.event_log and arguments.clock != 'lockstep':
        parser.error('--event-log needs --clock lockstep: the scaled clock has no event log')
    if arguments.rviz and arguments.factor is None:
        arguments.factor = 20.0
    for name, needs in (('goals', ('csv',)), ('seed', ('csv', 'world'))):
        if getattr(arguments, name) is not None and not any(getattr(arguments, one) for one in needs):
            parser.error(f'--{name} needs --{" or --".join(needs)}: a mission file says itself which goals there are')
    _check_world(parser, arguments)
    return arguments


def _check_world(parser, arguments):
    if arguments.world and (arguments.map or arguments.routes):
        parser.error(f'--{"map" if arguments.map else "routes"} does not go with --world: its robots drive on lanes')
    for name in ('orders', 'policy'):
        if getattr(arguments, name) is not None and not arguments.world:
            parser.error(f'--{name} needs --world')
