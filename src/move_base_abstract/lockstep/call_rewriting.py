"""Rewrites a program's own code where it asks the machine by names that cannot be replaced, because they are made in C.

For example, ``datetime.now`` is a part of a type made in C, and ``id`` is a builtin. So where the program's text has
such a name, its value is handed to :data:`ASK`, which may return something else. This module only knows Python's text.
"""
from __future__ import annotations

import ast
from typing import Any, Sequence, Union

#: names of the functions that the rewritten code calls, which must be builtins; each gets a value and returns it, or
#: another one in its place
ASK, HASHED, FILE_TIME = '__lockstep_ask__', '__lockstep_hashed__', '__lockstep_file_time__'
#: attributes whose values are handed to ASK
ATTRIBUTES = frozenset(('now', 'utcnow', 'today', 'get_ident'))
#: attributes of the results of os.stat and the like: when a file was written, read or changed
FILE_TIMES = frozenset(('st_{}time{}'.format(which, unit) for which in 'mac' for unit in ('', '_ns')))
#: functions that return an address
_ADDRESSES = ('id', 'get_ident')
#: functions whose names are handed to ASK: these, and hash, which may return an address
_HANDED = (*_ADDRESSES, 'hash')
#: methods that may get an address as it is: they only compare it with others
_KEYED = frozenset(('add', 'discard', 'remove', 'get', 'pop', 'setdefault'))


def ask(tree: ast.Module) -> ast.Module:
    """Make a module's ``tree`` (of :func:`ast.parse`) call :data:`ASK`, HASHED and FILE_TIME; return it."""
    changed: ast.Module = _Asking().visit(tree)
    return ast.fix_missing_locations(changed)


class _Asking(ast.NodeTransformer):
    # The names of the methods are those of ast.NodeTransformer.

    def visit_Attribute(self, node: ast.Attribute) -> Union[ast.Attribute, ast.Call]:  # noqa: N802
        self.generic_visit(node)
        if not isinstance(node.ctx, ast.Load):
            return node
        if node.attr in FILE_TIMES:
            return _handed(FILE_TIME, node)
        return _handed(ASK, node) if node.attr in ATTRIBUTES else node

    def visit_Name(self, node: ast.Name) -> Union[ast.Call, ast.Name]:  # noqa: N802
        return _handed(ASK, node) if node.id in _HANDED and isinstance(node.ctx, ast.Load) else node

    def visit_Call(self, node: ast.Call) -> ast.AST:  # noqa: N802
        if isinstance(node.func, ast.Name) and node.func.id == 'hash' and len(node.args) == 1:
            node.args = [_handed(HASHED, self.visit(node.args[0]))]
            return node
        if _is_present_of_numpy(node):
            self.generic_visit(node)
            node.func = _handed(ASK, node.func)
            return node
        is_keyed = isinstance(node.func, ast.Attribute) and node.func.attr in _KEYED
        return self._visit_but(node, node.args if is_keyed else ())

    def visit_Compare(self, node: ast.Compare) -> ast.AST:  # noqa: N802
        return self._visit_but(node, [node.left] + node.comparators)

    def visit_Subscript(self, node: ast.Subscript) -> ast.AST:  # noqa: N802
        # Before Python 3.9 an index is in a node of its own.
        return self._visit_but(node, [getattr(node.slice, 'value', node.slice), node.slice])

    def visit_Dict(self, node: ast.Dict) -> ast.AST:  # noqa: N802
        return self._visit_but(node, node.keys)

    def visit_DictComp(self, node: ast.DictComp) -> ast.AST:  # noqa: N802
        return self._visit_but(node, [node.key])

    def _visit_but(self, node: ast.AST, places: Sequence[Any]) -> ast.AST:
        """Visit a node; calls of ``id`` and ``get_ident`` in these ``places`` of it stay as they are."""
        kept = [(call, call.func) for call in places if _is_of_id(call)]
        self.generic_visit(node)
        for call, function in kept:
            call.func = function
        return node


def _is_present_of_numpy(node: ast.Call) -> bool:
    """Return whether a call is ``numpy.datetime64('now')`` or ``('today')``."""
    return getattr(node.func, 'attr', '') == 'datetime64' and bool(node.args) and getattr(
        node.args[0], 'value', None) in ('now', 'today')


def _is_of_id(node: Any) -> bool:
    return isinstance(node, ast.Call) and getattr(node.func, 'id', getattr(node.func, 'attr', '')) in _ADDRESSES


def _handed(name: str, node: ast.expr) -> ast.Call:
    call = ast.Call(func=ast.Name(id=name, ctx=ast.Load()), args=[node], keywords=[])
    return ast.copy_location(call, node)
