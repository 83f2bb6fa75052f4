"""Programs that are written for Python 2: their sources are translated as they are loaded, and stay as they are.

Python's own lib2to3 (up to 3.12) rewrites the words. Division is then as in Python 2: of whole numbers it rounds down,
and objects may have ``__div__``.
"""
from __future__ import annotations

import ast
import builtins
import io
import numbers
import os
import re
import tokenize
import warnings
from functools import lru_cache
from typing import Any, Tuple

#: the environment variable that names the folders of such packages
VARIABLE = 'MOVE_BASE_ABSTRACT_PYTHON_2'
_DIVIDED, _DIVISOR = '__divided_as_in_python_2__', '__divisor_as_in_python_2__'
_WHOLE = ('i', 'u', 'b')  # kinds of numpy
_INDENTED = re.compile(r'^[ \t]+', re.MULTILINE)
#: what Python 2 does not read, among what both parsers read
_NEWER = (ast.JoinedStr, ast.AnnAssign, ast.AsyncFunctionDef, ast.Nonlocal, ast.YieldFrom, ast.NamedExpr)
_FIXES = (
    'basestring dict except exec filter funcattrs getcwdu has_key imports imports2 input intern itertools long map '
    'itertools_imports metaclass methodattrs ne next nonzero numliterals operator paren print raise raw_input reduce '
    'renames repr standarderror sys_exc throw tuple_params types unicode urllib xrange zip')
#: modules that only Python 2 has, imported without a way out
_MODULES = ('Queue', 'urllib2', 'ConfigParser', 'cPickle', 'StringIO', 'commands', 'Tkinter')
_MOST_FILES = 300
_LARGEST = 1 << 20  # bytes


@lru_cache(maxsize=None)
def _folders() -> Tuple[str, ...]:
    named = os.environ.get(VARIABLE, '').split(os.pathsep)
    return tuple(os.path.join(os.path.realpath(one), '') for one in named if one)


def is_older(path: str) -> bool:
    """Return whether a file belongs to a package that is written for Python 2."""
    return bool(_folders()) and os.path.realpath(path).startswith(_folders())


@lru_cache(maxsize=None)
def _tool() -> Any:
    with warnings.catch_warnings():
        warnings.simplefilter('ignore')  # that it will go
        from lib2to3.refactor import RefactoringTool
        return RefactoringTool([f'lib2to3.fixes.fix_{name}' for name in _FIXES.split()])


def translated(source: bytes) -> str:
    """Return the text of a source as Python 3 has it.

    :raises SyntaxError: if it is no Python 2, either, or if there is no lib2to3.
    """
    encoding, _lines = tokenize.detect_encoding(io.BytesIO(source).readline)
    try:
        text = source.decode(encoding).replace('\r\n', '\n')
        text = _INDENTED.sub(lambda found: found.group().expandtabs(8), text)  # as Python 2 counts a tab
        return str(_tool().refactor_string(text if text.endswith('\n') else text + '\n', 'source'))
    except ImportError:
        raise SyntaxError('it is written for Python 2, and there is no lib2to3 here') from None
    except Exception as error:  # lib2to3 has several of its own
        raise SyntaxError(f'it is neither Python 3 nor Python 2: {error}') from None


def tree_of(source: bytes, path: str) -> Any:
    """Return the syntax tree of a file that is written for Python 2. :raises SyntaxError: as translated()."""
    try:
        tree = ast.parse(source, path)
        if any(isinstance(node, _NEWER) or getattr(node, 'kwonlyargs', None) or getattr(node, 'annotation', None) or
               getattr(node, 'returns', None) for node in ast.walk(tree)):
            return tree
    except SyntaxError:
        tree = None
    try:
        tree = ast.parse(translated(source), path)
    except SyntaxError:
        if tree is None:
            raise
        return tree  # such as print(x, file=y), which is no Python 2
    has_division = any(isinstance(node, ast.ImportFrom) and node.module == '__future__' and any(
        name.name == 'division' for name in node.names) for node in tree.body)
    setattr(builtins, _DIVIDED, divided)
    setattr(builtins, _DIVISOR, _Divisor)
    return tree if has_division else ast.fix_missing_locations(_Division().visit(tree))


class _Division(ast.NodeTransformer):
    """Makes divisions calls of divided()."""

    def visit_BinOp(self, node: ast.BinOp) -> Any:  # noqa: N802 - ast's name
        """Replace ``a / b``."""
        self.generic_visit(node)
        return _call(node, _DIVIDED, node.left, node.right) if isinstance(node.op, ast.Div) else node

    def visit_AugAssign(self, node: ast.AugAssign) -> Any:  # noqa: N802 - ast's name
        """Make ``a /= b`` an operation for which a _Divisor is asked, so that ``a`` is computed once."""
        self.generic_visit(node)
        if isinstance(node.op, ast.Div):
            node.op, node.value = ast.RShift(), _call(node.value, _DIVISOR, node.value)
        return node


def _call(node: Any, name: str, *arguments: Any) -> Any:
    return ast.copy_location(ast.Call(ast.Name(name, ast.Load()), [*arguments], []), node)


def divided(left: Any, right: Any) -> Any:
    """Return what Python 2 has for ``left / right``."""
    if _is_whole(left) and _is_whole(right):
        return left // right
    for one, other, name, new in ((left, right, '__div__', '__truediv__'), (right, left, '__rdiv__', '__rtruediv__')):
        if hasattr(type(one), name) and not hasattr(type(one), new):
            return getattr(one, name)(other)
    return left / right


def _is_whole(value: Any) -> bool:
    """Return whether a value is a whole number, or an array of numpy of such."""
    return isinstance(value, numbers.Integral) or getattr(getattr(value, 'dtype', None), 'kind', '') in _WHOLE


class _Divisor:
    """The ``right`` of ``left /= right``, which stands there as ``left >>= _Divisor(right)``."""

    def __init__(self, right: Any) -> None:
        self._right = right

    def __rrshift__(self, left: Any) -> Any:
        """Return what Python 2 has for ``left`` afterwards: an array is divided in place."""
        right = self._right
        if _is_whole(left) and _is_whole(right):
            left //= right
        elif hasattr(type(left), '__idiv__') and not hasattr(type(left), '__itruediv__'):
            left = left.__idiv__(right)
        elif hasattr(type(left), '__itruediv__'):
            left /= right
        else:
            left = divided(left, right)
        return left

    def __array_ufunc__(self, _function: Any, _method: str, left: Any, *_others: Any, **_named: Any) -> Any:
        """Do the same for numpy, which asks here, and not above."""
        return self.__rrshift__(left)


def why_older(folder: str) -> str:
    """Return 'FILE, line N' of the first source below a folder that only Python 2 reads, or ''."""
    count = 0
    if folder.startswith(('/usr/', '/opt/')):
        return ''  # of a distribution, which is for this Python
    for place, folders, files in os.walk(folder):
        folders[:] = sorted(one for one in folders if not one.startswith('.') and one not in ('build', 'devel'))
        for path in (os.path.join(place, name) for name in sorted(files)):
            count += 1
            found = _line_of_python_2(path) if count <= _MOST_FILES and _is_python(path) else 0
            if found:
                return f'{os.path.relpath(path, folder)}, line {found}'
    return ''


def _is_python(path: str) -> bool:
    if not os.path.isfile(path) or os.path.getsize(path) > _LARGEST:
        return False
    with open(path, 'rb') as stream:
        first = stream.readline(200)
    return b'python3' not in first and (path.endswith('.py') or first.startswith(b'#!') and b'python' in first)


def _line_of_python_2(path: str) -> int:
    with open(path, 'rb') as stream:
        source = stream.read()
    try:
        line = _line_of_old_module(ast.parse(source, path), os.path.dirname(path))
    except SyntaxError as error:
        line = error.lineno or 1
    except ValueError:
        return 0
    try:
        return line and line * bool(ast.parse(translated(source), path))
    except (SyntaxError, ValueError):
        return 0


def _line_of_old_module(tree: ast.Module, folder: str) -> int:
    """Return the line that imports one of _MODULES, or 0. A module of that name in the folder is the program's own."""
    for node in tree.body:
        names = [one.name for one in node.names] if isinstance(node, ast.Import) else [
            node.module or ''] if isinstance(node, ast.ImportFrom) and not node.level else []
        for name in names:
            own = os.path.join(folder, name)
            if name in _MODULES and not os.path.exists(own) and not os.path.exists(own + '.py'):
                return node.lineno
    return 0
