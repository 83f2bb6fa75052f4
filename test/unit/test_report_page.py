"""The report's page on experiments of all shapes: whole, readable, nothing of others as markup, the same every time."""

import html.parser
import json
import sys
import types

import pytest

from experiment_folder import plain, write
from move_base_abstract_experiments.report import command, outcome, page
from move_base_abstract_experiments.report.parts import Cell, Html, Section, Table, figure_of

VOID = {'meta', 'circle', 'path', 'line', 'br', 'rect', 'use'}
NASTY = '<script>alert(1)</script> & "Größe" \' 日本'


class Reader(html.parser.HTMLParser):
    """Checks that tags are closed in their order; keeps the text, the links and what loads something."""

    def __init__(self):
        super().__init__()
        self.open, self.ids, self.links, self.sources, self.text, self.tags = [], [], [], [], [], []

    def handle_starttag(self, tag, attributes):
        about = dict(attributes)
        self.tags.append(tag)
        self.ids += [about['id']] if 'id' in about else []
        self.links += [about['href']] if tag == 'a' and 'href' in about else []
        self.sources += [value for name, value in attributes if name in ('src', 'xlink:href')]
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.tags.append(tag)

    def handle_endtag(self, tag):
        if tag not in VOID:
            assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open[-1:] != ['style']:
            self.text.append(data)


def report(folder, *arguments, **options):
    """Write an experiment and its report; return the page's Reader, with its text on one line."""
    write(folder, *arguments, **options)
    text = command.write(folder)[0].read_text(encoding='utf-8')
    reader = Reader()
    reader.feed(text)
    assert reader.open == [] and len(set(reader.ids)) == len(reader.ids)
    assert all(link.startswith('#') and link[1:] in reader.ids or (folder / link).exists() for link in reader.links)
    assert all(source.startswith('#') for source in reader.sources)
    assert 'script' not in reader.tags and 'link' not in reader.tags and 'url(' not in text.replace('url(#', '')
    assert 'nan' not in reader.text
    reader.said = plain(' '.join(' '.join(reader.text).split()))
    return reader


def spread(configuration, replication):
    """Return a number in 0..1 that looks like chance and is none."""
    return (hash_of(f'{sorted(configuration.items())}{replication}') % 1000) / 1000.0


def hash_of(text):
    return sum((place + 7) * ord(sign) ** 2 for place, sign in enumerate(text)) * 7919


def usual(configuration, replication):
    late = 12.0 * (configuration.get('method') == 'greedy')
    chance = 5.0 * spread({}, replication) + spread(configuration, replication)
    return {'makespan_s': 600.0 + late + chance, 'goals': 40}


def test_findings_come_first_then_what_was_run_then_each_metric(tmp_path):
    said = report(tmp_path, {'method': ['greedy', 'auction'], 'robots': [2, 8]}, 10, usual).said
    said = said.split('Provenance', 1)[1]  # behind the list of contents
    order = [said.index(text) for text in (
        'auction − greedy: ', 'Trials complete', 'Makespan [s]', 'Goals reached [goals]',
        'Trials worth a look', 'Repeatability', 'Provenance')]
    assert order == sorted(order)
    assert 'makespan_s' not in said and '3,600 s simulated' in said and '40 of 40' in said


@pytest.mark.parametrize(('factors', 'replications', 'says'), [
    ({}, 1, ', 1 trial.'), ({}, 30, '95 % interval'), ({'robots': [2, 4]}, 1, 'no interval, so'),
    ({'a b': [1, 2], 'c': ['x', 'y'], 'd': [True, None], 'e': [0.5, 1.5, [1, 2]]}, 3, '24 configurations'),
    ({'speed': list(range(12)), 'method': ['p', 'q', 'r', 's', 't']}, 2, 'All 60 configurations')])
def test_designs_of_all_sizes_give_a_page(tmp_path, factors, replications, says):
    reader = report(tmp_path, factors, replications, usual)
    assert says in reader.said


@pytest.mark.parametrize(('measure', 'says'), [
    (lambda c, k: None, 'Trials of the plan that have not run yet: 8.'),
    (lambda c, k: {'status': 'failed', 'error': f'{NASTY}\nmore'}, NASTY),
    (lambda c, k: {'makespan_s': None, 'goals': 'many'}, 'No complete trial has a value'),
    (lambda c, k: {'makespan_s': float('nan'), 'goals': float('inf')}, 'No complete trial has a value'),
    (lambda c, k: {'makespan_s': 600, 'goals': 40}, '600 s in all 8 trials of all configurations'),
    (lambda c, k: {'makespan_s': 600 + k, 'goals': 40}, 'auction − greedy: 0 s (in every pair; 4 pairs)'),
    (lambda c, k: {'makespan_s': 1e300 * k, 'goals': 1e-300 * k}, 'Makespan'),
    (lambda c, k: {'status': 'complete', 'metrics': None, 'robots': 3, 'labels': 'x'}, 'No complete trial has a value'),
    (lambda c, k: {'status': 'complete', 'metrics': {'goals': 3, NASTY: k}}, NASTY.capitalize())])
def test_trials_of_all_kinds_give_a_page(tmp_path, measure, says):
    assert says in report(tmp_path, {'method': ['greedy', 'auction']}, 4, measure).said


def test_an_experiment_without_trials_gives_a_page(tmp_path):
    assert '0 trials complete of 0 planned' in report(tmp_path, {'method': []}, 0, usual, metrics={}).said


def test_what_others_write_is_text_and_no_markup(tmp_path):
    metrics = {NASTY: {'unit': '<i>', 'title': f'Time {NASTY}', 'better': 'lower'}}
    reader = report(tmp_path, {f'f {NASTY}': [NASTY, 'x' * 300, 'b']}, 6,
                    lambda c, k: {'status': 'complete', 'metrics': {NASTY: k + len(str(c))}, 'labels': [NASTY],
                                  'verified': 'different', 'difference': NASTY,
                                  'robots': {NASTY: {'moving_s': 1.0, NASTY: 2.0}}},
                    metrics=metrics, experiment=NASTY, until={'topic': NASTY}, provenance={NASTY: NASTY})
    assert reader.said.count(NASTY) > 15


def test_the_same_folder_gives_the_same_bytes_wherever_it_is(tmp_path):
    pages = []
    for name in ('one', 'two'):
        (tmp_path / name).mkdir()
        report(tmp_path / name, {'method': ['greedy', 'auction'], 'robots': [2, 8]}, 6, usual)
        pages.append({path.relative_to(tmp_path / name): path.read_bytes()
                      for path in sorted((tmp_path / name).rglob('*')) if path.is_file()})
        command.write(tmp_path / name)  # and a second time in its own place
        assert (tmp_path / name / 'report.html').read_bytes() == list(pages[-1].items())[
            [str(each) for each in pages[-1]].index('report.html')][1]
    assert pages[0] == pages[1]


@pytest.mark.parametrize(('until', 'says'), [
    ({'seconds': 3600.0, 'topic': None, 'idle': False}, '3,600 s simulated'), (None, 'until it ends'),
    ({'seconds': 60, 'topic': '/done', 'idle': True},
     '60 s simulated, or until a message on /done, or until all are idle'), ({}, 'until it ends'),
    ({'idle': False}, 'until it ends'), ({'topic': {'name': '/x'}}, 'until a message on {"name": "/x"}')])
def test_the_end_of_a_trial_is_told_in_words(until, says):
    assert page.until_text(until) == says


def test_failures_are_told_before_the_findings(tmp_path):
    said = report(tmp_path, {'method': ['greedy', 'auction']}, 10, lambda c, k: usual(c, k) if k else
                  {'status': 'failed', 'error': 'no map', 'attempts': 2}).said
    assert said.index('Trials that failed: 2 (10 % of those that have run)') < said.index('auction − greedy: ')
    assert '9 pairs' in said and 'no map' in said


def test_how_trials_ended_is_told_by_configuration_and_before_all_metrics(tmp_path):
    said = report(tmp_path, {'method': ['greedy', 'auction']}, 10, lambda c, k: {
        'status': 'failed', 'error': '/coordinator ended with SIGSEGV', 'ended_by': 'crash'}
        if c['method'] == 'greedy' and k < 9 else
        {'status': 'complete', 'metrics': usual(c, k), 'ended_by': 'idle'}).said
    said = said.split('Provenance', 1)[1]
    order = [said.index(text) for text in (
        'auction − greedy: −90 percentage points (95 % interval',
        'greedy 10 9 90 % (60 to 98 %) crash 9, idle 1', '/coordinator ended with SIGSEGV failed 9', 'Findings')]
    assert order == sorted(order)
    lines = (tmp_path / 'tables' / 'endings.csv').read_text().splitlines()
    assert lines[1].startswith('failed,yes/no,method,greedy,auction,') and len(lines) == 3


def test_the_primary_metric_stands_alone_and_the_rest_is_folded(tmp_path):
    report(tmp_path, {'method': ['greedy', 'auction']}, 6, usual, primary='goals')
    text = (tmp_path / 'report.html').read_text()
    shown, _, folded = text[text.index('id="findings"'):].partition('<summary>Other metrics</summary>')
    assert 'Goals reached' in shown and 'Makespan' not in shown and 'Makespan' in folded.partition('</details>')[0]


def test_what_the_limit_of_time_cut_off_has_no_mean_on_the_page(tmp_path):
    reader = report(tmp_path, {'method': ['greedy', 'auction']}, 6, lambda c, k: {
        'status': 'complete', 'metrics': {'makespan_s': 3000.0 + k}, 'ended_by': 'seconds' if k else 'idle'},
        metrics={'makespan_s': {'unit': 's', 'title': 'Makespan', 'better': 'lower', 'at_limit': 'lower_bound'}},
        until={'seconds': 3600, 'idle': True})
    assert 'Complete trials that the limit of time ended: 10.' in reader.said
    assert 'no mean: cut off by the limit of time' in reader.said and '(95 %' not in reader.said.partition('How')[0]
    assert (tmp_path / 'tables' / 'means.csv').read_text().splitlines()[1].startswith('makespan_s,s,greedy,6,,,,cut,')


def test_the_worst_trial_is_one_that_the_limit_of_time_cut_off(tmp_path):
    said = report(tmp_path, {}, 3, lambda c, k: {
        'status': 'complete', 'metrics': {'makespan_s': 3000.0 + 100.0 * k}, 'ended_by': 'idle' if k else 'seconds'},
        metrics={'makespan_s': {'unit': 's', 'title': 'Makespan', 'better': 'lower', 'at_limit': 'lower_bound'}},
        until={'seconds': 3600, 'idle': True}).said
    assert 'the only configuration worst 3,000 s or more 0 ' in said


def test_errors_of_complete_trials_are_told(tmp_path):
    said = report(tmp_path, {}, 3, lambda c, k: {'status': 'complete', 'metrics': {'goals': 40}, 'error':
                                                 'metrics: KeyError: x\nmore' if k == 1 else None}).said
    assert 'Complete trials with an error: 1,' in said and 'metrics: KeyError: x' in said


def test_the_verified_share_is_told_with_what_it_says(tmp_path):
    said = report(tmp_path, {}, 20, lambda c, k: {
        'status': 'complete', 'metrics': {}, 'verified': 'identical' if k < 18 else None}).said
    assert 'or by the numbers that a function returns: identical: 18 of 18. So at least 82.4 % of such trials' in said


def test_a_configuration_has_one_colour_on_the_whole_page(tmp_path):
    report(tmp_path, {'robots': [2, 8], 'method': ['greedy', 'auction']}, 6, usual)
    looks = page.analyse(outcome.read(tmp_path)).looks
    assert looks.colour_factor == 1 and looks.mark_factor == 0  # words first, numbers give the marks
    assert [looks.of_levels(levels) for levels in ((0, 0), (0, 1), (1, 0))] == [(0, 'circle'), (1, 'circle'),
                                                                               (0, 'square')]
    assert looks.of_level(1, 1).colour == 1 and looks.of_level(0, 1) == (None, 'square')


def test_worst_and_median_trials_lead_to_their_replay_or_their_log(tmp_path, monkeypatch):
    module = types.ModuleType('replay_stand_in')

    def write_page(logs, output):
        if '0003' in str(output):
            raise ValueError('no robots in it')
        output.write_text(f'replay of {logs[0].parent.name}')
    module.write_page = write_page
    monkeypatch.setitem(sys.modules, 'replay_stand_in', module)
    monkeypatch.setattr(command, 'REPLAY', 'replay_stand_in')
    reader = report(tmp_path, {'method': ['greedy']}, 3, lambda c, k: {'makespan_s': [610, 600, 620][k]})
    assert {'replays/0001-abc.html', 'trials/0003-abc/events.jsonl'} <= set(reader.links)
    assert (tmp_path / 'replays' / '0001-abc.html').read_text() == 'replay of 0001-abc'
    assert '0003-abc: no replay: no robots in it' in reader.said


def test_without_the_replay_links_lead_to_event_logs(tmp_path, monkeypatch):
    monkeypatch.setattr(command, 'REPLAY', 'there_is_no_such_module')
    reader = report(tmp_path, {}, 3, usual)
    assert 'trials/0001-abc/events.jsonl' in reader.links or 'trials/0002-abc/events.jsonl' in reader.links
    assert not (tmp_path / 'replays').exists()


def test_tables_have_all_digits_in_the_units_of_the_metrics(tmp_path):
    report(tmp_path, {'method': ['greedy', 'auction']}, 4, usual)
    lines = (tmp_path / 'tables' / 'means.csv').read_text().splitlines()
    assert lines[0] == ('metric,unit,factor.method,n,value,low_95,high_95,interval,sd,least,median,median_low,'
                        'median_high,most,skewed,cut')
    assert lines[1].startswith('makespan_s,s,greedy,4,61') and len(lines) == 5
    assert {path.name for path in (tmp_path / 'tables').glob('*.csv')} == {
        'means.csv', 'main_effects.csv', 'differences.csv', 'interactions.csv', 'robots.csv', 'endings.csv'}


def test_a_primary_metric_without_values_has_its_rows(tmp_path):
    report(tmp_path, {'method': ['greedy', 'auction']}, 2, usual, metrics={'goals': {}, 'late': {}}, primary='late')
    rows = [line.split(',') for line in (tmp_path / 'tables' / 'means.csv').read_text().splitlines()]
    assert [(row[0], row[3], row[4]) for row in rows[1:]] == [(name, '0', '') for name in ('late', 'goals')
                                                              for _ in range(2)]


def test_a_folder_without_trials_is_read_from_its_table(tmp_path):
    write(tmp_path, {'method': ['greedy', 'auction']}, 3, lambda c, k: None)
    (tmp_path / 'trials.csv').write_text('id,method,status,makespan_s,labels,error\n0001-abc,greedy,complete,600,,\n'
                                         '0002-abc,greedy,failed,,,boom\n')
    found = outcome.read(tmp_path)
    assert [trial.status for trial in found.trials] == ['complete', 'failed', *['not run'] * 4]
    assert found.trials[0].metrics['makespan_s'] == 600.0 and found.trials[1].error == 'boom'


def sections_of_a_study(tables):
    from matplotlib.figure import Figure as Drawing
    drawing = Drawing(figsize=(3, 2))
    drawing.subplots().plot([0, 1], [0, 1], color='black')
    assert list(tables.trials['id'])[:1] == ['0001-abc'] and 'p_holm' in tables.main_effects
    return Section('Maps & more', (f'About {NASTY}', Table('T', ('a', 'b'), (('1', Cell('x', '#findings')),), 'note'),
                                   figure_of(drawing, 'A line'), Html('<p id="own">kept</p>')))


def test_a_study_adds_sections_of_its_own(tmp_path):
    reader = report(tmp_path, {'method': ['greedy', 'auction']}, 3, usual,
                    report=f'{__name__}:sections_of_a_study')
    assert 'Maps & more' in reader.said and f'About {NASTY}' in reader.said and 'own' in reader.ids
    text = (tmp_path / 'report.html').read_text()
    assert 'currentColor' in text and '<dc:date>' not in text
    command.write(tmp_path)
    assert (tmp_path / 'report.html').read_text() == text
    command.write(tmp_path, with_own=False)
    assert 'Maps &amp; more' not in (tmp_path / 'report.html').read_text()


def test_modules_beside_the_experiments_file_are_found(tmp_path):
    (tmp_path / 'own_sections_of_a_test.py').write_text(
        'from move_base_abstract_experiments.report.parts import Section\n'
        'def made(tables):\n    return Section("Found", ("beside the file",))\n')
    said = report(tmp_path, {}, 3, usual, report='own_sections_of_a_test:made',
                  provenance={'folder': str(tmp_path)}).said
    assert 'beside the file' in said and str(tmp_path) not in sys.path


def broken_sections(tables):
    raise KeyError('rmse')


def wrong_sections(tables):
    return [Section('Odd', (3,))]


@pytest.mark.parametrize(('name', 'says'), [
    (f'{__name__}:broken_sections', "KeyError: 'rmse'"), (f'{__name__}:wrong_sections', 'a part must be a text'),
    ('no_such_module:f', 'No module named'), (f'{__name__}:none', 'has no attribute')])
def test_sections_that_cannot_be_made_do_not_take_the_report_with_them(tmp_path, name, says):
    said = report(tmp_path, {}, 3, usual, report=[name]).said
    assert 'They could not be made' in said and says in said


@pytest.mark.parametrize(('change', 'says'), [
    ({'trials': [{'id': 'a', 'replication': '0'}]}, "'replication' must be a whole number"),
    ({'trials': [{'id': 'a', 'seed': 10 ** 18}]}, 'replication and seed must be within'),
    ({'trials': [{'id': 'a', 'replication': 0}] * 2}, 'is planned twice'), ({'report': 'f'}, "'module:function'"),
    ({'smallest_difference': {'x': 0}}, 'must be a number above 0, got 0')])
def test_a_plan_that_cannot_be_used_is_an_error_that_says_why(tmp_path, capsys, change, says):
    write(tmp_path, {}, 1, usual)
    path = tmp_path / 'plan.json'
    path.write_text(json.dumps({**json.loads(path.read_text()), **change}))
    assert command.main([str(tmp_path)]) == 2
    assert says in capsys.readouterr().err and not (tmp_path / 'report.html').exists()


def test_no_folder_of_an_experiment_is_an_error(tmp_path, capsys):
    assert command.main([str(tmp_path)]) == 2
    assert 'plan.json: is not there' in capsys.readouterr().err
    (tmp_path / 'plan.json').write_text('[')
    assert command.main([str(tmp_path)]) == 2


def test_a_trial_of_another_plan_and_one_that_cannot_be_read_count_as_failed(tmp_path):
    write(tmp_path, {'method': ['greedy', 'auction']}, 2, usual)
    path = tmp_path / 'trials' / '0001-abc' / 'trial.json'
    path.write_text(json.dumps({**json.loads(path.read_text()), 'seed': 5}))
    (tmp_path / 'trials' / '0002-abc' / 'trial.json').write_text('{')
    found = outcome.read(tmp_path)
    assert [trial.status for trial in found.trials] == ['failed', 'failed', 'complete', 'complete']
    assert 'of another plan' in found.trials[0].error and 'cannot be read as JSON' in found.trials[1].error


@pytest.mark.parametrize('name', ['report.html', 'tables', 'tables/notes.txt'])
def test_what_the_program_did_not_make_stays(tmp_path, capsys, name):
    write(tmp_path, {}, 2, usual)
    if '/' in name:
        command.write(tmp_path)
    path = tmp_path / name
    path.write_text('mine')
    assert command.main([str(tmp_path)]) == 2
    assert path.read_text() == 'mine' and name.split('/')[0] in capsys.readouterr().err


def beyond(longer, begun=50):
    """Return what a trial of a robot with a calibration measures, ``longer`` of whose goals lay outside."""
    robot = {'goals': begun, 'goals_begun': begun, 'goals_beyond': longer, 'goals_beyond_longer': longer,
             'goals_beyond_shorter': 0, 'goals_beyond_turn': 0, 'goals_beyond_narrow': 1 if longer else 0}
    return {'status': 'complete', 'metrics': {'makespan_s': 100.0, 'goals': begun}, 'robots': {'r': robot}}


def test_what_lay_outside_of_recordings_is_said(tmp_path):
    for folder in ('some', 'none', 'plain'):
        (tmp_path / folder).mkdir()
    said = report(tmp_path / 'some', {'robots': [2, 4]}, 5, lambda c, k: beyond(12 if c['robots'] == 2 else 0)).said
    assert 'Calibrations were used beyond what they were fitted to: 12 % of goals were longer than any recorded leg ' \
        'and 1 % of goals passed nearer to what is occupied than any recorded leg.' in said
    assert '60 of 500' in said
    said = report(tmp_path / 'none', {'robots': [2, 4]}, 5, lambda c, k: beyond(0)).said
    assert 'beyond what they were fitted to' not in said
    assert 'Goals outside of what was recorded' in said and '0 of 500' in said
    said = report(tmp_path / 'plain', {'robots': [2, 4]}, 5, lambda c, k: {'makespan_s': 100.0, 'goals': 2}).said
    assert 'outside of what was recorded' not in said
