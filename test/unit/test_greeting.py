"""What a newcomer to a latched topic gets, while another one is being told in another thread."""
import threading
from types import SimpleNamespace

import rospy

from move_base_abstract_ros.messages import outlets


class Making:
    """Makes what a newcomer gets of the present; the first time only when ``go`` is set."""

    def __init__(self):
        self.present = 'before'
        self.has_begun, self.go = threading.Event(), threading.Event()

    def __call__(self):
        made = self.present
        if not self.has_begun.is_set():
            self.has_begun.set()
            self.go.wait()
        return lambda _seq: made


def outlet_of(monkeypatch, make):
    """Return a latched outlet without a node."""
    monkeypatch.setattr(rospy, 'Publisher', lambda *_args, **_kwds: SimpleNamespace(
        impl=SimpleNamespace(latch=None, connections=[])))
    return outlets.LatchedOutlet('/topic', None, make)


def test_what_was_made_for_an_onlooker_does_not_take_the_place_of_what_a_participant_gets(monkeypatch):
    making = Making()
    outlet = outlet_of(monkeypatch, making)
    outlet._kept = (), None
    onlooker = threading.Thread(target=outlet.greet, args=(None,))
    onlooker.start()
    making.has_begun.wait()
    making.present = 'after'
    participant = threading.Thread(target=outlet.greet, args=(None,))
    participant.start()
    participant.join(0.3)  # it would have ended by now if it did not wait for the onlooker's
    making.go.set()
    onlooker.join()
    participant.join()
    assert outlet._impl.latch._pack(0) == 'after'


def test_what_was_slept_through_does_not_take_the_place_of_anything_later(monkeypatch):
    outlet = outlet_of(monkeypatch, lambda instant_ns: lambda _seq: instant_ns)
    outlet.show(7)
    for instant_ns, kept_ns in ((5, 7), (9, 9)):
        with outlets.nobody_hears():
            outlet.show(instant_ns)
        outlet.greet(None)
        assert outlet._impl.latch._pack(0) == kept_ns
