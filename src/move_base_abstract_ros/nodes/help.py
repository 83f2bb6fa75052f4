"""List the programs of this package by task: rosrun move_base_abstract help [PROGRAM].

The tables of this module are the only list of programs. docs/what_there_is.md has them from here
(tools/write_node_pages.py), and CMake makes the programs of them.
"""
import argparse
import os
import sys

from move_base_abstract.common.kinds import similar

#: {task: {program: (what it does, page, the module that start() of this room runs; '': it is no script)}}
PROGRAMS = {
    'Robots': {
        'move_base': ('simulates one robot, with the interface of `move_base`', 'move_base.md', 'move_base_node'),
        'move_base_abstract_actionserver': ("simulates the same robot, with the original package's seven arguments",
                                            'move_base_abstract_actionserver.md', 'actionserver_node'),
        'velocity_robot': ('simulates one robot that is driven by velocities, in the place of Stage or of a driver',
                           'velocity_robots.md', 'velocity_robot_node'),
        'fleet': ('simulates many such robots in one process, from a scenario file', 'fleet.md', 'fleet_node'),
        'map_server': ("serves a map from a file, if the navigation stack's `map_server` is not installed",
                       'map_server.md', 'map_server_node'),
        'task_server': ('offers tasks that take a while as actions of each robot, with feedback and cancel',
                        'tasks.md', 'task_server_node'),
        'task_source': ('publishes tasks and orders as they arrive, at random instants or from a file',
                        'tasks.md', 'task_source_node'),
        'dispatcher': ('gives orders to robots, and sends robots to chargers',
                       'orders.md', 'orders_run.dispatcher_node'),
        'demo': ('runs a mission of several robots on a ROS master of its own', 'demo.md', 'demo')},
    'Your system in lockstep': {
        'lockstep_launch': ('runs an unchanged launch file in lockstep, also as a `<test>` of rostest, and scripts '
                            'that start launch files',
                            'lockstep_launch.md', 'lockstep_launch'),
        'debug': ('runs a launch file in lockstep, with a prompt: stop anywhere, look, go on, go back', 'debug.md',
                  'debug'),
        'lockstep': ('starts an unmodified program as a participant', 'lockstep_launcher.md', 'lockstep_launcher'),
        'time_master': ('publishes `/clock`: lockstep, or a factor; pause, step, run until, holds',
                        'time_master.md', ''),
        'why': ('says why time moves or stands still', 'time_master.md', 'why_node')},
    'Is it right?': {
        'verify': ('runs a launch file under conditions that must not matter, and compares the runs',
                   'verify.md', 'verify'),
        'compare': ('finds the first difference of two event logs', 'time_master.md', 'compare'),
        'chaos': ('runs a launch file with other legal orders of equal events, late messages and late starts until '
                  'something breaks, and finds the fewest decisions that break it', 'chaos.md', 'chaos')},
    'What comes out?': {
        'replay': ('shows a run, or two side by side, from event logs, as a page for any browser', 'replay.md',
                   'move_base_abstract_replay.command'),
        'fleet_report': ('reports what a fleet did in one run: utilisation, orders, waiting, charging',
                         'orders.md#a-report-of-a-fleet', 'move_base_abstract_experiments.fleet_report'),
        'experiment': ('runs any launch file many times, on all cores: factors, seeds, metrics, one table, a report',
                       'experiments.md', 'move_base_abstract_experiments.__main__')},
    'Scenarios, plans and real robots': {
        'scenario': ('reports problems of a scenario before it runs, with a picture; makes a warehouse, a field or a '
                     'ward from sizes', 'scenario_check.md', 'move_base_abstract_worlds.command'),
        'mapf': ('reads MovingAI maps and problems, and drives plans of MAPF solvers with delays and failures',
                 'mapf.md', 'move_base_abstract_mapf.command'),
        'calibrate': ("finds in recordings how long a real robot's legs take, for the simulator",
                      'calibrate.md', 'move_base_abstract_calibration.command')},
    'Help': {
        'help': ('lists these programs; `help PROGRAM` says more of one', 'what_there_is.md', 'help')}}

_PACKAGE = 'move_base_abstract'
_OWN = ('lockstep', '--own')
_NODES = 'move_base_abstract_ros.nodes.'
#: names that work for one release: {name: (program that it becomes, its first words ..., what to write instead)}
OLD_NAMES = {
    'end_at_message': (*_OWN, _NODES + 'end_at_message_node', "`until: {topic: TOPIC}` in an experiment's file"),
    'lockstep_series': ('lockstep_launch', '--script', '`lockstep_launch --script`'),
    'mapf_drive': (*_OWN, _NODES + 'orders_run.mapf_drive_node', 'include `mapf.launch`'),
    'message_recorder': (*_OWN, _NODES + 'message_recorder_node',
                         "`record: {messages: [TOPIC]}` in an experiment's file"),
    'property_monitor': (*_OWN, _NODES + 'property_monitor_node', 'include `properties.launch`'),
    'radio_markers': (*_OWN, _NODES + 'radio_markers_node', '`rviz.launch radio:=true`'),
    'run_checked': ('lockstep_launch', '--check', '`type="lockstep_launch" args="--check FILE"` in the tag'),
    'soil_coordinator': (*_OWN, 'soil_mapping.ros.soil_coordinator', 'include `soil_mapping.launch`'),
    'study': ('examples/study.py', '`python3 $(rospack find move_base_abstract)/examples/study.py`')}


def scripts():
    """Return {path of a program below the folder of programs, or 'old/' and an old name: its module}."""
    modules = {name: module for rows in PROGRAMS.values() for name, (_, _, module) in rows.items() if module}
    old = {**dict.fromkeys(OLD_NAMES, 'help'), 'sim_time_controller': 'sim_time_controller'}
    return {**modules, **{'old/' + name: module for name, module in old.items()}}


def main():
    """Print the table, or what is known of one program. By an old name, say the new one and become that program."""
    name = os.path.basename(sys.argv[0])
    if name in OLD_NAMES:
        _become(name)
    parser = argparse.ArgumentParser(prog='help', description='List the programs of this package by task.')
    parser.add_argument('program', nargs='?', metavar='PROGRAM', help='say more of this program')
    asked = parser.parse_args().program
    print('\n'.join(_lines() if asked is None else _about(asked)))


def _become(name):
    import rospkg

    from ..loopback import LoopbackError, find_executable
    program, *words, _instead = OLD_NAMES[name]
    print('{}: this name goes with the next release; write instead: {}'.format(name, _instead_of(name)),
          file=sys.stderr, flush=True)
    if program.endswith('.py'):  # it is no program of ROS any more
        os.execv(sys.executable, [sys.executable, os.path.join(rospkg.RosPack().get_path(_PACKAGE), program),
                                  *sys.argv[1:]])
    try:
        path = find_executable(program)
    except LoopbackError as error:
        sys.exit('{}: {}'.format(name, error))
    os.execv(path, [path, *words, *sys.argv[1:]])


def _instead_of(name):
    return OLD_NAMES[name][-1].replace('`', '')


def _lines():
    width = max(len(name) for programs in PROGRAMS.values() for name in programs)
    for task, programs in PROGRAMS.items():
        yield task
        for name, (sentence, *_) in programs.items():
            yield '  {:{}}  {}'.format(name, width, sentence.replace('`', ''))
        yield ''
    yield 'rosrun {0} PROGRAM -h lists its options; rosrun {0} help PROGRAM names its page.'.format(_PACKAGE)


def _about(name):
    programs = {key: row for rows in PROGRAMS.values() for key, row in rows.items()}
    if name in OLD_NAMES:
        return ['{}: an old name, for one release; write instead: {}'.format(name, _instead_of(name))]
    if name not in programs:
        sys.exit("help: got '{}'; allowed: {}{}".format(
            name, ', '.join(programs), similar(name, [*programs, *OLD_NAMES])))
    sentence, page, _module = programs[name]
    return ['{}: {}'.format(name, sentence.replace('`', '')), 'Options: rosrun {} {} -h'.format(_PACKAGE, name),
            'Page: docs/{}'.format(page)]
