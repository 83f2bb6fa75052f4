"""What robots tell at which rate, and to whom, in words."""
from move_base_abstract.config.rates import Rates


def fleet(*hearers, frequency=20.0):
    changes = []
    rates = Rates(lambda: changes.append(1))
    return rates, changes, [rates.add('feedback', lambda: frequency, lambda names=names: [
        ('/topic', name) for name in names]) for names in hearers]


def test_one_robot_and_nobody():
    rates, changes, _told = fleet([])
    assert rates.text() == 'feedback at 20 Hz to nobody'
    assert changes == [1]


def test_robots_that_do_the_same_are_one_line_and_names_come_once():
    rates, _changes, _told = fleet(['/b', '/a'], ['/a'])
    assert rates.text() == 'feedback at 20 Hz to /a, /b'


def test_it_is_said_how_many_of_the_robots_are_heard():
    rates, _changes, _told = fleet(['/a'], [], [])
    assert rates.text() == 'feedback at 20 Hz of 1 of 3 robots to /a'


def test_what_is_off_is_named_with_those_who_listen():
    rates, _changes, _told = fleet(['/a'], frequency=0.0)
    assert rates.text() == 'feedback not at a rate to /a'


def test_kinds_and_frequencies_come_in_their_order():
    rates, _changes, _told = fleet(['/a'])
    rates.add('tf', lambda: 2.5, lambda: [])
    rates.add('feedback', lambda: 5.0, lambda: [('/t', '/z')])
    assert rates.text() == 'feedback at 20 Hz to /a; tf at 2.5 Hz to nobody; feedback at 5 Hz to /z'


def test_many_names_are_counted():
    rates, _changes, _told = fleet(['/n{}'.format(i) for i in range(9)])
    assert rates.text() == 'feedback at 20 Hz to /n0, /n1, /n2, /n3, /n4 and 4 more'


def test_a_robot_that_is_removed_says_nothing_more():
    rates, changes, told = fleet(['/a'], ['/b'])
    rates.remove(told[0])
    assert rates.text() == 'feedback at 20 Hz to /b'
    assert changes == [1, 1, 1]
