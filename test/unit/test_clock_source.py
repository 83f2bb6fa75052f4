from move_base_abstract.supervision.clock_source import ClockSource, Step


def judge(source, *messages):
    return [source.judge(time_ns, who, wall) for time_ns, who, wall in messages]


def test_time_moves_on_or_stays():
    source = ClockSource()
    assert judge(source, (0, 'a', 0.0), (5, 'a', 0.1), (5, 'a', 0.2), (7, 'a', 0.3)) == [
        Step.SAME, Step.ON, Step.SAME, Step.ON]
    assert source.latest_ns == 7


def test_a_clock_whose_own_time_goes_back_has_started_anew_at_once():
    source = ClockSource()
    assert judge(source, (100, 'stage', 0.0), (1, 'stage', 0.01), (2, 'stage', 0.02)) == [Step.ON, Step.ANEW, Step.ON]
    assert source.latest_ns == 2


def test_a_second_clock_that_is_behind_does_not_count_while_the_first_one_speaks():
    source = ClockSource(patience=3.0)
    for second in range(100):
        assert source.judge(1000 + second, 'a', float(second)) is Step.ON
        assert source.judge(second, 'b', second + 0.5) is Step.BEHIND
    assert source.latest_ns == 1099


def test_a_clock_that_stands_still_speaks_too():
    source = ClockSource(patience=3.0)
    assert source.judge(1000, 'a', 0.0) is Step.ON
    for second in range(1, 100):
        assert source.judge(1000, 'a', float(second)) is Step.SAME
        assert source.judge(second, 'b', second + 0.5) is Step.BEHIND


def test_another_clock_takes_over_when_the_first_one_has_been_silent_for_the_patience():
    source = ClockSource(patience=3.0)
    assert judge(source, (1000, 'a', 0.0), (1, 'b', 3.0), (2, 'b', 3.1), (3, 'b', 3.2)) == [
        Step.ON, Step.BEHIND, Step.ANEW, Step.ON]
    assert source.leader == 'b'


def test_the_clock_that_is_ahead_leads():
    source = ClockSource()
    assert judge(source, (10, 'a', 0.0), (20, 'b', 0.1), (11, 'a', 0.2), (21, 'b', 0.3), (22, 'a', 0.4)) == [
        Step.ON, Step.ON, Step.BEHIND, Step.ON, Step.ON]
