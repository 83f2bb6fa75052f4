"""The window of simulated time through which a Python participant goes by itself."""
from move_base_abstract.lockstep import wire
from move_base_abstract.lockstep.window import Window

MS = 1000000
SENT, SET = wire.send(1, 0, 0, b'x'), wire.parameter('/p', True, '<value>1</value>')


def message(payload):
    return (wire.DELIVER, 1, 2, payload)


def opened(*items):
    window = Window()
    assert window.take([(wire.WINDOW, 50 * MS, 50 * MS), *items], 10 * MS) == []
    return window


def test_what_arrives_later_is_kept_until_its_instant():
    window = Window()
    items = [(wire.WINDOW, 50 * MS, 50 * MS), message(b'now'), (wire.ARRIVES, 20 * MS), message(b'then'),
             message(b'too'), (wire.ARRIVES, 30 * MS), message(b'last')]
    assert window.take(items, 10 * MS) == [message(b'now')]
    assert window.walk(wire.NEVER, 10 * MS, [])
    assert window.next_turn() == (20 * MS, [message(b'then'), message(b'too')])
    assert window.walk(25 * MS, 20 * MS, [])
    assert window.next_turn() == (25 * MS, [])
    assert window.first_arrival_ns == 30 * MS  # the time master is to know, where the window is left early


def test_a_window_is_left_at_its_end():
    assert opened().walk(50 * MS - 1, 10 * MS, [])
    assert not opened().walk(50 * MS, 10 * MS, [])
    assert not opened().walk(wire.NEVER, 10 * MS, [])


def test_each_turn_is_told_with_its_instant():
    window = opened()
    done = [SENT]
    assert window.walk(20 * MS, 10 * MS, done) and done == []
    assert window.walk(20 * MS, 20 * MS, [SENT])  # once more at the same instant
    assert window.take_walked([SENT]) == [SENT, wire.at(20 * MS), SENT, SENT]
    assert window.take_walked([]) == []


def test_what_the_time_master_does_is_seen_in_the_next_turn():
    for item in (SET, wire.rest()):
        window = opened()
        assert not window.walk(20 * MS, 10 * MS, [SENT, item])
        assert window.take_walked([SENT, item]) == [SENT, item]


def test_a_loop_at_one_instant_is_left_to_the_time_master():
    window = opened()
    turns = 0
    while window.walk(10 * MS, 10 * MS, []):
        turns += 1
        assert window.next_turn() == (10 * MS, [])
        assert turns < 1000
    assert turns == 100


def test_without_a_window_all_is_as_the_grant_has_it():
    window = Window()
    assert window.take([message(b'x')], 10 * MS) == [message(b'x')]
    assert not window.is_open
    assert window.first_arrival_ns == wire.NEVER


def test_what_was_kept_comes_before_what_the_next_grant_has():
    window = opened((wire.ARRIVES, 20 * MS), message(b'kept'))
    items = [(wire.WINDOW, 70 * MS, 50 * MS), message(b'new')]
    assert window.take(items, 20 * MS) == [message(b'kept'), message(b'new')]
