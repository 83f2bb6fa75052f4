"""A network's file: what the time master is told of it, and what is refused."""
import argparse
from textwrap import indent

import pytest

from move_base_abstract.common import options
from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.lockstep.run_options import RunOptions
from move_base_abstract.radio.network import resolve
from move_base_abstract.runs import metrics
from move_base_abstract.runs.story import Story
from move_base_abstract_experiments.trials.metrics import Radio
from move_base_abstract_replay.timelines import find_links

HOSTS = """
hosts:
  robot_*: {nodes: [/robot_*/**], at: robot}
  base: {nodes: [/coordinator, /monitor], at: [0, 1.5]}
"""
LINKS = """
links:
  - {between: [robot_*, base], delay: 0.02, loss: 0.01, rate: 1000000, range: 150.0}
  - {between: [robot_*, robot_*], delay: {uniform: [0.005, 0.05]}, loss: {distance: {50: 0.0, 100: 0.2, 150: 1}}}
"""


@pytest.fixture
def lines(tmp_path):
    """Return the lines of a network's file with this text."""
    def made(text, words=''):
        (tmp_path / 'n.yaml').write_text(text)
        return resolve({'network': 'n.yaml ' + words}, str(tmp_path))['network']
    return made


def test_lines_of_a_network(lines):
    assert lines('network:\n' + indent('seed: 3\nwired: [/tf]\nlost: retry' + HOSTS + LINKS, '  ')) == [
        'seed 3', 'host robot_* robot /robot_*/**', 'host base at 0.0 1.5 /coordinator /monitor', 'wired /tf',
        'link robot_* base delay 20000000 20000000 loss 0.01 rate 1000000 range 150.0 lost retry retry 200000000 '
        'attempts 8',
        'link robot_* robot_* delay 5000000 50000000 table 3 50.0 0.0 100.0 0.2 150.0 1.0 lost retry retry 200000000 '
        'attempts 8']


def test_the_least_delay_is_the_lookahead_where_it_is_to_be_so(lines, tmp_path):
    lines(HOSTS + LINKS)
    given = {'network': 'n.yaml', 'lookahead': 'network'}
    assert resolve(given, str(tmp_path))['lookahead'] == 0.005
    assert resolve({**given, 'lookahead': 0.5}, str(tmp_path))['lookahead'] == 0.5
    lines(HOSTS + LINKS + '  - {between: [base, base]}')
    with pytest.raises(ConfigurationError, match='its links, which is 0 s; allowed: 1e-06 s or more'):
        resolve(given, str(tmp_path))
    with pytest.raises(ConfigurationError, match="got 'network'; allowed: a number"):
        resolve({'lookahead': 'network'})


def test_arguments_and_path_loss(lines):
    text = HOSTS + """
seed: $(arg seed)
links: [{between: [base, base], lost: queue, buffer: 10,
         loss: {path_loss: {power: 20, sensitivity: -80, exponent: 3, shadowing: 6}}}]
"""
    found = lines(text, 'seed:=7')
    assert found[0] == 'seed 7'
    assert found[-1] == ('link base base delay 0 0 path 20.0 -80.0 3.0 1.0 40.0 6.0 buffer 10 lost queue '
                         'retry 200000000 attempts 8')
    with pytest.raises(ConfigurationError, match='arg seed'):
        lines(text)
    with pytest.raises(ConfigurationError, match='the file has no .*speed'):
        lines(text, 'seed:=7 speed:=1')


def test_walls_of_a_map(lines, tmp_path):
    (tmp_path / 'm.pgm').write_bytes(b'P5 4 2 255\n' + bytes([254, 0, 0, 254, 0, 254, 254, 0]))
    (tmp_path / 'm.yaml').write_text('{image: m.pgm, resolution: 0.5, origin: [-1, 2, 0], negate: 0, '
                                     'occupied_thresh: 0.65, free_thresh: 0.196}')
    found = lines('map: m.yaml' + HOSTS + 'links: [{between: [base, base], walls: 6}]')
    assert found[-4:-1] == ['walls -1.0 2.0 0.5 4 2', 'wall 0 0 1 3 4', 'wall 1 1 3']
    assert ' wall 6.0 ' in found[-1]


@pytest.mark.parametrize('text, says', [
    ('hosts: {}\nlinks: []\nspeed: 1', "unknown; did you mean 'seed'"),
    ('links: []', "'hosts' is missing"),
    (HOSTS + 'links: [{between: [a]}]', 'two names of hosts'),
    (HOSTS + 'links: [{between: [a, b], loss: 2}]', r'links\[0\].loss: got 2; allowed: a number in 0..1'),
    (HOSTS + 'links: [{between: [a, b], loss: {}}]', "one of 'distance' and 'path_loss'"),
    (HOSTS + 'links: [{between: [a, b], delay: {uniform: [2, 1]}}]', 'the smaller number first'),
    (HOSTS + 'links: [{between: [a, b], walls: 2}]', "no 'map'"),
    ('hosts: {r_*: {nodes: [/r_1/**], at: robot}}\nlinks: []', "since the host's name has one"),
    ('hosts: {r: {nodes: [r_1], at: robot}}\nlinks: []', 'an absolute name'),
    ('hosts: {r: {nodes: [/r_1], at: here}}\nlinks: []', "'robot', or a place"),
    ('[1]', 'a mapping with hosts'),
])
def test_what_is_refused(lines, text, says):
    with pytest.raises(ConfigurationError, match=says):
        lines(text)


def test_metrics_of_the_radio():
    counted = Radio()
    assert counted.sums(10**9) is None
    counted.take('link', ['a', 'b', 'down'], 10**9)
    counted.take('link', ['a', 'b', 'up'], 3 * 10**9)
    counted.take('link', ['a', 'c', 'up'], 10**9)
    counted.take('link', ['a', 'c', 'down'], 8 * 10**9)
    counted.take('radio', ['a', 'b', '/a', '/b', 5, 10**9, 2 * 10**9], 10**9)
    counted.take('radio', ['a', 'b', '/a', '/b', 5, 10**9, 10**9], 10**9)
    counted.take('radio_lost', ['a', 'b', '/a', '/b', 5, 10**9, 'loss'], 10**9)
    counted.take('radio', ['of somebody else'], 10**9)
    found = metrics.metrics_of(metrics.Figures(Story(0), radio=counted.sums(9 * 10**9)))
    assert {name: number for name, number in found.items() if metrics.METRICS[name].when is metrics.RADIO} == {
        'radio_messages': 3, 'delivery_ratio': pytest.approx(200 / 3), 'message_age': 0.5, 'out_of_reach': 1.5}


def test_links_of_a_replay():
    rows = [(1, '', 'link', '["base", "r", "down"]'), (1, 'base', 'host', '[1.5, 2]'),
            (5, '', 'link', '["base", "r", "up"]'), (1, '', 'link', '["base", "nowhere", "up"]'),
            (2, '', 'link', '[1]'), (2, 'x', 'host', '["a", null]')]
    assert find_links(rows, ['q', 'r']) == [
        {'ends': [{'name': 'base', 'x': 1.5, 'y': 2}, {'robot': 1}], 'times': [1, 5], 'up': [False, True]}]


def test_command_lines_without_a_network():
    parser = argparse.ArgumentParser()
    options.add_arguments(parser, RunOptions)
    assert options.of_arguments(RunOptions, parser, parser.parse_args([])) == RunOptions()
    given = options.of_arguments(RunOptions, parser, parser.parse_args(['--network', 'n.yaml loss:=1']))
    assert options.words_of(given) == ['--network', 'n.yaml loss:=1']
    for word, value in (('network', 'network'), ('0.5', 0.5)):
        found = parser.parse_args(['--network', 'n.yaml', '--lookahead', word])
        assert options.of_arguments(RunOptions, parser, found).lookahead == value
