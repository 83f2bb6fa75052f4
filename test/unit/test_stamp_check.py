import pytest

from move_base_abstract.supervision.follow_check import StampCheck

S = 10 ** 9


def test_stamps_of_the_present_are_alike():
    check = StampCheck(tolerance=1.0)
    for wall in range(100):
        assert check.reported(wall * S, wall * S + S // 2, float(wall)) is None
        assert check.is_alike


def test_a_fast_clock_whose_messages_are_late_by_some_of_the_walls_time_is_the_same_clock():
    check, gaps = StampCheck(tolerance=1.0, patience=2.0), []
    for tick in range(1000):  # 60x, 0.2 s of the wall late
        wall = tick * 0.01
        gaps.append(check.reported(int((wall - 0.2) * 60 * S), int(wall * 60 * S), wall))
    assert set(gaps) == {None}
    assert check.is_alike


def test_a_clock_that_runs_away_from_the_other_is_another_one():
    check, gaps = StampCheck(tolerance=1.0, patience=2.0), []
    for tick in range(1000):
        wall = tick * 0.01
        gaps.append(check.reported(int(wall * S), int(wall * 100 * S), wall))
    told = [gap for gap in gaps if gap is not None]
    assert len(told) == 1
    assert 250.0 <= told[0] <= 500.0


@pytest.mark.parametrize('gap', [141.2, -141.2])
def test_another_clock_is_told_once_after_the_patience_with_the_gap(gap):
    check = StampCheck(tolerance=1.0, patience=2.0)
    gaps = [check.reported(1000 * S, 1000 * S + int(gap * S), wall) for wall in (0.0, 1.9, 2.0, 3.0)]
    assert gaps == [None, None, pytest.approx(gap), None]
    assert not check.is_alike


def test_stamps_are_not_alike_before_that_is_told():
    check = StampCheck(tolerance=1.0, patience=2.0)
    assert check.reported(0, 5 * S, 0.0) is None
    assert not check.is_alike


def test_a_gap_that_closes_in_time_is_not_told_and_another_lapse_is():
    check = StampCheck(tolerance=1.0, patience=2.0)
    assert [check.reported(now - gap, now, wall) for now, gap, wall in (
        (50 * S, 5 * S, 0.0), (51 * S, 0, 1.0), (52 * S, 5 * S, 2.0), (53 * S, 5 * S, 4.0), (54 * S, 0, 5.0),
        (55 * S, 3 * S, 6.0), (56 * S, 3 * S, 8.0))] == [None, None, None, 5.0, None, None, 3.0]
