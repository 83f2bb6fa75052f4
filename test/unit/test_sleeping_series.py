"""Series that only tell, while nobody hears them and when somebody begins to."""
from move_base_abstract.engine.series import NOBODY, ONLOOKERS, PARTICIPANTS, Series
from move_base_abstract.engine.simulation import Simulation


class Heard:
    """Two robots' series that only tell, and who hears them."""

    def __init__(self):
        self.simulation = Simulation()
        self.heard = {0: False, 1: False}
        self.told = []
        for robot_index, period_ns in ((0, 10), (1, 15)):
            Series(self.simulation.queue, robot_index, period_ns,
                   lambda due_ns, now_ns, robot_index=robot_index: self.told.append((due_ns, robot_index)),
                   is_output=True, is_heard=lambda robot_index=robot_index: self.heard[robot_index]).start(0)

    def until(self, now_ns):
        for each_ns in range(self.simulation.now_ns, now_ns + 1):
            self.simulation.advance(each_ns)
        told, self.told = self.told, []
        return told


def test_what_nobody_hears_tells_its_first_event_and_then_has_none():
    heard = Heard()
    assert heard.until(1) == [(0, 0), (0, 1)]
    assert heard.simulation.next_due_ns() is None
    assert heard.until(1000) == []


def test_what_is_heard_again_goes_on_at_its_own_multiples_and_makes_up_for_the_last_one_only():
    heard = Heard()
    heard.until(0)
    heard.until(34)
    heard.heard[0] = True
    heard.simulation.wake()
    assert heard.told == [(30, 0)]  # its latest, made up for
    assert heard.simulation.now_ns == 34
    assert heard.until(60) == [(30, 0), (40, 0), (50, 0), (60, 0)]
    heard.heard[1] = True
    heard.simulation.wake()
    assert heard.told == [(60, 1)]
    assert heard.until(80)[1:] == [(70, 0), (75, 1), (80, 0)]


def test_a_multiple_at_the_present_belongs_to_the_past_when_somebody_begins_to_hear():
    heard = Heard()
    heard.until(0)
    heard.until(30)
    heard.heard.update({0: True, 1: True})
    heard.simulation.wake()
    assert heard.until(45) == [(30, 0), (30, 1), (40, 0), (45, 1)]


def test_what_was_heard_all_the_time_and_what_was_woken_keep_the_same_order():
    """Whoever listens from when on, the order of equal events is that of robots and of the series' making."""
    orders = []
    for wakes_ns in (0, 7, 12, 31):
        heard = Heard()
        heard.heard[1] = True
        heard.until(wakes_ns)
        heard.heard[0] = True
        heard.simulation.wake()
        heard.until(32)
        orders.append(heard.until(120))
    assert orders == [orders[0]] * 4


def test_a_series_that_sleeps_can_be_stopped_and_started():
    heard = Heard()
    heard.until(0)
    series = heard.simulation.queue._asleep[0]
    series.stop()
    heard.heard[0] = True
    heard.simulation.wake()
    assert heard.until(50) == []
    series.start(52)
    assert heard.until(70) == [(52, 0), (62, 0)]


def test_what_nobody_hears_is_no_heard_output():
    heard = Heard()
    heard.heard[0] = True
    heard.until(1)
    output, end_ns = heard.simulation.queue.heard_output(31)
    assert ([due_ns for due_ns, _ in output], end_ns) == ([10], 31)
    heard.heard[0] = False
    assert heard.simulation.queue.heard_output(31) == ([], 31)
    heard.until(25)
    heard.heard[0] = True
    heard.simulation.wake()
    assert heard.until(33) == [(20, 0), (30, 0)]


def test_output_comes_after_what_happens_to_the_same_robot():
    simulation, lines = Simulation(), []
    simulation.series(0, 1e8, lambda due_ns, _now_ns: lines.append('tells'), is_output=True).start(0)
    simulation.advance(5)
    simulation.queue.schedule(10, 0, lambda due_ns, now_ns: lines.append('happens'))
    simulation.queue.schedule(10, 1, lambda due_ns, now_ns: lines.append('happens to another'))
    simulation.advance(10)
    assert lines == ['tells', 'happens', 'tells', 'happens to another']


def test_events_for_onlookers_only_are_known_as_such():
    heard = Heard()
    queue = heard.simulation.queue
    assert not queue.is_for_onlookers()  # the first events of series always happen
    heard.until(0)
    assert not queue.is_for_onlookers()  # there are none
    heard.heard = {0: ONLOOKERS, 1: NOBODY}
    heard.simulation.wake()
    assert queue.is_for_onlookers()
    end = queue.schedule(1000, 0, lambda due_ns, now_ns: None)
    assert not queue.is_for_onlookers()
    end.cancel()
    assert queue.is_for_onlookers()
    heard.heard[0] = PARTICIPANTS
    assert not queue.is_for_onlookers()


def test_what_sleeps_is_shifted_with_all_that_is_due():
    heard = Heard()
    heard.until(0)
    heard.simulation.queue.shift(3)
    heard.until(35)
    heard.heard[0] = True
    heard.simulation.wake()
    assert heard.told == [(33, 0)]
    assert heard.until(45) == [(33, 0), (43, 0)]
