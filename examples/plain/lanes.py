"""Lanes: robots keep to a net of lanes, and the crossing has room for one robot at a time.

at 9.0 s robot_1 entered the crossing
at 22.0 s robot_0 entered the crossing
at 24.0 s robot_2 entered the crossing
5 of 5 arrived, the last at 46.4 s
"""
import os

from move_base_abstract import Environment, read_scenario

FILE = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', 'config', 'lanes_scenario.yaml')
GOALS = {'robot_0': (56.0, 36.0), 'robot_1': (30.0, 36.0), 'robot_2': (56.0, 20.0), 'robot_3': (4.0, 4.0),
         'robot_4': (4.0, 20.0)}


def watch(env, robot):
    """Print when the robot enters the crossing."""
    entry = yield robot.when('entered', 'zone crossing')
    print('at {:.1f} s {} entered the crossing'.format(env.now, entry.robot))


env = Environment(read_scenario(FILE))
for bot in env.robots:
    env.process(watch(env, bot))
outcomes = list(env.run(env.all_of([bot.go(*GOALS[bot.name]) for bot in env.robots])).values())
print('{} of {} arrived, the last at {:.1f} s'.format(
    sum(one.succeeded for one in outcomes), len(GOALS), max(one.time_ns for one in outcomes) / 1e9))
