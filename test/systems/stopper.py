#!/usr/bin/env python3
"""A node that takes no part, and stops a run at many rounds and rows: stopper.py LOG ROWS SEED, the rows as 3,17,40.

It goes on from each stop after some 0.1 s of wall time, prints a line of JSON of each, and lets the run go on at last.
"""
import json
import random
import sys
import time

import rospy
from waiting import wait_for

from move_base_abstract.msg import TimeState
from move_base_abstract.srv import RecentMessages, StopWhen, StopWhenRequest
from move_base_abstract_ros.time_master_client import TimeMasterClient

TOPIC = '/fired'  # of which it prints the latest message that was kept
_states = {}


def stop(**wanted):
    """Stop the run, and return the state in which it stands."""
    answer = rospy.ServiceProxy('/time_master/stop_when', StopWhen)(**wanted)
    if not answer.success:
        raise SystemExit(answer.message)
    return wait_for(lambda: 'stop {}: {}'.format(answer.stop, _states.get('latest')),
                    lambda: _states['latest'].stops >= answer.stop and _states['latest'])


def show(state, log):
    """Print what is known at a stop."""
    with open(log + '.part') as stream:
        written = stream.read().count('\n') - 1  # without the head
    recent = rospy.ServiceProxy('/time_master/recent', RecentMessages)(topic=TOPIC, count=1).messages
    print(json.dumps({'rows': state.rows, 'written': written, 'row': state.stop_row, 'phase': state.phase,
                      'reason': state.reason, 'microstep': state.microstep,
                      'recent': [[one.time.to_nsec(), one.kind, one.sender, len(one.bytes)] for one in recent]}),
          flush=True)


def main(log, rows, seed):
    """Stop at each row, and sometimes at the rounds that follow."""
    chance = random.Random(int(seed))
    rospy.init_node('stopper')
    rospy.Subscriber('/time_master/state', TimeState, lambda state: _states.update(latest=state))
    rospy.wait_for_service('/time_master/stop_when')
    wait_for('the stop at the start', lambda: 'latest' in _states and _states['latest'].phase == 'stopped')
    for row in sorted(map(int, rows.split(','))):
        if row > _states['latest'].rows:
            show(stop(what=StopWhenRequest.ROW, row=row), log)
            time.sleep(chance.uniform(0.0, 0.2))
        for _ in range(chance.randrange(3)):
            show(stop(what=StopWhenRequest.ROUND, count=chance.randrange(3)), log)
            time.sleep(chance.uniform(0.0, 0.1))
    TimeMasterClient().resume()


if __name__ == '__main__':
    main(*sys.argv[1:4])
