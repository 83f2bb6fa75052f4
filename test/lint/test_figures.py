"""The README has no figure of speed but those of docs/figures.json, which `make figures` measures."""
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / 'tools'))
import figures  # noqa: E402 - from this folder

TEXT = figures.README.read_text(encoding='utf-8')
#: speeds that are chosen, not measured: what a command asks for, and how a picture was made
CHOSEN = ('watched at 2x or at full speed', 'at most 20 times real time, to watch',
          'A run, ten times as fast as real time')
#: pages that speak of the same, and have no figures of their own
BESIDE = ('docs/site/index.md', 'docs/start.md', 'docs/demo.md')


def speeds(text):
    """Return the speeds of a text, those left out that were chosen and those between the comments."""
    for words in CHOSEN:
        text = text.replace(words, '')
    return figures.SPEED.findall(figures.PLACE.sub('', text))


def test_the_readme_says_what_was_measured():
    places = figures.PLACE.findall(TEXT)
    assert {name for _, name, _, _ in places} == set(figures.MEASURED)
    assert figures.written(TEXT, figures.read()) == TEXT, 'type: make figures'


def test_the_readme_has_no_other_speed():
    assert speeds(TEXT) == []


@pytest.mark.parametrize('page', BESIDE)
def test_other_pages_that_begin_have_no_speed_that_was_not_chosen(page):
    assert [speed for speed in speeds((ROOT / page).read_text(encoding='utf-8')) if 'thousands' in speed] == []


@pytest.mark.parametrize('words', ['it runs at 2111.4x real time', 'thousands of times faster',
                                   '131 to 247 times real time', '25 times as fast', '12x'])
def test_a_speed_is_recognised(words):
    assert speeds(TEXT + words)


@pytest.mark.parametrize('chosen', CHOSEN)
def test_what_is_chosen_is_still_there(chosen):
    assert chosen in TEXT


def entry(cpu, *runs):
    return {'cpu': cpu, 'cores': 2, 'load_before': 0.3, 'figures': {'demo': list(runs)},
            'messages_per_s': {'demo': 1.3}}


def test_a_machine_has_one_entry_and_the_range_is_over_all():
    machines = figures.merged([entry('b', 1.0), entry('a', 90.0)], entry('b', 131.4, 200.0))
    assert machines == [entry('a', 90.0), entry('b', 131.4, 200.0)]
    assert figures.sentence('demo', machines) == (
        '90 to 200 times real time with 1.3 messages per simulated second in 3 runs on 2 machines')
    assert 'one machine: a, 2 cores, load 0' in figures.sentence('demo', machines[:1])


def test_each_entry_says_when_where_and_from_what_it_came():
    machines = figures.read()
    assert machines
    for machine in machines:
        assert {'cpu', 'cores', 'date', 'commit', 'load_before', 'figures'} <= set(machine)
        assert set(machine['figures']) == set(figures.MEASURED)
        assert all(len(runs) == figures.RUNS for runs in machine['figures'].values())
