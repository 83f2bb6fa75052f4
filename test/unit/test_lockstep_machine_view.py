"""What a program sees of clocks and chance: functions of the seed, the node, simulated time, and what was before."""
import pytest

from move_base_abstract.lockstep import machine_view as view

SECOND = 10 ** 9


def test_clocks_go_on_with_simulated_time_and_with_what_was_slept_by_the_wall():
    clocks = view.SeenClocks(3, False)
    assert [clocks.read(kind, 0) for kind in (view.DATE, view.UPTIME, view.PROCESSOR)] == [
        1577836803 * SECOND, 3600 * SECOND, 0]
    clocks.add_sleep(SECOND // 2)
    assert clocks.read(view.DATE, 2 * SECOND) == 1577836805 * SECOND + SECOND // 2
    assert view.SeenClocks(-1, False).read(view.DATE, 0) == (1577836800 + 315359999) * SECOND


def test_where_sleeps_are_simulated_all_clocks_show_simulated_time():
    clocks = view.SeenClocks(3, True)
    assert {clocks.read(kind, 7) for kind in (view.DATE, view.UPTIME, view.PROCESSOR)} == {7}


def test_a_loop_that_only_looks_sees_a_clock_go_on():
    clocks = view.SeenClocks(0, False)
    for _ in range(2 * view.LOOKS + 5):
        clocks.look()
    assert clocks.read(view.PROCESSOR, 0) == 2 * view.STEP_NS


@pytest.mark.parametrize('number, kind', [(0, view.DATE), (1, view.UPTIME), (2, view.PROCESSOR), (3, view.PROCESSOR),
                                          (4, view.UPTIME), (5, view.DATE), (6, view.UPTIME), (7, view.UPTIME),
                                          (11, view.DATE), (-6, view.PROCESSOR)])
def test_clocks_of_the_kernel(number, kind):
    assert view.kind_of(number) == kind


def test_chance_is_a_function_of_the_text_and_of_the_place():
    one, same, other = view.Entropy('0:/a'), view.Entropy('0:/a'), view.Entropy('1:/a')
    first = one.draw(8)
    assert [len(first), one.draw(0), same.draw(8)] == [8, b'', first]
    assert len({first, one.draw(8), other.draw(8)}) == 3
    with pytest.raises(ValueError):
        one.draw(-1)
