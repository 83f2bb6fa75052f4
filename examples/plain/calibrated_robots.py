"""Calibrated robots: ten goals, once by a nominal robot and 100 times by a robot that drives as real move_base did.

nominal speed alone: 137 s
calibrated: median 232 s, 90 % within 219 to 267 s
"""
import random

from move_base_abstract import Environment, make_scenario


def makespan(seed, **settings):
    """Return the time that ten goals take [s]."""
    env = Environment(make_scenario({'seed': seed, 'robots': [{'name': 'bot', **settings}]}))
    chance = random.Random(1)
    goals = [(chance.uniform(0, 20), chance.uniform(0, 20)) for _ in range(10)]

    def drive(bot):
        for x, y in goals:
            yield bot.go(x, y)
    env.run(env.process(drive(env.robot('bot'))))
    return env.now


nominal = makespan(0, max_speed=1.0041)
times = sorted(makespan(seed, calibration='move_base_dwa_stage') for seed in range(100))
print('nominal speed alone: {:.0f} s'.format(nominal))
print('calibrated: median {:.0f} s, 90 % within {:.0f} to {:.0f} s'.format(times[50], times[5], times[94]))
