"""Finds loops of a program that may wait by looking at variables, and makes them report what each of their turns does.

``while len(frontiers) < 1: pass`` calls nothing of ROS, so lockstep would not know that it waits. So a loop that can go
round without computing calls :data:`LOOK` in each turn, with its kind and its line, and :data:`ACT` before statements
that do more than look. The text of the program decides:

- Tests look. So do calls of functions that are known to return something and to change nothing.
- Other calls may compute, or look: ``while not self.ready(): pass``. A function of the same module that can return
  without computing calls ACT before it does more than look. Whether a call reaches such a function is known only when
  it is made, so the function that is called is handed to :data:`CALLED`.
- A statement computes if it stores in objects (``self.x = ...``, ``a[i] = ...``), deletes, counts (``n += 1``), or
  stores in a name a value that is made from that name (``node = node.parent``). If the end of a loop depends on
  nothing that the loop stores, another thread must end it (``while not self.stop: n += 1``), or it never ends.

This module only knows Python's text: no ROS, no threads, no clock.
"""
from __future__ import annotations

import ast
from typing import Any, Callable, Container, Dict, Iterable, Iterator, List, Mapping, Optional, Sequence, Set, Tuple

#: kinds of loops: its turns may only look (WAITS), and look at the time, too (TIMES); each turn calls something that
#: may compute (CALLS); each turn computes, but nothing on which the loop's end depends (COMPUTES)
WAITS, TIMES, CALLS, COMPUTES = 0, 1, 2, 3
#: names of the functions that loops call, which must be builtins: ``LOOK(kind, line)``, ``ACT(computes)`` and
#: ``CALLED(function, is_known)``, which returns the function; is_known: whether functions of this name only look
LOOK, ACT, CALLED = '__lockstep_look__', '__lockstep_act__', '__lockstep_called__'
_IS_KNOWN = '_lockstep_is_known'  # the attribute of a call that may reach a function of the module

_FUNCTIONS = frozenset((
    LOOK, ACT,
    'abs', 'all', 'any', 'bool', 'dict', 'enumerate', 'float', 'getattr', 'hasattr', 'int', 'isinstance', 'len', 'list',
    'max', 'min', 'print', 'range', 'repr', 'reversed', 'round', 'set', 'sorted', 'str', 'sum', 'tuple', 'type', 'zip'))
_METHODS = frozenset((
    'canTransform', 'can_transform', 'done', 'empty', 'endswith', 'format', 'frameExists', 'full', 'get',
    'get_comm_state', 'get_goal_status', 'get_goal_status_text', 'get_nowait', 'get_num_connections', 'get_result',
    'get_state', 'is_active', 'is_alive', 'is_new_goal_available', 'is_preempt_requested', 'is_set', 'is_shutdown',
    'isSet', 'items', 'keys', 'locked', 'qsize', 'running', 'sched_yield', 'startswith', 'to_nsec', 'to_sec',
    'total_seconds', 'values'))
#: methods that only look if their time-out is 0 s
_WAITS = frozenset(('get', 'join', 'wait', 'wait_for_result', 'wait_for_server'))
_NOT_OF_ROSPY = frozenset(('Publisher', 'Subscriber', 'Service', 'ServiceProxy', 'Timer', 'set_param', 'delete_param',
                           'init_node', 'signal_shutdown', 'on_shutdown'))
_TIMES = frozenset(('now', 'get_time', 'get_rostime'))
_WITH_BLOCKS = (ast.If, ast.While, ast.For, ast.With, ast.Try)
_SIMPLE = (ast.Pass, ast.Break, ast.Continue, ast.Return, ast.Raise, ast.Assert, ast.Expr, ast.Global, ast.Nonlocal)
_ASSIGNMENTS = (ast.Assign, ast.AnnAssign)
_COMPUTING = (ast.Await, ast.Yield, ast.YieldFrom)


def instrument(tree: ast.Module) -> Tuple[ast.Module, Dict[Tuple[str, int], bool]]:
    """Make the waiting loops of a module's ``tree`` (of :func:`ast.parse`) call :data:`LOOK` and ACT.

    Return the tree, and {(name, line): whether it can return without computing} of the functions that these loops may
    call. If it can, it calls ACT before it does more than look. The calls that may reach these functions are noted for
    :func:`hand_over_called`.
    """
    named: Dict[str, List[ast.FunctionDef]] = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef) and not node.decorator_list:
            named.setdefault(node.name, []).append(node)
    loops = [_Loop(node, named) for node in ast.walk(tree) if isinstance(node, ast.While)]
    functions: Dict[str, List[_Function]] = {}

    def called_by(name: str) -> Set[str]:
        functions[name] = [_Function(node, named) for node in named[name]]
        return set().union(*(one.called for one in functions[name]))
    for _ in _reached((name for loop in loops if loop.kind is not None for name in loop.called), called_by):
        pass
    for part in (*loops, *(one for ones in functions.values() for one in ones)):
        part.instrument(functions)
    looking = {(name, one.line): one.may_look for name, ones in functions.items() for one in ones}
    return ast.fix_missing_locations(tree), looking


def hand_over_called(tree: ast.Module) -> ast.Module:
    """Hand the functions that loops call, and that may be the module's, to :data:`CALLED`; return the tree.

    This comes after all that looks for the names of what is called.
    """
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and hasattr(node, _IS_KNOWN):
            is_known = ast.Constant(value=getattr(node, _IS_KNOWN))
            handed = ast.Call(func=ast.Name(id=CALLED, ctx=ast.Load()), args=[node.func, is_known], keywords=[])
            node.func = ast.copy_location(handed, node.func)
            delattr(node, _IS_KNOWN)
    return ast.fix_missing_locations(tree)


class _Part:
    """A part of a program, with what it may do.

    named: the names of functions of the module that a call may reach. ``called``: those that the part calls. ``times``:
    whether it looks at the time.
    """

    _leaves: Any  # the statement that ends a turn

    def __init__(self, part: Any, named: Container[str]) -> None:
        self._flow = _flow(part)
        self._acts: List[Any] = []  # (list of statements, one of them, whether it computes)
        self._named = named
        self._shared: Set[str] = set()  # names whose stores others see
        self.called: Set[str] = set()
        self.times = False

    def instrument(self, functions: Mapping[str, Sequence[_Part]]) -> None:
        """Add the calls to the part's text; functions: the parts that the names of called functions stand for."""
        raise NotImplementedError

    def _insert_acts(self) -> None:
        for block, statement, computes in self._acts:
            block.insert(block.index(statement), _call(ACT, [computes], statement))

    def _block(self, block: List[Any]) -> bool:
        """Check statements that follow one another; return whether a turn may pass them without computing."""
        for number, statement in enumerate(block):
            if not self._statement(block, statement):
                self._acts.append((block, statement, True))
                return any(isinstance(part, self._leaves) for earlier in block[:number] for part in ast.walk(earlier))
        return True

    def _statement(self, block: List[Any], node: Any) -> bool:
        """Return whether a turn may pass a statement of a block without computing."""
        is_compound = isinstance(node, _WITH_BLOCKS)
        heads = _heads(node) if is_compound else list(ast.iter_child_nodes(node))
        if any(_yields(head) for head in heads) or not (is_compound or self._is_plain(node)):
            return False
        if isinstance(node, (ast.Return, ast.Raise)) and self._leaves is not ast.Return:
            return True  # no turn of the loop follows
        calls_unknown = [self._calls_unknown(head) for head in heads]  # for all heads, because this notes names, too
        if any(calls_unknown):
            self._acts.append((block, node, False))
        return not is_compound or self._passes(node)

    def _is_plain(self, node: Any) -> bool:
        """Return whether a statement without others in it stores nothing by which it would compute."""
        if not isinstance(node, _ASSIGNMENTS):
            return isinstance(node, _SIMPLE)
        targets = node.targets if isinstance(node, ast.Assign) else [node.target]
        names = [name for target in targets for name in _names(target)]
        return not any(name is None or name in self._shared or _is_made_from_itself(self._flow, name) for name in names)

    def _passes(self, node: Any) -> bool:
        """Return whether a turn may pass a statement with others in it without computing; check all of them."""
        body, orelse = self._block(node.body), self._block(getattr(node, 'orelse', []))
        if isinstance(node, ast.Try):
            handled = [self._block(handler.body) for handler in node.handlers]
            return self._block(node.finalbody) and (body and orelse or any(handled))
        if isinstance(node, ast.If):
            return body or orelse
        return body or not isinstance(node, ast.With)  # an inner loop may have no turn

    def _calls_unknown(self, node: Any) -> bool:
        """Return whether an expression calls a function that may compute; note whether it looks at the time."""
        calls = [part for part in ast.walk(node) if isinstance(part, ast.Call)]
        self.times = self.times or any(dotted(call.func)[-1:] and dotted(call.func)[-1] in _TIMES for call in calls)
        for call in calls:
            name = dotted(call.func)[-1:]
            if name and name[0] in self._named:
                setattr(call, _IS_KNOWN, _is_known(call))
                self.called.add(name[0])
        return not all(hasattr(call, _IS_KNOWN) or _is_known(call) for call in calls)


class _Loop(_Part):
    """One loop, with what its turns may do. ``kind``: None if each turn computes something that may end the loop."""

    _leaves = ast.Continue

    def __init__(self, loop: ast.While, named: Container[str] = ()) -> None:
        super().__init__(loop, named)
        self._loop = loop
        calls = self._calls_unknown(loop.test)
        is_idle = not _yields(loop.test) and self._block(loop.body)
        self.kind: Optional[int] = CALLS if calls else TIMES if self.times else WAITS
        if not is_idle:
            self.kind = COMPUTES if _is_ended_by_others(loop) else None
            self._acts = []

    def instrument(self, functions: Mapping[str, Sequence[_Part]]) -> None:
        if self.kind is None:
            return
        self._insert_acts()
        if self.kind == WAITS and _reach_time(self.called, functions):
            self.kind = TIMES
        self._loop.body.insert(0, _call(LOOK, [self.kind, self._loop.lineno], self._loop))


class _Function(_Part):
    """One function that a loop may call. ``may_look``: whether it can return without computing."""

    _leaves = ast.Return

    def __init__(self, function: ast.FunctionDef, named: Container[str]) -> None:
        super().__init__(function, named)
        self.line = function.lineno
        self._shared = {name for part in ast.walk(function) if isinstance(part, (ast.Global, ast.Nonlocal))
                        for name in part.names}
        self.may_look = self._block(function.body) and not any(
            _yields(part) or isinstance(part, ast.NamedExpr) for part in _parts(function.body))

    def instrument(self, functions: Mapping[str, Sequence[_Part]]) -> None:
        if self.may_look:
            self._insert_acts()


def _reach_time(names: Iterable[str], functions: Mapping[str, Sequence[_Part]]) -> bool:
    """Return whether functions with these names, or what they call, look at the time."""
    reached = _reached(names, lambda name: [other for one in functions.get(name, ()) for other in one.called])
    return any(one.times for name in reached for one in functions.get(name, ()))


def _reached(names: Iterable[str], following: Callable[[str], Iterable[str]]) -> Iterator[str]:
    """Yield the names, those that are ``following(name)`` each of them, and so on; each once."""
    todo, seen = list(names), set()
    while todo:
        name = todo.pop()
        if name not in seen:
            seen.add(name)
            todo.extend(following(name))
            yield name


def _is_ended_by_others(loop: ast.While) -> bool:
    """Return whether a loop's ends depend on nothing that it stores, calls a method of, or hands to a call."""
    ends = [loop.test] + [part.test for part in _parts(loop.body) if isinstance(part, ast.If) and any(
        isinstance(inner, (ast.Break, ast.Return, ast.Raise)) for inner in _parts(part.body))]
    read = set().union(*map(_read, ends))
    stored: Set[str] = set()
    handed: Set[str] = set()
    for part in _parts(loop.body):
        if isinstance(getattr(part, 'ctx', None), (ast.Store, ast.Del)):
            stored.add(_whole_name(part.value if isinstance(part, ast.Subscript) else part))
        elif isinstance(part, ast.Call):
            handed.update(map(_whole_name, [getattr(part.func, 'value', part.func), *part.args]))
    is_own = any(_overlap(one, other) for one in read for other in stored) or read & handed
    return bool(read) and not is_own


def _parts(block: Iterable[ast.AST]) -> Iterator[Any]:
    """Yield all parts of statements, but not the parts of functions and classes in them."""
    for node in block:
        yield node
        if not isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.Lambda)):
            yield from _parts(ast.iter_child_nodes(node))


def _read(node: Any) -> Set[str]:
    """Return the names that an expression reads; dotted names are not split."""
    name = _whole_name(node)
    return {name} if name else set().union(*map(_read, ast.iter_child_nodes(node)))


def _whole_name(node: Any) -> str:
    return '.'.join(dotted(node))


def _overlap(one: str, other: str) -> bool:
    return one and other and (one + '.').startswith(other + '.') or (other + '.').startswith(one + '.')


def _heads(node: Any) -> List[Any]:
    """Return the expressions that belong to a statement with others in it, for example its test."""
    heads = [getattr(node, name) for name in ('test', 'iter') if hasattr(node, name)]
    return heads + [item.context_expr for item in getattr(node, 'items', ())]


def _yields(node: Any) -> bool:
    return any(isinstance(part, _COMPUTING) for part in ast.walk(node))


def _call(name: str, values: List[int], place: Any) -> ast.Expr:
    call = ast.Call(func=ast.Name(id=name, ctx=ast.Load()), args=[ast.Constant(value=value) for value in values],
                    keywords=[])
    return ast.copy_location(ast.Expr(value=call), place)


def _names(target: Any) -> List[Optional[str]]:
    """Return the names that an assignment's target stores in; None stands for anything else."""
    if isinstance(target, (ast.Tuple, ast.List)):
        return [name for part in target.elts for name in _names(part)]
    return [target.id if isinstance(target, ast.Name) else None]


def _flow(loop: ast.While) -> Dict[str, Set[str]]:
    """Return {name that the loop stores: names from which its value is made}."""
    flow: Dict[str, Set[str]] = {}
    targets: List[Any]
    for node in ast.walk(loop):
        if isinstance(node, ast.NamedExpr):
            targets, value = [node.target], node.value
        elif isinstance(node, _ASSIGNMENTS) and node.value is not None:
            targets, value = node.targets if isinstance(node, ast.Assign) else [node.target], node.value
        else:
            continue
        used = {part.id for part in ast.walk(value) if isinstance(part, ast.Name)}
        for name in (name for target in targets for name in _names(target) if name):
            flow.setdefault(name, set()).update(used)
    return flow


def _is_made_from_itself(flow: Dict[str, Set[str]], name: str) -> bool:
    """Return whether the value of ``name`` is made from itself, directly or by way of other names."""
    return name in _reached(flow.get(name, ()), lambda other: flow.get(other, ()))


def _is_known(call: ast.Call) -> bool:
    """Return whether a call is known to return something and to change nothing."""
    name = dotted(call.func)
    if len(name) == 1:
        return name[0] in _FUNCTIONS
    if name[:1] == ('rospy',):
        return name[-1] not in _NOT_OF_ROSPY
    return isinstance(call.func, ast.Attribute) and (
        call.func.attr in _METHODS or call.func.attr in _WAITS and _has_no_length(call))


def _has_no_length(call: Any) -> bool:
    """Return whether a call that could wait only looks: ``event.wait(0)``, ``queue.get(block=False)``."""
    given = call.args[:1] + [keyword.value for keyword in call.keywords if keyword.arg in ('timeout', 'block')]
    return any(isinstance(one, ast.Constant) and one.value is not None and not one.value for one in given)


def dotted(node: Any) -> Tuple[str, ...]:
    """Return the parts of a dotted name, or () if ``node`` is something else."""
    if isinstance(node, ast.Name):
        return (node.id,)
    if isinstance(node, ast.Attribute):
        before = dotted(node.value)
        return before + (node.attr,) if before else ()
    return ()
