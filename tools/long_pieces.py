"""Name the Python files of more than 400 lines and the functions of more than 40 (exit 1 if there are any).

usage: long_pieces.py FILE_OR_FOLDER...
"""
import ast
import sys
from pathlib import Path

FILE_LINES = 400
FUNCTION_LINES = 40


def complaints(path):
    """Return one line per piece of a file that is too long."""
    text = path.read_text(encoding='utf-8')
    lines = text.count('\n')
    if lines > FILE_LINES:
        yield f'{path}: {lines} lines, more than {FILE_LINES}'
    for node in ast.walk(ast.parse(text, str(path))):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            lines = node.end_lineno - node.lineno + 1
            if lines > FUNCTION_LINES:
                yield f'{path}:{node.lineno} {node.name}: {lines} lines, more than {FUNCTION_LINES}'


def main():
    """Check the files and folders of the command line."""
    found = []
    for name in map(Path, sys.argv[1:]):
        for path in sorted(name.rglob('*.py')) if name.is_dir() else [name]:
            found += complaints(path)
    print('\n'.join(found))
    return 1 if found else 0


if __name__ == '__main__':
    sys.exit(main())
