"""What a participant tells beforehand: series of one template once, and other messages one by one."""
import struct
import threading
from types import SimpleNamespace

import pytest

from move_base_abstract.engine.series import Series
from move_base_abstract.engine.simulation import Simulation
from move_base_abstract.lockstep import wire
from move_base_abstract_ros.lockstep.exchange import playing
from move_base_abstract_ros.messages import packing

SECOND = 10**9
PLAY = struct.Struct('<BIIIBIqqI')  # up to the length of its payload


class Publisher:
    """A publisher of rospy's that a participant hears, and the link to it.

    Its number holds under its lock only: rospy's thread sends a newcomer a message that does not count.
    """

    closed, resolved_name = False, '/topic'

    def __init__(self, sub=0):
        self.connections, self._sub = [self], sub
        self._seq, self._locked = 10, False

    @property
    def seq(self):
        return self._seq if self._locked else self._seq + 1

    @seq.setter
    def seq(self, number):
        assert self._locked
        self._seq = number

    def acquire(self):
        self._locked = True

    def release(self):
        self._locked = False

    def address(self):
        return 1, self._sub, (2,)


class Source:
    """Series that send by rospy's publishers, and a Player of theirs; ``done`` is what each does again afterwards."""

    def __init__(self):
        self.simulation, self.lock = Simulation(), threading.RLock()
        self.done = []
        self.player = playing.Player(self)

    def sends(self, publisher, hertz, first, slots=None):
        def send(due_ns, _now_ns):
            def pack(seq):
                return b'%d at %d' % (seq, due_ns // (SECOND // 10))
            if playing.is_recording():
                playing.note(publisher, pack if slots is None else packing.Template(pack, slots))
            else:
                self.done.append(due_ns / SECOND)
        Series(self.simulation.queue, 0, SECOND // hertz, send, is_output=True).start(round(first * SECOND))

    def played(self, until_ns, last):
        for due_ns, series in last:
            series.skip(due_ns)
            self.simulation.tell(due_ns, series)

    def told(self, before=1000.0):
        """Return ([(payload, first [s], period [s] or None), ...], end [s]) of a report."""
        items = []
        end_ns = self.player.tell(self.simulation.now_ns, round(before * SECOND), items)
        plays = []
        for item in items:
            if item[0] == wire.ITEMS['PLAY'].number:
                *_, first_ns, period_ns, size = PLAY.unpack_from(item)
                plays.append((item[PLAY.size:PLAY.size + size], first_ns / SECOND,
                              None if period_ns == wire.NEVER else period_ns / SECOND))
        return plays, end_ns / SECOND


def test_messages_without_slots_are_told_one_by_one_until_something_else_comes():
    source = Source()
    source.sends(Publisher(), 2, 1.0)
    source.sends(Publisher(), 10, 1.1, slots=())
    assert source.told(before=2.0) == (
        [(b'11 at 10', 1.0, None), (b'12 at 15', 1.5, None), (b'11 at 11', 1.1, 0.1)], 2.0)


def test_a_publisher_of_several_series_counts_its_messages_in_the_order_of_their_instants():
    source, publisher = Source(), Publisher()
    source.sends(publisher, 2, 1.1)
    source.sends(publisher, 2, 1.0)
    assert source.told(before=1.7)[0] == [(b'12 at 11', 1.1, None), (b'14 at 16', 1.6, None),
                                          (b'11 at 10', 1.0, None), (b'13 at 15', 1.5, None)]
    source.player.happened(round(1.5 * SECOND))
    assert publisher._seq == 13
    assert source.done == [1.1, 1.5]  # the last one of each series
    assert source.told(before=1.9)[0] == [(b'14 at 16', 1.6, None)]


def test_fewer_are_made_in_vain_if_mail_comes_in_between():
    source = Source()
    source.sends(Publisher(), 100, 1.0)
    assert source.told()[1] == 1.64
    source.player.happened(round(1.03 * SECOND))
    assert source.told()[1] == 1.09


def test_series_of_which_few_messages_come_to_pass_are_not_played_for_a_while():
    source = Source()
    source.sends(Publisher(), 10, 0.1, slots=())
    for number in range(4):  # something comes after two messages
        assert len(source.told()[0]) == 1
        source.player.happened(round((0.2 + 0.2 * number) * SECOND))
    for _turn in range(16):
        assert source.told() == ([], 0.9)
    assert len(source.told()[0]) == 1
    source.player.happened(round(1.1 * SECOND))  # this time three
    assert len(source.told()[0]) == 1


@pytest.mark.parametrize('is_shifted', [False, True])
def test_a_shifted_pose_is_told_one_by_one_while_its_robot_drives(is_shifted):
    source, robot = Source(), SimpleNamespace(leg=None)
    playing.follow(77, playing.Mover('robot', lambda: robot.leg, lambda _leg: b''))
    source.sends(Publisher(sub=77), 2, 1.0, [(wire.Slot.POSE, 0)] + [packing.SHIFTED] * is_shifted)
    assert len(source.told(before=2.0)[0]) == 1
    robot.leg = object()
    assert len(source.told(before=2.0)[0]) == 1 + is_shifted


def test_a_series_with_an_onlooker_ends_what_is_played():
    source, publisher = Source(), Publisher()
    source.sends(Publisher(), 10, 1.0, slots=())
    source.sends(publisher, 2, 1.5)
    publisher.connections.append(object())
    assert source.told() == ([(b'11 at 10', 1.0, 0.1)], 1.5)
