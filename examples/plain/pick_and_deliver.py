"""Pick and deliver: each order has two stops with service times, and goes to the robot that is free first.

order 7 by cart_1 at 72.0 s
order 9 by cart_0 at 80.7 s
order 8 by cart_2 at 87.0 s
10 orders, the last delivered at 87 s
"""
import simpy

from move_base_abstract import Environment, make_scenario

SHELVES, DOCK = [(4.0, 2.0), (8.0, 2.0), (12.0, 2.0)], (0.0, 6.0)
LOADING, UNLOADING = 5.0, 3.0  # s


def carry(env, robot, orders, delivered):
    """Take orders while there are any: drive to the shelf, load, drive to the dock, unload."""
    while orders:
        number, shelf = orders.pop(0)
        yield robot.go(*shelf)
        yield env.timeout(LOADING)
        yield robot.go(*DOCK)
        with gate.request() as place:  # one robot unloads at a time
            yield place
            yield env.timeout(UNLOADING)
        delivered.append((number, robot.name, env.now))


env = Environment(make_scenario({'defaults': {'max_speed': 1.5, 'acceleration': 0.7},
                                 'robots': [{'name': 'cart', 'count': 3, 'step_y': 1.0}]}))
gate = simpy.Resource(env)
waiting, done = [(number, SHELVES[number % 3]) for number in range(10)], []
for cart in env.robots:
    env.process(carry(env, cart, waiting, done))
env.run()
for number, name, at in done[-3:]:
    print('order {} by {} at {:.1f} s'.format(number, name, at))
print('{} orders, the last delivered at {:.0f} s'.format(len(done), env.now))
