"""The report on an experiment in Chromium: it is not wider than the screen."""
import experiment_folder
from move_base_abstract_experiments.report import command
from move_base_abstract_experiments.report.parts import Section

HEADING = 'Maps of one trial: ROS, lockstep, auction, dynamic sampling, seed 0'


def sections(_tables):
    """Return a section whose heading is wider than a telephone."""
    return [Section(HEADING, ('A text.',))]


def test_a_report_is_no_wider_than_a_telephone(browser, tmp_path):
    experiment_folder.write(tmp_path, {'robots': [1, 2], 'allocation': ['nearest', 'auction']}, 3,
                            lambda configuration, seed: {'makespan_s': 10.0 * configuration['robots'] + seed,
                                                         'goals': 3}, report=f'{__name__}:sections')
    browser.open(command.write(tmp_path)[0], 320, 800, ready="document.readyState === 'complete'")
    assert HEADING in browser.run('return document.body.textContent')
    assert browser.run('return document.documentElement.scrollWidth') <= 320
