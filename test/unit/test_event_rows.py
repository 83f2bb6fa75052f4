"""Each kind of rows that an event makes is in the one table of kinds, from which pages and checks come."""
import ast
import inspect

import pytest

from move_base_abstract.fleet import robot_rows
from move_base_abstract.goals import events, traffic_events
from move_base_abstract.runs.trace import FLAT, KINDS, ROW_KINDS


@pytest.mark.parametrize('module', [events, traffic_events, robot_rows])
def test_each_row_has_its_kind_in_the_table(module):
    made = {tuple_.elts[2] for tuple_ in ast.walk(ast.parse(inspect.getsource(module)))
            if isinstance(tuple_, ast.Tuple) and len(tuple_.elts) > 2 and 'time_ns' in vars(tuple_.elts[0]).values()}
    kinds = {one.value for kind in made for one in (kind, getattr(kind, 'body', None), getattr(kind, 'orelse', None))
             if isinstance(one, ast.Constant) and isinstance(one.value, str)}
    kinds |= set(getattr(module, 'PLAIN_ROWS', {}).values())
    assert len(kinds) > 3 and not kinds - set(KINDS)


def test_no_kind_is_there_twice():
    assert len({row.kind for row in ROW_KINDS}) == len(ROW_KINDS) and set(FLAT) < set(KINDS)
