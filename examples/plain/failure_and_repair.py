"""Failure and repair: a robot stalls now and then, and a spare robot takes over a goal that takes too long.

20 goals: 19 by the first robot, 1 by the spare one
1 failures, over after 271 s
"""
from move_base_abstract import Environment, make_scenario


def deliver(env, main, spare, goals, done):
    """Send the first robot; if it takes 1 s more than twice its usual time, send the spare one, too."""
    for x in goals:
        came = main.go(x, 0.0)
        limit = env.timeout(2 * main.distance_to(x, 0.0) + 1.0)
        if came not in (yield came | limit):
            done['spare'] += (yield spare.go(x, 1.0)).succeeded
            yield came  # the first robot arrives once it is repaired
        else:
            done['main'] += 1


env = Environment(make_scenario({
    'seed': 5, 'defaults': {'max_speed': 1.0},
    'robots': [{'name': 'main', 'failure_kind': 'stall', 'failures_per_km': 10.0, 'repair_time': 60.0},
               {'name': 'spare', 'start_y': 1.0}]}))
counts = {'main': 0, 'spare': 0}
env.process(deliver(env, env.robot('main'), env.robot('spare'), [10.0, 0.0] * 10, counts))
env.run()
failures = [entry for entry in env.fleet.trace if entry.kind == 'failed']
print('20 goals: {main} by the first robot, {spare} by the spare one'.format(**counts))
print('{} failures, over after {:.0f} s'.format(len(failures), env.now))
