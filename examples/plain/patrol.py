"""Patrol: two robots drive around the same four corners in opposite directions, and rest at each corner.

4.0 s: <robot a: idle at (6.00, 0.00, 0.00) at 4.000 s>
60 s: a 17 corners, b 17 corners
"""
from move_base_abstract import Environment, make_scenario

CORNERS = [(0.0, 0.0), (6.0, 0.0), (6.0, 4.0), (0.0, 4.0)]


def patrol(env, robot, corners, visits):
    """Drive around for ever, and rest for one second at each corner."""
    while True:
        for x, y in corners:
            yield robot.go(x, y)
            visits[robot.name] += 1
            if visits[robot.name] == 2 and robot.name == 'a':
                print('{} s: {}'.format(env.now, robot))
            yield env.timeout(1.0)


env = Environment(make_scenario({'defaults': {'max_speed': 2.0}, 'robots': [{'name': 'a'}, {'name': 'b'}]}))
counts = {'a': 0, 'b': 0}
env.process(patrol(env, env.robot('a'), CORNERS, counts))
env.process(patrol(env, env.robot('b'), CORNERS[::-1], counts))
env.run(until=60.0)
print('{:.0f} s: a {} corners, b {} corners'.format(env.now, counts['a'], counts['b']))
