"""The order in which an action's answers are sent on the scaled clock."""
import threading
import time
import unittest
from types import SimpleNamespace

from move_base_abstract.goals.events import Ended, robot_stream
from move_base_abstract.goals.ledger import GoalLedger
from move_base_abstract.goals.outcome import CANCELLED
from move_base_abstract_ros.robot.action_shell import ActionShell

DELAY = 0.02  # s, wall


class Sent:
    """Stands for an Outbox: notes what is sent, and when at the earliest."""

    def __init__(self):
        self.messages = []

    def send(self, outlet, _pack, not_before=0.0):
        """Note the message."""
        self.messages.append((outlet, not_before))

    def is_waiting(self):
        """Return whether anything has been sent."""
        return bool(self.messages)


class Topic(str):
    """Stands for an Outlet that a node hears."""

    def is_heard(self):
        """Return that a node hears it."""
        return 1


def shell_of_one_goal():
    """Return an ActionShell with the active goal 'g' that came just now, its ledger, and what it sends."""
    shell = ActionShell.__new__(ActionShell)
    shell.__dict__.update(
        _min_answer_delay=DELAY, _arrivals={}, _acceptance_wall=0.0, _outbox=Sent(), _has_told_end=False,
        _packed=(None, b''), _status=Topic('status'), _result=Topic('result'),
        _clock=SimpleNamespace(lock=threading.RLock(), simulation=SimpleNamespace(now_ns=0)))
    stream = robot_stream()
    stream.subscribe('clients', {Ended: lambda event: shell.publish_result(event, b'', event.time_ns)})
    shell._ledger = GoalLedger('bot', stream, SimpleNamespace(publish_status=shell.publish_status, new_id=str))
    shell._ledger.receive('g', 0, 0)
    shell._outbox.messages.clear()
    return shell


class ActionShellTest(unittest.TestCase):
    """A shell whose outbox only notes."""

    def test_the_status_of_an_end_comes_well_before_the_result_and_not_after_it(self):
        shell = shell_of_one_goal()
        for arrived in (time.monotonic(), time.monotonic() - DELAY):  # the cancel comes at once, or a little later
            shell.arrived('g', arrived)
            shell._ledger.cancel('g', 0, 0)
            shell._outbox.messages.clear()
            shell._ledger.finish(CANCELLED, 0)
            (first, status_at), (second, result_at) = shell._outbox.messages
            self.assertEqual((first, second), ('status', 'result'))
            self.assertGreaterEqual(result_at, arrived + DELAY)
            self.assertGreaterEqual(result_at - max(status_at, arrived), DELAY / 4)
            shell = shell_of_one_goal()

    def test_the_repeated_status_does_not_come_after_a_result_that_is_under_way(self):
        shell = shell_of_one_goal()
        shell._outbox.messages.append('result')
        shell._repeat_status(0)
        self.assertEqual(shell._outbox.messages, ['result'])
