"""Has a program's own code hand on what it asks the machine by names that cannot be replaced: those that are made in C.

``datetime.now`` is a part of a type in C, ``id`` a word of the language. So where the program's text has such a name,
what it stands for is handed to :data:`ASK`, which may return something else. Knows Python's text only.
"""
from __future__ import annotations

import ast
from typing import Any, Sequence, Union

#: the names of what is called, to be found among the builtins: ``ASK(what)`` -> what, ``HASHED(value)`` -> value,
#: ``FILE_TIME(value)`` -> value
ASK, HASHED, FILE_TIME = '__lockstep_ask__', '__lockstep_hashed__', '__lockstep_file_time__'
#: attributes whose values are handed on
ATTRIBUTES = frozenset(('now', 'utcnow', 'today', 'get_ident'))
#: those of what os.stat and its like return: when a file was written, looked at, changed
FILE_TIMES = frozenset(('st_{}time{}'.format(which, unit) for which in 'mac' for unit in ('', '_ns')))
#: functions that return an address
_ADDRESSES = ('id', 'get_ident')
#: these, and the one that may
_HANDED = (*_ADDRESSES, 'hash')
#: methods to which an address may be given: nothing of it shows but whether it is the same
_KEYED = frozenset(('add', 'discard', 'remove', 'get', 'pop', 'setdefault'))


def ask(tree: ast.Module) -> ast.Module:
    """Have a module's ``tree`` (of :func:`ast.parse`) call :data:`ASK` and :data:`HASHED`; return it."""
    changed: ast.Module = _Asking().visit(tree)
    return ast.fix_missing_locations(changed)


class _Asking(ast.NodeTransformer):
    # The methods have ast's names.

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
        # Before Python 3.9 an index stands in a node of its own.
        return self._visit_but(node, [getattr(node.slice, 'value', node.slice), node.slice])

    def visit_Dict(self, node: ast.Dict) -> ast.AST:  # noqa: N802
        return self._visit_but(node, node.keys)

    def visit_DictComp(self, node: ast.DictComp) -> ast.AST:  # noqa: N802
        return self._visit_but(node, [node.key])

    def _visit_but(self, node: ast.AST, places: Sequence[Any]) -> ast.AST:
        """Visit a node; calls of ``id`` in these places of it stay as they are."""
        kept = [(call, call.func) for call in places if _is_of_id(call)]
        self.generic_visit(node)
        for call, function in kept:
            call.func = function
        return node


def _is_present_of_numpy(node: ast.Call) -> bool:
    """Whether it is ``numpy.datetime64('now')``."""
    return getattr(node.func, 'attr', '') == 'datetime64' and bool(node.args) and getattr(
        node.args[0], 'value', None) in ('now', 'today')


def _is_of_id(node: Any) -> bool:
    return isinstance(node, ast.Call) and getattr(node.func, 'id', getattr(node.func, 'attr', '')) in _ADDRESSES


def _handed(name: str, node: ast.expr) -> ast.Call:
    call = ast.Call(func=ast.Name(id=name, ctx=ast.Load()), args=[node], keywords=[])
    return ast.copy_location(call, node)
