"""Rewrites a program's own code where it asks the machine by names that cannot be replaced, because they are made in C.

For example, ``datetime.now`` is a part of a type made in C, and ``id`` is a builtin. So where the program's text has
such a name, its value is handed to :data:`ASK`, which may return something else. Texts that may show an address are
handed to :data:`SHOWN`. This module only knows Python's text.
"""
from __future__ import annotations

import ast
import re
from typing import Any, Iterable, Union

#: names of the functions that the rewritten code calls, which must be builtins; each gets a value and returns it, or
#: another one in its place
ASK, HASHED, FILE_TIME = '__lockstep_ask__', '__lockstep_hashed__', '__lockstep_file_time__'
#: likewise: ``KEPT(id)`` where the address is kept as a key, ``SHOWN(value, how)`` for what may be a text that shows an
#: address, ``SHOWING(function)`` for a function such as ``repr`` that is handed on to be called
KEPT, SHOWN, SHOWING = '__lockstep_kept__', '__lockstep_shown__', '__lockstep_showing__'
#: likewise, for ``compile``; ``TEXT('exec' or 'eval', source, ...)`` gets and returns all arguments of these functions
COMPILING, TEXT = '__lockstep_compiling__', '__lockstep_text__'
#: attributes whose values are handed to ASK
MOMENTS = frozenset(('now', 'utcnow', 'today'))
ATTRIBUTES = MOMENTS | {'get_ident'}
#: attributes of the results of os.stat and the like: when a file was written, read or changed
FILE_TIMES = frozenset(('st_{}time{}'.format(which, unit) for which in 'mac' for unit in ('', '_ns')))
#: functions that return an address
_ADDRESSES = ('id', 'get_ident')
#: functions whose names are handed to ASK: these, and hash, which may return an address
_HANDED = (*_ADDRESSES, 'hash')
_RUN = ('eval', 'exec')
#: methods that may get an address as it is, since they only compare it with others; and those that keep it, too
_KEYED, _KEEPING = frozenset(('discard', 'remove', 'get', 'pop')), frozenset(('add', 'setdefault'))
_SAME = (ast.Eq, ast.NotEq, ast.In, ast.NotIn, ast.Is, ast.IsNot)
#: functions and methods that make texts of objects, and those of them that may be handed on
_TEXTS = frozenset(('__repr__', '__str__', 'ascii', 'dumps', 'format', 'format_exc', 'format_map', 'pformat', 'repr',
                    'str'))
_TEXT_MAKERS = ('ascii', 'repr', 'str')
#: functions whose texts decide nothing: the program's own log, and what it prints
_LOGS = frozenset(('print', 'debug', 'info', 'warning', 'warn', 'error', 'critical', 'exception'))
_LOGS_OF_ROS = re.compile('log(debug|info|warn|err|fatal)(_throttle|_once)?')


def ask(tree: ast.Module) -> ast.Module:
    """Make a module's ``tree`` (of :func:`ast.parse`) call :data:`ASK`, HASHED and FILE_TIME; return it."""
    changed: ast.Module = _Asking().visit(tree)
    return ast.fix_missing_locations(changed)


def ask_present(tree: ast.Module) -> ast.Module:
    """Make the ``tree`` of a library's module call :data:`ASK` where it may ask for the present; return it."""
    changed: ast.Module = _Present().visit(tree)
    return ast.fix_missing_locations(changed)


class _Present(ast.NodeTransformer):
    def visit_Attribute(self, node: ast.Attribute) -> Union[ast.Attribute, ast.Call]:  # noqa: N802
        self.generic_visit(node)
        return _handed(ASK, node) if isinstance(node.ctx, ast.Load) and node.attr in MOMENTS else node


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
        if not isinstance(node.ctx, ast.Load):
            return node
        if node.id == 'compile':
            return _handed(COMPILING, node)
        return _handed(ASK, node) if node.id in _HANDED else node

    def visit_Call(self, node: ast.Call) -> ast.AST:  # noqa: N802
        if isinstance(node.func, ast.Name) and node.func.id == 'hash' and len(node.args) == 1:
            node.args = [_handed(HASHED, self.visit(node.args[0]))]
            return node
        if _is_present_of_numpy(node):
            self.generic_visit(node)
            node.func = _handed(ASK, node.func)
            return node
        mode = getattr(node.func, 'id', '')
        if mode in _RUN and node.args and not node.keywords:
            handed = _handed(TEXT, ast.copy_location(ast.Constant(value=mode), node))
            handed.args += node.args
            node.args = [ast.copy_location(ast.Starred(value=handed, ctx=ast.Load()), node)]
        name = getattr(node.func, 'attr', '')
        if name == '__hash__':
            node.func = _handed(ASK, node.func)
        self._visit_but(node, node.args if name in _KEYED | _KEEPING else (), name in _KEEPING)
        return _texts_seen(node, name or getattr(node.func, 'id', ''))

    def visit_Compare(self, node: ast.Compare) -> ast.AST:  # noqa: N802
        is_same = all(isinstance(operator, _SAME) for operator in node.ops)
        return self._visit_but(node, [node.left] + node.comparators if is_same else ())

    def visit_Subscript(self, node: ast.Subscript) -> ast.AST:  # noqa: N802
        # Before Python 3.9 an index is in a node of its own. A defaultdict also keeps keys that it is asked for.
        return self._visit_but(node, [getattr(node.slice, 'value', node.slice), node.slice], True)

    def visit_Dict(self, node: ast.Dict) -> ast.AST:  # noqa: N802
        return self._visit_but(node, node.keys, True)

    def visit_DictComp(self, node: ast.DictComp) -> ast.AST:  # noqa: N802
        return self._visit_but(node, [node.key], True)

    def visit_JoinedStr(self, node: ast.JoinedStr) -> ast.AST:  # noqa: N802
        for part in node.values:  # not those of a format, which are of this kind, too
            if isinstance(part, ast.FormattedValue):
                part.value = self.visit(part.value)
        return _shown(node, 'f-string')

    def visit_BinOp(self, node: ast.BinOp) -> ast.AST:  # noqa: N802
        self.generic_visit(node)
        is_text = isinstance(node.op, ast.Mod) and isinstance(node.left, ast.Constant) and type(node.left.value) is str
        return _shown(node, '%') if is_text else node

    def _visit_but(self, node: ast.AST, places: Iterable[Any], is_kept: bool = False) -> ast.AST:
        """Visit a node; calls of ``id`` and ``get_ident`` in these ``places`` of it stay, or are handed to KEPT."""
        excepted = [(call, call.func) for call in places if _is_of_id(call)]
        self.generic_visit(node)
        for call, function in excepted:
            call.func = _handed(KEPT, function) if is_kept else function
        return node


def _texts_seen(node: ast.Call, name: str) -> ast.AST:
    """Hand texts that the call ``name`` makes to SHOWN, but not those that are only logged."""
    if name in _LOGS or _LOGS_OF_ROS.fullmatch(name):
        node.args = [_unshown(argument) for argument in node.args]
    if name == 'map':
        node.args = [_showing(argument) for argument in node.args]
    for keyword in node.keywords:
        if keyword.arg == 'key' or keyword.arg == 'default' and name in ('dump', 'dumps'):
            keyword.value = _showing(keyword.value)
    return _shown(node, name) if name in _TEXTS else node


def _shown(node: Any, how: str) -> ast.Call:
    call = _handed(SHOWN, node)
    call.args.append(ast.copy_location(ast.Constant(value=how), node))
    return call


def _unshown(node: ast.expr) -> ast.expr:
    return node.args[0] if isinstance(node, ast.Call) and getattr(node.func, 'id', '') == SHOWN else node


def _showing(node: ast.expr) -> ast.expr:
    return _handed(SHOWING, node) if getattr(node, 'id', '') in _TEXT_MAKERS else node


def _is_present_of_numpy(node: ast.Call) -> bool:
    """Return whether a call is ``numpy.datetime64('now')`` or ``('today')``."""
    return getattr(node.func, 'attr', '') == 'datetime64' and bool(node.args) and getattr(
        node.args[0], 'value', None) in ('now', 'today')


def _is_of_id(node: Any) -> bool:
    return isinstance(node, ast.Call) and getattr(node.func, 'id', getattr(node.func, 'attr', '')) in _ADDRESSES


def _handed(name: str, node: ast.expr) -> ast.Call:
    call = ast.Call(func=ast.Name(id=name, ctx=ast.Load()), args=[node], keywords=[])
    return ast.copy_location(call, node)
