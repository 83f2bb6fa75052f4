import csv

import numpy as np
import pytest

from soil_mapping.ground_truth.field import load_field
from soil_mapping.mesa_models.mesa_published import greedy_path
from soil_mapping.results.comparison import bootstrap_interval

pytest.importorskip('mesa', reason='Mesa is not installed; it needs Python 3.11')
from soil_mapping.mesa_models.mesa_published import run_published_trial  # noqa: E402

COLUMNS = {'samples': 'Total cells sampled', 'distance': 'Total distance travelled', 'idle': 'Total idle time',
           'waiting': 'Total waiting time', 'task_time': 'Average time to complete a task', 'rmse': 'RMSE',
           'variance': 'Average Variance'}
FILES = {('ssi', 'random'): 'SSI_RS.csv', ('rr', 'dynamic'): 'RR_DS.csv'}
TRIALS = range(1, 11)


@pytest.fixture(scope='module')
def published(data_folder):
    """Return the published figures by configuration: a list of trials."""
    tables = {}
    for configuration, name in FILES.items():
        with open(data_folder / 'mesa_published_100_steps' / name, newline='', encoding='utf-8') as stream:
            tables[configuration] = [{own: float(row[theirs]) for own, theirs in COLUMNS.items()}
                                     for row in csv.DictReader(stream)]
    return tables


@pytest.fixture(scope='module')
def ours(compaction_source):
    truth = load_field(compaction_source, 2).values
    return {configuration: [run_published_trial(truth, *configuration, trial) for trial in TRIALS]
            for configuration in FILES}


def test_trials_that_no_tie_decides_come_out_as_published(published, ours):
    for configuration, trials in ((('ssi', 'random'), TRIALS), (('rr', 'dynamic'), (3, 4, 5, 6, 7))):
        for trial in trials:
            expected, got = published[configuration][trial - 1], ours[configuration][trial - 1]
            for name in ('samples', 'distance', 'idle', 'waiting'):
                assert got[name] == expected[name], (configuration, trial, name)
            assert got['task_time'] == pytest.approx(expected['task_time'], rel=1e-12)
            assert got['rmse'] == pytest.approx(expected['rmse'], rel=1e-4)
            assert got['variance'] == pytest.approx(expected['variance'], rel=1e-3)


def test_a_long_trial_comes_out_as_the_published_program_gives_it(compaction_source):
    """In trial 1 a random task falls on a cell that has had one: how it is drawn anew decides all that follows."""
    truth = load_field(compaction_source, 2).values
    got = run_published_trial(truth, 'ssi', 'random', 1, steps=240)
    assert (got['samples'], got['distance'], got['idle']) == (19, 689, 28)
    assert got['task_time'] == pytest.approx(34.43809523809524, rel=1e-12)
    assert got['rmse'] == pytest.approx(8.5005157, rel=1e-4)


def test_no_mean_differs_from_the_published_one(published, ours):
    comparisons = len(FILES) * len(COLUMNS)
    for configuration in FILES:
        for name in COLUMNS:
            interval = bootstrap_interval([trial[name] for trial in published[configuration]],
                                          [trial[name] for trial in ours[configuration]], comparisons)
            assert interval[0] <= 0.0 <= interval[1], (configuration, name, interval)


def test_paths_are_as_long_as_the_longer_side_where_nothing_is_in_the_way():
    weights = np.ones((30, 20), dtype=int)
    path = greedy_path(weights, (2, 3), (25, 11))
    assert (path[0], path[-1], len(path)) == ((2, 3), (25, 11), 24)
    assert all(max(abs(a[0] - b[0]), abs(a[1] - b[1])) == 1 for a, b in zip(path, path[1:]))
    assert greedy_path(weights, (4, 4), (4, 4)) == [(4, 4)]


def test_paths_prefer_light_cells_at_equal_estimates():
    weights = np.ones((10, 10), dtype=int)
    weights[3:6, 3:6] = 5
    path = greedy_path(weights, (0, 4), (9, 4))
    assert path[-1] == (9, 4)
    assert not any(3 <= x < 6 and 3 <= y < 6 for x, y in path)
