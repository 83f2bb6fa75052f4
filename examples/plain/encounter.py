"""Encounter: two calibrated robots come towards each other, and that costs them time.

alone: 140.6 s
with each other: 162.9 s, 12 encounters
"""
import sys

from move_base_abstract import Environment, make_scenario

PLACES = ((26.0, 20.0), (46.0, 20.0))  # m, in the middle of maps/farm_yard.yaml


def there_and_back(robot, first, second, times):
    """Drive to one place and back to the other, twice."""
    for x, y in 2 * (first, second):
        result = yield robot.go(x, y)
        times.append(result.succeeded)


def run(encounters, log=None):
    """Return the time when both robots are done [s], and the number of encounters."""
    ends = [{'start_x': x, 'start_y': y} for x, y in PLACES]
    env = Environment(make_scenario({
        'seed': 3, 'encounters': encounters, 'defaults': {'calibration': 'move_base_dwa_stage', 'log_motion': True},
        'robots': [{'name': 'robot_0', **ends[0]}, {'name': 'robot_1', **ends[1], 'start_yaw': 3.14}]}))
    done = []
    env.process(there_and_back(env.robot('robot_0'), PLACES[1], PLACES[0], done))
    env.process(there_and_back(env.robot('robot_1'), PLACES[0], PLACES[1], done))
    env.run()
    if log:
        env.fleet.write_log(log)
    return env.now, sum(event.kind == 'encounter' for event in env.fleet.trace)


print('alone: {:.1f} s'.format(run('none')[0]))
print('with each other: {:.1f} s, {} encounters'.format(*run('calibrated', *sys.argv[1:2])))
