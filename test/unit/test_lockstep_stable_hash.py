"""Objects that are hashed by number: equal where Python says so, unlike any other object, and gone without a trace."""
import copy
import enum
import gc
import pickle
import threading
import weakref
from abc import ABC
from dataclasses import dataclass
from typing import Generic, NamedTuple, TypeVar

import pytest

from move_base_abstract.lockstep import stable_hash
from move_base_abstract.lockstep.stable_hash import Address, Numbered, bases_of, is_hashed_by_address, number_classes


def made(*bases, **body):
    """Return a class as the launcher makes one of a program's."""
    return type('Made', bases_of(*bases), body)


class Robot(*bases_of()):
    def __init__(self, name=''):
        self.name = name


class Pair(NamedTuple):
    first: object
    second: object


@dataclass(frozen=True)
class Frozen:
    first: object
    second: object


KEPT = Robot()


def print_():
    pass


def test_hashes_count_up_and_stay():
    robots = [Robot() for _ in range(5)]
    hashes = [hash(robot) for robot in reversed(robots)]
    assert hashes == list(range(hashes[0], hashes[0] + 5))
    assert [hash(robot) for robot in reversed(robots)] == hashes
    assert not is_hashed_by_address(robots[0])


def test_classes_of_a_library_are_numbered_and_others_that_it_names_are_not():
    class_ = 'class {}:\n  def __eq__(self, _other): return False\n  def __hash__(self): return 5\n'
    text = ('import fractions, threading\nfrom fractions import Fraction\nclass A:\n  class B:\n    pass\n'
            'A.again = A.B\nA.B.up = A\n'
            'class C(Exception): pass\nclass D(type): pass\nclass E:\n  __slots__ = ()\nLock = threading.RLock\n'
            'class G:\n  def __repr__(self): return "g"\n') + class_.format('F')
    names = {'__name__': 'a_library'}
    exec(text, names)
    number_classes('a_library', names)
    assert [is_hashed_by_address(names[name]()) for name in 'ACEFG'] == [
        False, True, True, False, False]
    assert not is_hashed_by_address(names['A'].B()) and hash(names['F']()) == 5
    assert (repr(names['G']()), repr(names['A']())[:28]) == ('g', '<a_library.A object at 0x000')
    assert names['Fraction'].__hash__ is not Numbered.__hash__


def test_an_address_that_is_kept_as_a_key_is_known():
    assert is_hashed_by_address(Address(5)) and not is_hashed_by_address(5)


def test_an_object_that_is_gone_leaves_nothing_and_its_place_gets_a_new_number():
    before = len(stable_hash._numbers)
    numbers = set()
    for _ in range(50):  # at one address, most likely
        numbers.add(hash(Robot()))
    assert len(numbers) == 50
    assert len(stable_hash._numbers) == before
    one = Robot()
    one.itself = one
    hash(one)
    del one
    gc.collect()
    assert len(stable_hash._numbers) == before


def test_objects_look_and_compare_as_ever():
    one, other = Robot('a'), Robot('a')
    assert one != other and one == one and len({one, other, one}) == 2
    assert vars(one) == {'name': 'a'} and Robot.__eq__ is object.__eq__
    assert '__hash__' not in vars(Robot)
    assert hash(copy.copy(one)) != hash(one) and one not in copy.deepcopy({one: 1})
    again = pickle.loads(pickle.dumps(one))
    assert vars(again) == vars(one) and hash(again) != hash(one)
    assert weakref.WeakSet([one, other]) == weakref.WeakSet([other, one])


def test_who_says_how_it_is_compared_or_hashed_is_left_to_it():
    def equal(self, other):
        return True

    with pytest.raises(TypeError, match='unhashable'):
        hash(made(__eq__=equal)())
    with pytest.raises(TypeError, match='unhashable'):
        hash(dataclass(made())())
    assert hash(made(__eq__=equal, __hash__=lambda self: 7)()) == 7
    frozen = dataclass(frozen=True)(made(__annotations__={'x': int}, x=0))
    assert frozen(3) == frozen(3) and hash(frozen(3)) == hash(frozen(3)) and len({frozen(3), frozen(3)}) == 1
    apart = dataclass(eq=False)(made(__annotations__={'x': int}, x=0))
    assert apart(3) != apart(3) and not is_hashed_by_address(apart(3))


@pytest.mark.parametrize('base', [dict, list, int, str, tuple, set, Exception, KeyError, enum.Enum, type, weakref.ref])
def test_bases_that_are_hashed_otherwise_or_by_rules_of_their_own_stay_alone(base):
    assert bases_of(base) == (base,)


def test_bases_that_are_not_classes_stay_as_they_are():
    kind = Generic[TypeVar('T')]
    assert bases_of(kind) == (kind,)
    assert bases_of(NamedTuple) == (NamedTuple,)


def test_it_goes_with_bases_of_all_kinds():
    assert made(object).__mro__[1:] == (Numbered, object)
    assert made(ABC).__mro__[1:] == (ABC, Numbered, object)
    assert issubclass(made(threading.Thread), threading.Thread)
    assert made(Robot).__mro__[1:] == (Robot, Numbered, object)
    assert made(Robot, dict).__mro__[1:] == (Robot, Numbered, dict, object)
    with pytest.raises(TypeError, match='unhashable'):
        hash(type('Odd', (dict, Robot), {})())  # as without it: dict comes first
    assert made(Robot, Exception)('x').args == ('x',)
    assert made(made(), made(), object) is not None


def test_an_object_is_shown_by_its_number_where_its_class_says_nothing_else():
    one = Robot()
    assert repr(one) == str(one) == '<{}.Robot object at 0x{:012x}>'.format(__name__, hash(one))
    assert repr(made(__repr__=lambda self: 'me')()) == 'me'
    assert repr(dataclass(made(__annotations__={'x': int}))(3)) == 'Made(x=3)'
    assert repr(made(__eq__=lambda self, other: True)()).startswith('<')  # which cannot be hashed


def test_slots_leave_no_room_for_a_number():
    kind = made(__slots__=('x',))
    assert not hasattr(kind(), '__dict__') and is_hashed_by_address(kind())
    one = kind()
    assert hash(one) == object.__hash__(one)
    assert repr(one) == object.__repr__(one) and f'at {id(one):#x}' in repr(one)
    assert not is_hashed_by_address(made(kind)())
    assert not is_hashed_by_address(made(__slots__=('x', '__weakref__'))())


@pytest.mark.parametrize('one', [object(), len, lambda: 0, threading.Lock(), threading.Thread(), [].append, int,
                                 (1, object()), frozenset([len]), Robot().__str__, Pair(1, len), Frozen(1, [].append),
                                 ..., weakref.ref(print_)])
def test_what_is_hashed_by_its_address(one):
    assert is_hashed_by_address(one)


@pytest.mark.parametrize('one', [1, 2.5, 'a', (1, 'a'), frozenset('ab'), enum.Enum('E', 'a').a, True,
                                 Pair(1, Robot()), Frozen(1, Robot()),
                                 Frozen('x', (1, 2)), weakref.ref(KEPT)])
def test_what_is_not(one):
    assert not is_hashed_by_address(one)
