"""The report on properties: of how many trials each held, was broken or was not judged, and where first."""
import pytest

from experiment_folder import write
from move_base_abstract.properties import Broken, Judgement
from move_base_abstract.runs.built_in import BUILT_IN
from move_base_abstract_experiments.report import outcome, page
from move_base_abstract_experiments.report.sections import properties
from test_report_page import NASTY, report

KEYS = {kind: (kind, '/bad', text) for kind, text in (
    ('always', 'k stays small'), ('sometimes', 'k gets large'), ('never_again', 'k is odd'))}


def trial(*broken, judged=tuple(BUILT_IN), status='complete', stated=(), **others):
    """Return a trial.json with what is broken: (property, node, text, instant [ns])."""
    told = Judgement(tuple(Broken(name, instant_ns, node, text, ('k=3',)) for name, node, text, instant_ns in broken), {
        (node, kind, text): outcome for kind, node, text, outcome in stated}).told()
    return {'status': status, 'metrics': {'makespan_s': 1.0}, 'properties': {**told, 'judged': list(judged)}, **others}


def counted(folder, *trials):
    """Return {title of a property: (held, broken, id of the first trial that broke it)}."""
    write(folder, {}, len(trials), lambda _, replication: trials[replication])
    found = properties.counts(outcome.read(folder))
    return {each.key[0]: (each.held, each.broken, each.first and each.first[0].id) for each in found}


def test_each_property_is_counted_over_the_trials(tmp_path):
    found = counted(tmp_path, trial(), trial(('charged', 'r1', 'empty', 5)), trial(
        ('charged', 'r2', 'empty', 6), ('charged', 'r1', 'empty', 7), ('no_crash', '/a', 'exit code 3', None),
        status='failed', error='/a crashed'), None, {'makespan_s': 1.0}, trial(judged=['charged']))
    assert list(found) == list(BUILT_IN)
    assert found['charged'] == (2, 2, '0002-abc') and found['no_crash'] == (2, 1, '0003-abc')
    assert found['every_goal_ends'] == (3, 0, None)


def test_a_new_property_did_not_hold_in_trials_from_before_it(tmp_path, monkeypatch):
    monkeypatch.setitem(BUILT_IN, 'newer', BUILT_IN['charged']._replace(name='newer'))
    found = counted(tmp_path, trial(judged=['all']), trial(judged=['charged', 'newer']))
    assert found['charged'] == (2, 0, None) and found['newer'] == (1, 0, None)


def test_statements_count_where_they_were_made(tmp_path):
    stated = [(*KEYS['always'], 'stated'), (*KEYS['sometimes'], 'stated'), (*KEYS['never_again'], 'stated')]
    late = [(*KEYS['always'], 'broken'), (*KEYS['sometimes'], 'held')]
    found = counted(tmp_path, trial(judged=['always'], stated=stated), trial(), trial(
        (*KEYS['always'], 5), judged=['always'], stated=late))
    assert {name: found[name] for name in KEYS} == {
        'always': (1, 1, '0003-abc'), 'sometimes': (1, 0, None), 'never_again': (1, 0, None)}


def test_the_page_names_each_with_the_first_break(tmp_path):
    stated = [(*KEYS['sometimes'], 'stated'), ('sometimes', '/ok', 'it waits', 'held'), (*KEYS['always'], 'broken')]
    reader = report(tmp_path, {'robots': [2, 4]}, 3, lambda configuration, replication: trial(
        *([(*KEYS['always'], 5_000_000_000), ('charged', NASTY, 'its battery is empty', 2_500_000_000)]
          if configuration['robots'] == 4 and replication else []), stated=stated))
    said = reader.said
    assert said.index('Properties were broken: ') < said.index('Trials complete')
    assert 'always: k stays small (/bad) (in 2 trials): see Properties.' in said
    assert 'charged: no robot stands with an empty battery away from a charger 4 2 0 0005-abc 1001 2.5' in said
    assert 'always: k stays small (/bad) 0 2 4 0005-abc 1001 5 (k=3)' in said
    assert 'every_goal_ends: no goal is open when nothing is left that could happen 6 0 0 ' in said
    assert 'Came true in no trial: sometimes: k gets large (/bad).' in said
    assert 'sometimes: it waits (/ok) 6 0' in said
    assert 'trials/0005-abc/events.jsonl' in reader.links


@pytest.mark.parametrize('told', [None, {}, [], 3, {'broken': 3, 'statements': {}}, {
    'broken': [{}, 7, {'property': 'none'}, {'property': 'charged', 'instant_ns': 'x', 'details': 4}, {
        'property': [1]}],
    'statements': [[1, 2], ['/a', 'always', ['x'], {}], ['/a', ['always'], 'x', 'held'], 5], 'judged': [1, 'what']}])
def test_what_is_no_judgement_is_no_error(tmp_path, told):
    folder = write(tmp_path, {}, 2, lambda _, replication: trial(properties=told))
    experiment = outcome.read(folder)
    section = properties.section(experiment)
    assert (section is None) == (not isinstance(told, dict) or len(told) < 3)
    assert page.render(page.analyse(experiment), ())
