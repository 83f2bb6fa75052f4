"""Charging policy: a robot charges when its battery is below one threshold, up to another; three pairs compared.

below 20% to 100%: 2 rounds, then it is empty
below 50% to 100%: 180 rounds
below 50% to 80%: 183 rounds
"""
from move_base_abstract import Environment, make_scenario


def work(env, robot, low, high, rounds):
    """Drive back and forth; below a charge of ``low`` (0 to 1), charge at the dock to ``high``."""
    while True:
        for x in (20.0, 2.0):
            outcome = yield robot.go(x, 0.0)
            if not outcome.succeeded:
                return  # the battery is empty
        rounds.append(env.now)
        if robot.state_of_charge < low:
            if not (yield robot.go(0.0, 0.0)).succeeded:
                return
            while robot.state_of_charge < high:
                yield env.timeout(10.0)


for low, high in ((0.2, 1.0), (0.5, 1.0), (0.5, 0.8)):
    env = Environment(make_scenario({
        'defaults': {'max_speed': 1.0, 'battery_capacity': 0.3, 'charging_current': 5.0},
        'robots': [{'name': 'bot'}],
        'zones': [{'name': 'dock', 'rectangle': [-1.0, -1.0, 1.0, 1.0], 'charger': True}]}))
    done = []
    working = env.process(work(env, env.robot('bot'), low, high, done))
    env.run(until=8 * 3600.0)
    ending = '' if working.is_alive else ', then it is empty'
    print('below {:.0%} to {:.0%}: {} rounds{}'.format(low, high, len(done), ending))
