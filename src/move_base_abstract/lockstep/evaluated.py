"""Whether a text that somebody has evaluated at a debugger's prompt may change the program, and so the run."""
from __future__ import annotations

import ast
import re

#: functions that only look at what they get
_LOOKING = frozenset((
    'abs', 'all', 'any', 'bool', 'dict', 'dir', 'enumerate', 'float', 'frozenset', 'getattr', 'hasattr', 'hex', 'int',
    'isinstance', 'len', 'list', 'max', 'min', 'repr', 'reversed', 'round', 'set', 'sorted', 'str', 'sum', 'tuple',
    'type', 'vars', 'zip'))
_CHANGING = (ast.Await, ast.Yield, ast.YieldFrom, ast.NamedExpr)
_CONVENIENCE = re.compile(r'\$(?=\w)')  # of pdb from Python 3.12 on: a name of its own


def may_change(text: str) -> bool:
    """Return whether evaluating ``text`` may do more than look: it is a statement, or it calls an unknown function.

    Properties and texts of objects (``__repr__``) of the program count as looking.
    """
    try:
        tree: ast.AST = ast.parse(_CONVENIENCE.sub('', text.strip()), mode='eval')
    except (SyntaxError, ValueError):
        return _is_statement(text)
    return any(isinstance(node, _CHANGING) or isinstance(node, ast.Call) and not (
        isinstance(node.func, ast.Name) and node.func.id in _LOOKING) for node in ast.walk(tree))


def _is_statement(text: str) -> bool:
    """Return whether a text does something: one that is no Python at all does nothing."""
    try:
        return bool(ast.parse(_CONVENIENCE.sub('', text.strip())).body)
    except (SyntaxError, ValueError):
        return False
