"""Rewrites a program's classes and uses of sets, because the order of a set may come from addresses of objects.

Python hashes an object by its address if its class says nothing else, and goes through a set in the order of hashes,
which differs from run to run. So the bases of each class are handed to :data:`BASES`, which may add one that hashes
differently. And each value that is iterated over, printed, popped or unpacked, and so may be a set, is handed to
:data:`ORDER`. This module only knows Python's text.
"""
from __future__ import annotations

import ast
from typing import Any, Callable, List

#: names of the functions that are called, which must be builtins: ``BASES(*bases)`` -> bases, ``ORDER(value)`` -> value
BASES, ORDER = '__lockstep_bases__', '__lockstep_order__'

#: functions and methods whose result depends on the order of their argument
_ORDERED = frozenset((
    'Counter', 'DataFrame', 'DiGraph', 'Graph', 'Index', 'OrderedDict', 'Series', 'accumulate', 'add_edges_from',
    'add_nodes_from', 'array', 'as_completed', 'asarray', 'batched', 'chain', 'choice', 'choices', 'combinations',
    'combinations_with_replacement', 'compress', 'concatenate', 'cycle', 'deque', 'dict', 'dropwhile', 'dump', 'dumps',
    'enumerate', 'extend', 'extendleft', 'filter', 'filterfalse', 'format', 'from_iterable', 'fromiter', 'fromkeys',
    'groupby', 'hstack', 'islice', 'iter', 'join', 'linear_sum_assignment', 'list', 'map', 'max', 'mean', 'merge',
    'min', 'nlargest', 'nsmallest', 'pairwise', 'permutations', 'print', 'product', 'reduce', 'repr', 'sample',
    'shuffle', 'stack', 'starmap', 'str', 'subgraph', 'sum', 'takewhile', 'tee', 'tuple', 'vstack', 'writelines',
    'writerows', 'zip', 'zip_longest'))
#: functions for which a generator's order does not matter; a sum of floats depends on it in its last digit
_UNORDERED = frozenset(('all', 'any', 'frozenset', 'fsum', 'len', 'set', 'sorted'))
#: functions and methods that may be called in any order, as they only look; others may do something
_LOOKS = frozenset((
    'abs', 'bool', 'done', 'endswith', 'float', 'get', 'get_num_connections', 'get_state', 'getattr', 'hasattr',
    'hash', 'hypot', 'id', 'int', 'is_alive', 'is_set', 'isinstance', 'items', 'keys', 'len', 'locked', 'lower', 'max',
    'min', 'range', 'repr', 'round', 'sorted', 'sqrt', 'startswith', 'str', 'tuple', 'type', 'upper', 'values'))
_METACLASSES = frozenset(('ABCMeta', 'type'))


def follow_order(tree: ast.Module) -> ast.Module:
    """Make a module's ``tree`` (of :func:`ast.parse`) call :data:`BASES` and :data:`ORDER`; return it."""
    changed: ast.Module = _Order().visit(tree)
    return ast.fix_missing_locations(changed)


class _Order(ast.NodeTransformer):
    # The names of the methods are those of ast.NodeTransformer.

    def visit_ClassDef(self, node: ast.ClassDef) -> ast.ClassDef:  # noqa: N802
        self.generic_visit(node)
        metaclasses = [keyword.value for keyword in node.keywords if keyword.arg in (None, 'metaclass')]
        if all(_last(metaclass) in _METACLASSES for metaclass in metaclasses):
            at = node.bases[0] if node.bases else node
            bases = ast.Call(func=ast.Name(id=BASES, ctx=ast.Load()), args=node.bases, keywords=[])
            node.bases = [ast.copy_location(ast.Starred(value=ast.copy_location(bases, at), ctx=ast.Load()), at)]
        return node

    def visit_SetComp(self, node: ast.SetComp) -> ast.SetComp:  # noqa: N802
        does_nothing = _only_looks(node)
        self.generic_visit(node)
        if does_nothing:
            _look_past(node.generators)
        return node

    def visit_Call(self, node: ast.Call) -> ast.Call:  # noqa: N802
        name = _last(node.func)
        is_unordered = _is_unordered(name, node)
        self.generic_visit(node)
        if is_unordered:
            _look_past(node.args[0].generators)  # type: ignore[attr-defined]
        elif name in _ORDERED or _has_key(node):
            node.args = [_seen(argument) for argument in node.args]
        elif name == 'pop' and isinstance(node.func, ast.Attribute) and not node.args:
            node.func.value = _seen(node.func.value)
        return node

    def visit_Starred(self, node: ast.Starred) -> ast.Starred:  # noqa: N802
        self.generic_visit(node)
        if isinstance(node.ctx, ast.Load):
            node.value = _seen(node.value)
        return node

    def visit_Assign(self, node: ast.Assign) -> ast.Assign:  # noqa: N802
        self.generic_visit(node)
        if any(isinstance(target, (ast.Tuple, ast.List)) or _is_slice(target) for target in node.targets):
            node.value = _seen(node.value)
        return node

    def visit_AugAssign(self, node: ast.AugAssign) -> ast.AugAssign:  # noqa: N802
        self.generic_visit(node)
        if isinstance(node.op, ast.Add):  # to a list
            node.value = _seen(node.value)
        return node

    def visit_BinOp(self, node: ast.BinOp) -> ast.BinOp:  # noqa: N802
        self.generic_visit(node)
        if isinstance(node.op, ast.Mod) and isinstance(node.left, (ast.Constant, ast.JoinedStr)):  # a text
            if isinstance(node.right, ast.Tuple):
                node.right.elts = [_seen(part) for part in node.right.elts]
            else:
                node.right = _seen(node.right)
        return node


def _seeing(field: str) -> Callable[[_Order, Any], Any]:
    """Return the method that visits a node, and hands what it has in this field to ORDER."""
    def visit(self: _Order, node: Any) -> Any:
        self.generic_visit(node)
        setattr(node, field, _seen(getattr(node, field)))
        return node
    return visit


for _name, _field in (('For', 'iter'), ('comprehension', 'iter'), ('FormattedValue', 'value'), ('YieldFrom', 'value')):
    setattr(_Order, 'visit_' + _name, _seeing(_field))


def _look_past(generators: List[ast.comprehension]) -> None:
    """Take the calls of ORDER from a comprehension whose order does not matter."""
    for generator in generators:
        generator.iter = _unseen(generator.iter)


def _has_key(node: ast.Call) -> bool:
    """Return whether a call sorts by a key, so that values with equal keys stay in the order in which they came."""
    return any(keyword.arg == 'key' for keyword in node.keywords)


def _is_unordered(name: str, node: ast.Call) -> bool:
    """Return whether a call's only argument is a generator whose order does not matter."""
    if len(node.args) != 1 or not isinstance(node.args[0], ast.GeneratorExp) or _has_key(node) or not _only_looks(
            node.args[0]):
        return False
    counts = name == 'sum' and isinstance(node.args[0].elt, (ast.Constant, ast.Compare))
    return counts or name in _UNORDERED


def _only_looks(node: Any) -> bool:
    """Return whether all that a comprehension calls for each element may be called in any order."""
    first, *others = node.generators
    called = (part for one in (node.elt, *first.ifs, *others) for part in ast.walk(one) if isinstance(part, ast.Call))
    return all(_last(part.func) in _LOOKS for part in called)


def _is_slice(target: ast.expr) -> bool:
    return isinstance(target, ast.Subscript) and isinstance(target.slice, ast.Slice)


def _seen(node: Any) -> Any:
    """Return a call of ORDER with this expression; an expression that cannot be a set stays as it is."""
    if isinstance(node, (ast.Starred, ast.Constant, ast.List, ast.Tuple, ast.Dict, ast.ListComp, ast.DictComp,
                         ast.GeneratorExp, ast.JoinedStr, ast.Lambda)):
        return node
    if isinstance(node, ast.Call) and _last(node.func) in ('range', 'sorted', 'items', 'values', 'keys', ORDER):
        return node
    if _last(node) in ('ascii', 'float', 'int', 'repr', 'str'):  # handed on to be called
        return node
    call = ast.Call(func=ast.Name(id=ORDER, ctx=ast.Load()), args=[node], keywords=[])
    return ast.copy_location(call, node)


def _unseen(node: ast.expr) -> ast.expr:
    return node.args[0] if isinstance(node, ast.Call) and _last(node.func) == ORDER else node


def _last(node: ast.AST) -> str:
    """Return the last part of a name, '' for anything else."""
    return node.id if isinstance(node, ast.Name) else node.attr if isinstance(node, ast.Attribute) else ''
