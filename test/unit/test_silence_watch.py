from move_base_abstract.supervision.silence_watch import Silence, SilenceWatch


def test_what_is_heard_in_time_is_not_told():
    watch = SilenceWatch(limit=8.0)
    watch.add('a', 0.0)
    for step in range(100):
        watch.heard('a', 7.9 * step)
        assert watch.check(7.9 * step + 7.8) == Silence()


def test_what_was_never_heard_is_told_after_the_limit_and_again_after_the_repeat():
    watch = SilenceWatch(limit=8.0, repeat=60.0)
    watch.add('a', 100.0)
    assert watch.check(107.9) == Silence()
    assert watch.check(108.0) == Silence(unheard=('a',))
    assert watch.check(167.9) == Silence()
    assert watch.check(168.0) == Silence(unheard=('a',))


def test_what_falls_silent_is_told_once_and_so_is_its_return():
    watch = SilenceWatch(limit=8.0)
    watch.add('a', 0.0)
    watch.heard('a', 1.0)
    assert watch.check(9.0) == Silence(silent=('a',))
    assert watch.check(20.0) == Silence()
    watch.heard('a', 21.0)
    assert watch.check(22.0) == Silence(back=('a',))
    assert watch.check(23.0) == Silence()
    assert watch.check(29.0) == Silence(silent=('a',))


def test_the_default_limit_leaves_room_within_the_ten_seconds_that_the_page_promises():
    assert SilenceWatch().limit <= 9.0


def test_all_that_are_silent_are_told_together_in_order():
    watch = SilenceWatch(limit=8.0)
    for name in ('c', 'a', 'b'):
        watch.add(name, 0.0)
    watch.heard('b', 0.0)
    assert watch.check(8.0) == Silence(unheard=('c', 'a'), silent=('b',))


def test_what_is_watched_no_more_is_not_told():
    watch = SilenceWatch(limit=8.0)
    watch.add('a', 0.0)
    watch.remove('a')
    watch.heard('a', 1.0)
    assert watch.check(100.0) == Silence()
