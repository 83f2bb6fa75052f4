"""Each row that an event makes is of one of the kinds that stand with the event, from which pages and checks come."""
import ast
import gc
import inspect
import textwrap

import pytest

from move_base_abstract.fleet import robot_rows
from move_base_abstract.goals.events import WRITTEN
from move_base_abstract.orders import rows as order_rows
from move_base_abstract.runs.trace import FLAT, Rows


def kinds_in(made_by):
    """Return the kinds of the rows (time_ns, robot, kind, ...) in the source of a function."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(made_by)))
    made = [tuple_.elts[2] for tuple_ in ast.walk(tree) if isinstance(tuple_, ast.Tuple) and len(tuple_.elts) > 2
            and 'time_ns' in vars(tuple_.elts[0]).values()]
    return {one.value for kind in made for one in (kind, getattr(kind, 'body', None), getattr(kind, 'orelse', None))
            if isinstance(one, ast.Constant)}


@pytest.mark.parametrize('event', [event for event in WRITTEN if hasattr(event, 'row')])
def test_an_event_makes_rows_of_the_kinds_that_stand_with_it(event):
    assert kinds_in(event.row) == {one.kind for one in WRITTEN[event]}


def test_no_kind_is_there_twice():
    kinds = [one.kind for one in (*robot_rows.ROW_KINDS, *order_rows.ROW_KINDS)]
    assert len(set(kinds)) == len(kinds) and set(FLAT) < set(kinds)


@pytest.mark.parametrize('collects', [True, False])
def test_reading_rows_leaves_the_garbage_collector_as_it_was(collects):
    rows = Rows()
    rows.take((1, 'bot', 'held', 'a reason'))
    was = gc.isenabled()
    (gc.enable if collects else gc.disable)()
    try:
        assert rows.read() == [(1, 'bot', 'held', ('a reason',))]
        assert gc.isenabled() is collects
        assert rows.read() == []
    finally:
        (gc.enable if was else gc.disable)()
