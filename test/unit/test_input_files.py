"""Every file that somebody names comes through one gate; tables and logs say what is wrong with them, and where."""
import os

import pytest

from move_base_abstract.common.errors import ConfigurationError, SimulatorError
from move_base_abstract.common.input_files import open_input, open_text_input
from move_base_abstract.config.settings import read_settings
from move_base_abstract.engine.simulation import Simulation
from move_base_abstract.fleet import Fleet
from move_base_abstract.lockstep import charge
from move_base_abstract.maps.lane_map import make_lane_map, read_lane_map
from move_base_abstract.maps.map_files import read_description, read_pixels
from move_base_abstract.maps.travel_matrix import read_travel_matrix
from move_base_abstract.mission import read_field_points, read_mission
from move_base_abstract.runs.event_log import EventLog, EventLogError, open_text
from move_base_abstract.runs.run_difference import compare
from move_base_abstract.scenario import make_scenario, read_scenario
from move_base_abstract.tasks.arrivals import read_arrivals
from move_base_abstract.tasks.places import read_places
from move_base_abstract_calibration.csv_files import read_legs
from move_base_abstract_experiments.description import spec
from move_base_abstract_replay.recording import read_recording
from soil_mapping.ground_truth.field import load_field
from soil_mapping.ground_truth.inputs import inputs_of

S = 1_000_000_000
HEAD = '{"event_log":1,"start_ns":0}\n'
PLACES = read_places([{'name': 'dock', 'duration': 5.0}], 'x')


def arrivals_of(path):
    return read_arrivals([{'name': 'a', 'file': path}], PLACES, 'x')


def opened(path):
    with open_text(path):
        pass


#: (what reads a path, the end that its name needs)
READERS = [
    (read_scenario, ''), (read_mission, ''), (read_field_points, ''), (read_description, ''), (read_pixels, ''),
    (read_legs, ''), (opened, ''), (read_recording, ''), (lambda path: compare(path, path), ''),
    (lambda path: read_lane_map(path, 'x'), ''), (lambda path: read_travel_matrix(path, 'x'), ''),
    (lambda path: read_travel_matrix(path, 'x'), '.csv'), (arrivals_of, '.csv'), (arrivals_of, '.yaml'),
    (lambda path: read_settings({'duration_distribution': 'quantiles', 'duration_quantiles': path}, 'x'), ''),
    (lambda path: read_settings({'calibration': path}, 'x'), '.yaml'), (lambda path: spec.read(path, '.'), ''),
    (lambda path: load_field('csv:' + path), ''), (lambda path: inputs_of('csv:' + path), ''),
    (lambda path: inputs_of('synthetic', 'replay:' + path), ''),
    (lambda path: charge.make_charge('replay:' + path, None, None), '')]


@pytest.mark.parametrize('read, end', READERS)
def test_pipes_devices_and_folders_are_refused_at_once_by_whatever_reads(read, end, tmp_path):
    names = {kind: str(tmp_path / (kind + end)) for kind in ('pipe', 'device', 'folder', 'nothing')}
    os.mkfifo(names['pipe'])
    os.mkdir(names['folder'])
    os.symlink('/dev/zero', names['device'])
    for kind, words in (('pipe', 'is a pipe; allowed: a'), ('device', 'is a device; allowed: a'),
                        ('folder', 'is a folder; allowed: a'), ('nothing', 'cannot be read: No such file')):
        with pytest.raises(SimulatorError, match=words) as caught:
            read(names[kind])
        assert names[kind] in str(caught.value)


def test_a_file_is_read_whatever_it_is_called_and_not_beyond_its_bound(tmp_path):
    path = tmp_path / 'ü\n".txt'
    path.write_bytes(b'abc')
    with open_text_input(path) as stream:
        assert stream.read() == 'abc'
    with pytest.raises(ConfigurationError, match='has 3 bytes; allowed: a file of at most 2'), open_input(path, 2):
        pass
    with pytest.raises(ConfigurationError, match='cannot be read: embedded null byte'), open_input('a\0b'):
        pass


# ---- tables

ARRIVALS = 'time,place\n1.0,dock\n'
MATRIX = 'from,from_x,from_y,to,to_x,to_y,seconds\na,0,0,b,5,0,10\n'
LEGS = ('start_x,start_y,start_yaw,goal_x,goal_y,goal_yaw,duration_s,state\n', '0,0,0,5,0,0,10,3\n')


@pytest.mark.parametrize('read, text, words', [
    (arrivals_of, '', 'line 1: got no columns'),
    (arrivals_of, 'time,place\n', 'got no tasks; allowed: at least one'),
    (arrivals_of, 'time,place,time\n1.0,dock,2.0\n', "line 1: the column 'time' is there 2 times"),
    (arrivals_of, ARRIVALS + '2.0,dock,7\n', 'line 3: got 3 cells; allowed: 2, as many as'),
    (arrivals_of, ARRIVALS + '\n2.0\n', 'line 4: got 1 cells; allowed: 2'),
    (arrivals_of, ARRIVALS + '"2.0\n', 'cannot be read as CSV: unexpected end of data'),
    (lambda path: read_travel_matrix(path, 'x'), '', 'line 1: got no columns'),
    (lambda path: read_travel_matrix(path, 'x'), MATRIX + 'b,5,0,a,0,0,10,11\n', 'line 3: got 8 cells; allowed: 7'),
    (lambda path: read_travel_matrix(path, 'x'), MATRIX.replace('seconds', 'to'), "the column 'to' is there 2 times"),
    (lambda path: read_travel_matrix(path, 'x'), MATRIX.replace('seconds', 'minutes'), 'columns: got'),
    (read_legs, '', 'line 1: got no columns'),
    (read_legs, LEGS[0], 'got no rows; allowed: a table with start_x'),
    (read_legs, '# a comment\n' + ''.join(LEGS) + '0,0,0\n', 'line 4: got 3 cells; allowed: 8'),
    (read_legs, LEGS[0].replace('state', 'start_x') + LEGS[1], "the column 'start_x' is there 2 times")])
def test_a_table_that_is_not_whole_is_refused_with_the_line(read, text, words, tmp_path):
    path = tmp_path / 'table.csv'
    path.write_text(text)
    with pytest.raises(ConfigurationError, match=words):
        read(str(path))


# ---- numbers at the ends of what there is

@pytest.mark.parametrize('edge, words', [({'speed': 5e-324}, 'speed: got 5e-324; allowed: a number in 1e-6..1e6'),
                                         ({'length': 1e308}, r'length: got 1e\+308; allowed: a number in 1e-6..1e9'),
                                         ({'speed': 1e300}, 'speed: got'), ({'length': 5e-324}, 'length: got')])
def test_lanes_have_speeds_and_lengths_that_can_be_driven(edge, words):
    nodes = [{'name': 'a', 'x': 0.0, 'y': 0.0}, {'name': 'b', 'x': 5.0, 'y': 0.0}]
    with pytest.raises(ConfigurationError, match=words):
        make_lane_map({'nodes': nodes, 'edges': [{'from': 'a', 'to': 'b', **edge}]})


@pytest.mark.parametrize('key', ['rate', 'rate_per_hour'])
def test_a_rate_next_to_nothing_is_refused(key):
    with pytest.raises(ConfigurationError, match='{}: got 1e-322; allowed: a number in 1e-'.format(key)):
        read_arrivals([{'place': 'dock', key: 1e-322}], PLACES, 'x')


def test_what_repeats_next_to_never_comes_once():
    simulation, beats = Simulation(), []
    simulation.series(0, 1e-322, lambda due_ns, _now_ns: beats.append(due_ns)).start(0)
    simulation.advance(10 ** 18)
    assert beats == [0]


def test_a_spread_next_to_nothing_is_none():
    world = {'places': [{'name': 'dock', 'duration': 5.0, 'duration_distribution': 'gamma', 'duration_cv': 5e-324}],
             'arrivals': [{'place': 'dock', 'rate': 1.0, 'count': 1}]}
    assert [task.duration_ns for task in make_scenario(world).tasks()] == [5 * S]


@pytest.mark.parametrize('key', ['robots', 'defaults', 'zones', 'places', 'arrivals'])
@pytest.mark.parametrize('value', [0, False, ''])
def test_nothing_is_not_taken_for_an_empty_list(key, value):
    with pytest.raises(ConfigurationError, match='got {!r}; allowed: a '.format(value)):
        make_scenario({key: value})
    assert not Fleet(make_scenario({key: None})).names


def test_a_time_that_nobody_can_count_with_is_refused_with_its_line(tmp_path):
    path = tmp_path / 'log.jsonl'
    path.write_text(HEAD + '{"time_ns":1' + 400 * '0' + ',"robot":"a","kind":"stands","values":[]}\n')
    with pytest.raises(EventLogError, match='log.jsonl:2: must hold time_ns .a whole number of 64 bits'):
        read_recording(str(path))
    text = '# {}time_ns,robot,kind,values\n1{},a,k,[]\n'.format(HEAD, 400 * '0')
    with pytest.raises(EventLogError, match='a.csv:3: must hold time_ns .a whole number of 64 bits'):
        list(EventLog(text.splitlines(True), 'a.csv'))
    log = EventLog([HEAD.replace('"start_ns":0', '"start_ns":1' + 400 * '0')], 'a')
    assert (list(log), log.start_ns) == ([], 0)


def test_so_is_one_in_the_record_of_a_charge(tmp_path):
    path = tmp_path / 'charge.jsonl'
    path.write_text('{"time_ns":1,"cost_ns":1' + 400 * '0' + '}\n')
    with pytest.raises(ConfigurationError, match='line 1: not a record of a charge .got a whole number of about 401'):
        charge.make_charge('replay:' + str(path), None, None)
