"""What a program sees of clocks and chance: functions of the seed, the node, simulated time, and what was before."""
import pytest

from move_base_abstract.lockstep import seen

SECOND = 10 ** 9


def test_clocks_go_on_with_simulated_time_and_with_what_was_slept_by_the_wall():
    clocks = seen.SeenClocks(3, False)
    assert [clocks.read(kind, 0) for kind in (seen.DATE, seen.UPTIME, seen.PROCESSOR)] == [
        1577836803 * SECOND, 3600 * SECOND, 0]
    clocks.add_sleep(SECOND // 2)
    assert clocks.read(seen.DATE, 2 * SECOND) == 1577836805 * SECOND + SECOND // 2
    assert seen.SeenClocks(-1, False).read(seen.DATE, 0) == (1577836800 + 315359999) * SECOND


def test_where_sleeps_are_simulated_all_clocks_show_simulated_time():
    clocks = seen.SeenClocks(3, True)
    assert {clocks.read(kind, 7) for kind in (seen.DATE, seen.UPTIME, seen.PROCESSOR)} == {7}


def test_a_loop_that_only_looks_sees_a_clock_go_on():
    clocks = seen.SeenClocks(0, False)
    for _ in range(2 * seen.LOOKS + 5):
        clocks.look()
    assert clocks.read(seen.PROCESSOR, 0) == 2 * seen.STEP_NS


@pytest.mark.parametrize('number, kind', [(0, seen.DATE), (1, seen.UPTIME), (2, seen.PROCESSOR), (3, seen.PROCESSOR),
                                          (4, seen.UPTIME), (5, seen.DATE), (6, seen.UPTIME), (7, seen.UPTIME),
                                          (11, seen.DATE), (-6, seen.PROCESSOR)])
def test_clocks_of_the_kernel(number, kind):
    assert seen.kind_of(number) == kind


def test_chance_is_a_function_of_the_text_and_of_the_place():
    one, same, other = seen.Entropy('0:/a'), seen.Entropy('0:/a'), seen.Entropy('1:/a')
    first = one.draw(8)
    assert [len(first), one.draw(0), same.draw(8)] == [8, b'', first]
    assert len({first, one.draw(8), other.draw(8)}) == 3
    with pytest.raises(ValueError):
        one.draw(-1)
