"""What a participant sees of its own changes is what the ROS master makes of them."""
import copy

import pytest
from hypothesis import given, strategies as st

from move_base_abstract.lockstep.parameters import MISSING, PendingParameters, in_order, search

paramserver = pytest.importorskip('rosmaster.paramserver')

_WORDS = st.sampled_from(['a', 'b', 'ab'])
_NAMES = st.lists(_WORDS, min_size=1, max_size=3).map(lambda words: '/' + '/'.join(words))
_VALUES = st.recursive(st.integers(0, 9), lambda below: st.dictionaries(_WORDS, below, max_size=2), max_leaves=4)
_CHANGES = st.lists(st.tuples(_NAMES, st.one_of(st.just(MISSING), _VALUES)), max_size=5)


class _Master:
    """The ROS master's own parameters."""

    def __init__(self, changes=()):
        self.server = paramserver.ParamDictionary(None)
        for name, value in changes:
            self.change(name, value)

    def change(self, name, value):
        try:
            if value is MISSING:
                self.server.delete_param(name)
            else:
                self.server.set_param(name, copy.deepcopy(value))
        except (KeyError, TypeError):  # of what is below a number, which is not there
            pass

    def get(self, name):
        try:
            return copy.deepcopy(self.server.get_param(name))
        except KeyError:
            return MISSING


@given(_CHANGES, _CHANGES, st.one_of(_NAMES, st.just('/')))
def test_own_changes_are_seen_as_the_ros_master_will_have_them(before, own, asked):
    now, later, pending = _Master(before), _Master(before), PendingParameters()
    for name, value in own:
        if value is not MISSING:
            pending.set(name, value)
        elif later.get(name) is not MISSING:  # else the ROS master refuses it
            pending.delete(name)
        later.change(name, value)
    wanted = later.get(asked)
    assert pending.seen(asked, now.get(asked)) == wanted
    assert pending.concern(asked) or now.get(asked) == wanted
    assert sorted(pending.names(now.server.get_param_names())) == sorted(later.server.get_param_names())
    for _ in range(len(own)):
        if pending:
            pending.first_is_told()
    assert not pending and pending.seen(asked, wanted) == wanted


@given(_CHANGES, _NAMES, st.one_of(_NAMES, _NAMES.map(lambda name: name[1:])))
def test_an_upward_search_finds_what_the_ros_master_finds(there, namespace, key):
    master = _Master(there)
    assert search(namespace, key, master.server.has_param) == master.server.search_param(namespace, key)


def test_what_is_handed_out_and_in_stays_apart():
    pending, given_in = PendingParameters(), {'list': [1], 'tree': {'x': 1}}
    pending.set('/a', given_in)
    seen = pending.seen('/a', MISSING)
    seen['tree']['x'] = 2
    assert pending.seen('/a/tree/x', MISSING) == 1


def test_trees_are_in_the_order_of_their_keys():
    assert list(in_order({'b': 1, 'a': {'d': 1, 'c': [{'f': 1, 'e': 2}]}})) == ['a', 'b']
    assert list(in_order({'a': [{'f': 1, 'e': 2}]})['a'][0]) == ['e', 'f']
