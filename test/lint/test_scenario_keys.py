"""The page with all keys of a scenario is what the tables of the code make of it."""
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / 'tools'))

import write_scenario_keys  # noqa: E402


def test_the_page_is_up_to_date():
    page = (ROOT / 'docs' / 'scenario_keys.md').read_text(encoding='utf-8')
    assert page == write_scenario_keys.make_page(), 'run tools/write_scenario_keys.py'


def test_every_key_that_a_scenario_may_have_is_on_it():
    from move_base_abstract import scenario
    from move_base_abstract.config import robot_table
    from move_base_abstract.tasks import arrivals, places
    from move_base_abstract.traffic import zones
    page = write_scenario_keys.make_page()
    named = [*scenario._TOP_KEYS, *scenario._GROUP_KEYS, *robot_table.OWN_NAMES, *(one.name for one in zones.TABLE),
             *(parameter.name for parameter in places.PLACE_TABLE + arrivals.ARRIVAL_TABLE)]
    assert [name for name in named if f'| `{name}` |' not in page] == []


def test_a_key_of_which_no_page_tells_is_refused():
    try:
        write_scenario_keys.page_of('no_such_key', ())
    except SystemExit as error:
        assert 'no page of docs/' in str(error)
    else:
        raise AssertionError('it was taken')


def test_a_key_is_told_on_the_page_of_what_it_sets():
    page = (ROOT / 'docs' / 'scenario_keys.md').read_text(encoding='utf-8')
    for key in ('start_x', 'start_y', 'start_yaw'):  # columns of a table bear these names on another page
        assert re.search(r'^\| `{}` .*\[move base\]\(nodes/move_base\.md\) \|$'.format(key), page, re.MULTILINE)
