"""What computations cost in simulated time, and the record that repeats it."""

import json
import math

import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.lockstep.charge import make_charge


class Clock:
    """A clock of the machine that is set by hand."""

    def __init__(self):
        self.now_ns = 100

    def __call__(self):
        return self.now_ns


def unread():
    raise AssertionError('this clock is not asked')


def charge(text, wall=unread, cpu=unread):
    return make_charge(text, wall, cpu)


@pytest.mark.parametrize('text', ['none', '', None])
def test_nothing_is_the_default(text):
    nothing = charge(text)
    nothing.begin()
    assert nothing.cost_ns(5) == 0
    assert nothing.is_repeatable


@pytest.mark.parametrize('text, cost_ns', [('fixed:0.25', 250_000_000), ('fixed:0', 0), ('fixed:1e-9', 1),
                                           ('fixed:3', 3_000_000_000)])
def test_a_fixed_charge_costs_the_same_at_all_times(text, cost_ns):
    fixed = charge(text)
    assert [fixed.cost_ns(now_ns) for now_ns in (0, 7, 10 ** 18)] == [cost_ns] * 3
    assert fixed.is_repeatable


@pytest.mark.parametrize('text', ['fixed', 'fixed:', 'fixed:-1', 'fixed:nan', 'fixed:inf', 'fixed:1e9', 'fixed:a',
                                  'none:1', 'replay', 'replay:', 'Measured', 'real', '1', 1, math.nan])
def test_anything_else_is_refused_with_what_is_allowed(text):
    with pytest.raises(ConfigurationError) as raised:
        charge(text)
    for word in (str(text), 'none', 'fixed:SECONDS', 'measured', 'measured_cpu', 'replay:FILE'):
        assert word in str(raised.value)


@pytest.mark.parametrize('kind', ['measured', 'measured_cpu'])
def test_a_measured_charge_is_what_its_clock_says_since_the_round_began(kind):
    clock = Clock()
    measured = charge(kind, **{'wall' if kind == 'measured' else 'cpu': clock})
    assert not measured.is_repeatable
    clock.now_ns = 1000
    measured.begin()
    clock.now_ns = 1700
    assert measured.cost_ns(5) == 700
    clock.now_ns = 2000
    measured.begin()
    clock.now_ns = 2001
    assert measured.cost_ns(6) == 1


def recorded(path, *costs):
    clock = Clock()
    measured = charge('measured:{}'.format(path), wall=clock)
    for time_ns, cost_ns in costs:
        measured.begin()
        clock.now_ns += cost_ns
        assert measured.cost_ns(time_ns) == cost_ns
    return measured


def test_a_record_has_its_name_when_it_is_complete_and_is_lines_of_json(tmp_path):
    path = tmp_path / 'costs'
    measured = recorded(path, (5, 700), (9, 30))
    assert not path.exists()
    assert (tmp_path / 'costs.part').exists()
    measured.close()
    measured.close()
    assert [json.loads(line) for line in path.read_text().splitlines()] == [
        {'time_ns': 5, 'cost_ns': 700}, {'time_ns': 9, 'cost_ns': 30}]
    assert not (tmp_path / 'costs.part').exists()


def test_a_record_is_replayed(tmp_path):
    path = tmp_path / 'costs'
    recorded(path, (5, 700), (5, 0), (9, 30)).close()
    replay = charge('replay:{}'.format(path))
    assert replay.is_repeatable
    replay.begin()
    assert [replay.cost_ns(now_ns) for now_ns in (5, 5, 9)] == [700, 0, 30]


@pytest.mark.parametrize('asked, where', [((5, 8), 'line 2 is of 9 ns'), ((4,), 'line 1 is of 5 ns'),
                                          ((5, 9, 10), 'at its end')])
def test_a_replay_of_another_run_is_refused_with_the_place(tmp_path, asked, where):
    path = tmp_path / 'costs'
    recorded(path, (5, 700), (9, 30)).close()
    replay = charge('replay:{}'.format(path))
    for now_ns in asked[:-1]:
        replay.cost_ns(now_ns)
    with pytest.raises(ConfigurationError) as raised:
        replay.cost_ns(asked[-1])
    for word in (str(path), '{} ns'.format(asked[-1]), where):
        assert word in str(raised.value)


@pytest.mark.parametrize('text', ['[1]', 'x', '{"time_ns": 1}', '{"time_ns": "a", "cost_ns": 1}', '3'])
def test_a_file_that_is_no_record_is_refused_with_the_line(tmp_path, text):
    path = tmp_path / 'costs'
    path.write_text('{"time_ns": 5, "cost_ns": 1}\n' + text + '\n')
    with pytest.raises(ConfigurationError, match='costs, line 2'):
        charge('replay:{}'.format(path))


@pytest.mark.parametrize('name', ['costs', 'costs.part'])
def test_a_record_takes_the_place_of_a_record_and_of_nothing_else(tmp_path, name):
    text = f'measured:{tmp_path}/costs'
    for earlier in ('{"time_ns": 1, "cost_ns": 2}\n', ''):
        (tmp_path / name).write_text(earlier)
        charge(text, Clock(), Clock()).close()
    (tmp_path / name).write_text('my thesis\n')
    with pytest.raises(ConfigurationError, match=f'{tmp_path}/{name}: is there already'):
        charge(text, Clock(), Clock())
    assert (tmp_path / name).read_text() == 'my thesis\n'


@pytest.mark.parametrize('text', ['measured:{}/no/such/folder', 'measured_cpu:{}/no/such/folder',
                                  'replay:{}/no/such/file'])
def test_a_file_that_cannot_be_opened_is_named(tmp_path, text):
    with pytest.raises(ConfigurationError, match='no/such'):
        charge(text.format(tmp_path), Clock(), Clock())
