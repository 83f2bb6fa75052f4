"""Verify: which runs can be compared with each other, and what it is told of a run."""
from types import SimpleNamespace

import pytest

from move_base_abstract_ros.fleet.fleet_scenario import why_one_process
from move_base_abstract_ros.launching import verification
from move_base_abstract_ros.launching.conditions import CONDITIONS


@pytest.mark.parametrize('fleets, crashes, can, said', [
    ([['/fleet', ''], ['/b', '']], [], True, []), ([], [], False, []),
    ([['/fleet', '']], ['/fleet_watch crashed at 3.0 s: exit code 1'], True, []),
    ([['/a', ''], ['/fleet', '']], ['/fleet crashed at 3.0 s: exit code 1'], False, [
        'split: not run: in two processes a fleet has other names, and /fleet crashed at 3.0 s: exit code 1']),
    ([['/a', ''], ['/fleet', 'one process must count the robots in its zones']], [], False, [
        'split: not run: /fleet: one process must count the robots in its zones'])])
def test_a_fleet_that_crashed_or_counts_robots_is_not_compared_with_one_in_two_processes(
        tmp_path, fleets, crashes, can, said):
    told = []
    run = verification.Verification(None, [], [], str(tmp_path), 1.0, told.append)
    run.runs.append(SimpleNamespace(fleets=fleets, crashes=crashes))
    assert (run._can_split(), told) == (can, said)


def concluded(folder, names, events=1, bags=(), broken=()):
    """Return (exit code, lines) of a verification whose runs were equal, under these conditions."""
    told = []
    next_steps = {verification.LABELLED: 'look', verification.IDENTICAL: 'search'}
    verify = verification.Verification(None, [], next_steps, str(folder), 1.0, told.append)
    end = {'not_repeatable_because': [], 'degraded_because': []}
    verify.runs += [verification.Run(one, '', '', end, 4.0, events, 1, 1.0, str(folder / 'none'), dict.fromkeys(bags),
                                     [], [], list(broken)) for one in CONDITIONS if one.name in names]
    return verify._conclude(), told


def test_what_was_not_compared_is_not_called_identical(tmp_path):
    assert concluded(tmp_path, ['plain', 'again'], bags=['a'])[1][0] == (
        'identical: 2 runs (plain, again), 1 events and 1 messages each, and the same bytes in 1 bag')
    assert concluded(tmp_path, ['plain', 'again', 'split'], bags=['a', 'b'])[1][0] == (
        'identical: 3 runs (plain, again, split), 1 events and 1 messages each, and the same bytes in 2 bags; of split '
        'only the events')
    code, told = concluded(tmp_path, ['plain', 'split'], bags=['a'])
    assert (code, told[0]) == (verification.IDENTICAL, 'identical: 2 runs (plain, split), 1 events each; messages and '
                               'bags are not compared')
    code, told = concluded(tmp_path, ['plain', 'split'], events=0)
    assert code == verification.LABELLED and any('there was nothing to compare' in line for line in told)
    code, told = concluded(tmp_path, ['plain'])
    assert (code, told[0]) == (verification.LABELLED, 'nothing is compared: only one run was made (plain)')


def test_broken_properties_and_what_to_type_next_are_said(tmp_path):
    code, told = concluded(tmp_path, ['plain', 'again'], broken=['no robot waits'])
    assert (code, told[-2:]) == (verification.BROKEN, ['but broken: no robot waits', 'next: search'])
    code, told = concluded(tmp_path, ['plain', 'split'], events=0, broken=['no robot waits'])
    assert (code, told[-1]) == (verification.LABELLED, 'next: look')


def test_events_and_messages_of_a_log_are_counted(tmp_path):
    log = tmp_path / 'events.jsonl'
    log.write_text('{"event_log":1}\n{"time_ns":1,"robot":"a","kind":"arrived","values":[]}\n'
                   '{"time_ns":2,"robot":"/a","kind":"message","values":["/a","/b",4,"00"]}\n'
                   '{"end":{"events":2,"at_ns":3000000000,"not_repeatable_because":[],"degraded_because":[]}}\n')
    assert verification._read_end(str(log))[1:] == (3.0, 1, 1)


def test_bags_are_numbered_by_their_nodes():
    assert verification._by_number([['/a', 'x'], ['/b', 'y'], ['/a', 'z: 1\n']]) == {
        ('/a', 1): 'x', ('/b', 1): 'y', ('/a', 2): 'z: 1\n'}


@pytest.mark.parametrize('below, why', [
    ({'/robots': [{'name': 'a'}]}, ''), ({}, ''), ({'': 3}, ''),
    ({'/robots': [{'name': 'a'}], '/defaults/max_speed': 2.0}, ''),
    ({'/robots': [{'name': 'a'}], '/robots/x': 1, '/defaults': 3, '/defaults/max_speed': 2.0}, 'a list of robots'),
    ({'/robots': [{'name': 'a'}], '/zones': [{'name': 'z', 'capacity': 1, 'polygon': [[0, 0], [1, 0], [1, 1]]}]},
     'one process must count the robots in its zones'),
    ({'/robots': [{'name': 'a'}], '/places': [{'name': 'dock', 'x': 1.0, 'y': 2.0, 'capacity': 1}]},
     'in its places'),
    ({'/robots': [{'name': 'a', 'calibration': 'move_base_dwa_stage'}], '/encounters': 'calibrated'},
     'in its encounters'),
    ({'/robots': [{'name': 'a', 'count': 2}], '/defaults': {'driven_by': 'velocities'}}, 'stop one another only in'),
    ({'/robots': [{'name': 'a', 'driven_by': 'velocities'}, {'name': 'b'}]}, ''),
    ({'/scenario': '/nowhere/at_all.yaml'}, 'at_all.yaml')])
def test_why_a_fleet_stays_in_one_process_follows_from_its_parameters(below, why):
    params = {'/fleet' + key: value for key, value in below.items()}
    found = why_one_process({**params, '/fleet2/zones': 7, '/other': 'x'}, '/fleet')
    assert (why in found and bool(found)) if why else found == ''
