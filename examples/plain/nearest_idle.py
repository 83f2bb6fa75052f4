"""Nearest idle robot: tasks arrive at random, and each goes to the nearest idle robot, or waits until one is idle.

30 tasks done, the last at 783 s
wait: mean 2 s, longest 14 s
"""
import simpy

from move_base_abstract import Environment, make_scenario

SCENARIO = make_scenario({
    'seed': 3, 'defaults': {'max_speed': 1.0, 'acceleration': 0.5},
    'robots': [{'name': 'robot', 'count': 3, 'step_x': 10.0}], 'places': [],
    'arrivals': [{'name': 'field', 'area': [0, 0, 30, 20], 'rate_per_hour': 120, 'count': 30, 'duration': 10}]})


def serve(env, robot, task, idle, waits):
    """Have the robot drive to a task and do it, then put the robot back to the idle ones."""
    waits.append(env.now - task.arrival_ns / 1e9)
    yield robot.go(task.pose.x, task.pose.y)
    yield robot.work(task)
    idle.put(robot)


def dispatch(env, idle, waits):
    """Give each task, when it arrives, to the nearest idle robot."""
    for task in SCENARIO.tasks():
        yield env.timeout(max(0.0, task.arrival_ns / 1e9 - env.now))
        if not idle.items:  # wait until a robot is idle
            idle.put((yield idle.get()))
        nearest = min(idle.items, key=lambda robot: robot.distance_to(task.pose.x, task.pose.y))
        robot = yield idle.get(lambda one, nearest=nearest: one is nearest)
        env.process(serve(env, robot, task, idle, waits))


env = Environment(SCENARIO)
idle_robots, waited = simpy.FilterStore(env), []
for one in env.robots:
    idle_robots.put(one)
env.process(dispatch(env, idle_robots, waited))
env.run()
print('{} tasks done, the last at {:.0f} s'.format(len(waited), env.now))
print('wait: mean {:.0f} s, longest {:.0f} s'.format(sum(waited) / len(waited), max(waited)))
