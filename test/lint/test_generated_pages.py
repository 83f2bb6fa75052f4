"""Pages are what the tables of the code make of them, and the time master's table is what it reads."""
import re
import sys
from pathlib import Path

import pytest

from move_base_abstract.config.robot_table import LIMITS, TABLE

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / 'tools'))

import draw_explanations  # noqa: E402
import write_node_pages  # noqa: E402
import write_options  # noqa: E402
import write_scenario_keys  # noqa: E402

TIME_MASTER = ROOT / 'src' / 'time_master' / 'parameters'
CPP = '\n'.join((TIME_MASTER / name).read_text() for name in ('parameters.h', 'chaos_parameters.h'))
SETTINGS = CPP + '\n'.join((ROOT / 'src' / path).read_text() for path in (
    'clock/time_master.h', 'clock/time_master.cpp', 'lockstep/rounds/settings.h'))
ROWS = {name: (kind, default, allowed) for name, kind, _, default, allowed, _ in write_node_pages.cpp_rows()}


@pytest.mark.parametrize('path', write_node_pages.pages(), ids=lambda path: path.name)
def test_the_page_is_up_to_date(path):
    assert path.read_text(encoding='utf-8') == write_node_pages.pages()[path], 'run tools/write_node_pages.py'


def test_every_parameter_has_a_sentence_and_a_row():
    page = (write_node_pages.NODES / 'move_base.md').read_text(encoding='utf-8')
    for parameter in (*LIMITS, *TABLE):
        assert re.search(rf'^\| `{parameter.name}` \| [A-Z][^|]*\. \|', page, re.MULTILINE), parameter.name


def test_a_parameter_without_a_sentence_is_refused():
    with pytest.raises(SystemExit, match='no sentence'):
        write_node_pages.table([write_node_pages.robot_table.Parameter('x', 0, None, 'anything')])


def test_the_time_masters_table_has_what_it_reads_and_nothing_else():
    read = re.findall(r'reader\.(?:read|choose)\(\s*"(\w+)"', CPP)
    assert len(read) > 40 and {*read, 'excluded_topics'} == set(ROWS)


def constant(text):
    """Return the number that a C++ expression is, names of constants looked up."""
    text = text.strip()
    if re.fullmatch(r'[\d.e+-]+', text):
        return float(text)
    found = re.search(r'\b{} = ([\d.e+-]+)'.format(text.rpartition('::')[2]), SETTINGS)
    return float(found.group(1)) if found else None


def test_the_defaults_of_the_time_masters_table_are_those_of_the_code():
    found = 0
    for name, member in re.findall(r'reader\.read\("(\w+)",\s*[\w.]*?(\w+)\)', CPP):
        default = re.search(rf'^  parameters\.master\.{member} = (k\w+);', CPP, re.MULTILINE) or re.search(
            rf'\b(?:double|int|bool) {member} = ([\w.+-]+);', SETTINGS)
        if default and constant(default.group(1)) is not None:
            found += 1
            assert float(ROWS[name][1]) == constant(default.group(1)), name
        elif default and default.group(1) in ('true', 'false'):
            found += 1
            assert ROWS[name][1] == default.group(1), name
    assert found >= 15


def test_the_drawings_are_up_to_date():
    for name, draw in draw_explanations.DRAWINGS.items():
        assert (draw_explanations.IMAGES / name).read_text(encoding='utf-8') == draw(), 'run tools/draw_explanations.py'


@pytest.mark.parametrize('page', write_options.TABLES)
def test_a_page_has_the_options_of_the_code(page):
    assert (Path(write_options.DOCS) / page).read_text(encoding='utf-8') == write_options.make_page(page), (
        'run tools/write_options.py')


def test_the_page_of_a_scenarios_keys_is_up_to_date():
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
    with pytest.raises(SystemExit, match='no page of docs/'):
        write_scenario_keys.page_of('no_such_key', ())


def test_a_key_is_told_on_the_page_of_what_it_sets():
    page = (ROOT / 'docs' / 'scenario_keys.md').read_text(encoding='utf-8')
    for key in ('start_x', 'start_y', 'start_yaw'):  # columns of a table bear these names on another page
        assert re.search(r'^\| `{}` .*\[move base\]\(nodes/move_base\.md\) \|$'.format(key), page, re.MULTILINE)
