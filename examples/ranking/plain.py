"""Missions of abstract robots in plain Python, for an experiment whose trial is a function (ranking.yaml)."""
import os

from dispatching import Dispatcher
from missions import free_places, make_mission, scenario_robots

from move_base_abstract import Environment, make_scenario
from move_base_abstract.maps.map_files import load_map, read_description

LIMIT = 900.0  # s; the time of a mission that has not ended by then
_WAYS = {'use_map': True, 'routes': 'grid', 'robot_radius': 0.4}
#: settings of the robots, from the simplest to the most complete
LEVELS = {'straight': {'max_speed': 1.0},
          'routes': {'max_speed': 1.0, **_WAYS},
          'calibrated': {'calibration': 'move_base_dwa_stage', **_WAYS}}
LEVELS['encounters'] = LEVELS['calibrated']  # with encounters of robots
LEVELS['stuck'] = {**LEVELS['calibrated'], 'failure_kind': 'calibrated'}  # with encounters, at which some get stuck
ALONE = ('straight', 'routes', 'calibrated')  # levels at which robots do not meet
PACKAGE = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..')
_maps = {}


def paths_of(name):
    """Return the paths at which the map ``name`` may be: in maps/ and beside the recordings; an absolute path stays."""
    file = name if name.endswith('.yaml') else name + '.yaml'
    return [os.path.join(PACKAGE, folder, file) for folder in ('maps', 'examples/reality/ranking')]


def map_of(name):
    """Return (map, its free places) for a name; each map is read once."""
    if name not in _maps:
        occupancy = load_map(read_description(next(filter(os.path.exists, paths_of(name)), name)))
        _maps[name] = occupancy, free_places(occupancy)
    return _maps[name]


def run_mission(level, policy, robots, mission, occupancy, seed):
    """Run one mission and return its makespan [s], whether it ended, and the number of tasks that failed."""
    starts = mission['starts'][:robots]
    env = Environment(make_scenario({
        'seed': seed, 'encounters': 'none' if level in ALONE else 'calibrated', 'defaults': LEVELS[level],
        'robots': scenario_robots(starts)}), trace=None, occupancy=occupancy)
    dispatcher = Dispatcher(policy, [start[:2] for start in starts], [tuple(task[:2]) for task in mission['tasks']])
    over = env.event()

    def drive(robot, number, task):
        outcome = yield robot.go(*mission['tasks'][task])
        dispatcher.ended(number, outcome.succeeded)
        begin()

    def begin():
        for number, task in dispatcher.begin(env.now):
            env.process(drive(env.robots[number], number, task))
        if dispatcher.over:
            over.succeed()
    begin()
    env.run(over | env.timeout(LIMIT))
    return {'mission_s': env.now, 'ended': dispatcher.over, 'failed': len(dispatcher.failed)}


def prepare(_args, factors):
    """Load the maps before the first trial, and drive a mission on each, so that its tables for routes exist."""
    for name in factors['map']:
        occupancy, places = map_of(name)
        run_mission('encounters', 'auction', 2, make_mission(places, 1), occupancy, 0)


def run(trial):
    """Run one trial of an experiment."""
    args = trial.args
    occupancy, places = map_of(args['map'])
    result = run_mission(args['level'], args['policy'], args['robots'], make_mission(places, args['tasks']), occupancy,
                         trial.seed)
    trial.simulated_seconds = result['mission_s']
    return result
