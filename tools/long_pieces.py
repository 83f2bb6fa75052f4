"""Find Python and C++ files of more than 400 lines, functions of more than 40, C++ lines of more than 120 characters.

usage: long_pieces.py FILE_OR_FOLDER...    (exit code 1 if there are any; ruff checks the length of Python lines)

C++ files must be in clang-format's form: the text before a brace then shows what the brace opens.
"""
import ast
import re
import sys
from pathlib import Path

FILE_LINES = 400
FUNCTION_LINES = 40
LINE_CHARACTERS = 120

_CPP = ('.cpp', '.h')
#: comments, texts, characters and directives, which may contain braces that open nothing
_HIDDEN = re.compile(r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|(?<!\w)\'(?:\\.[^\'\n]*|[^\'\\\n])\''
                     r'|^[ \t]*#(?:\\\n|[^\n])*', re.DOTALL | re.MULTILINE)
_NO_FUNCTION = re.compile(r'\s*(?:\w+\s+)*(?:namespace|class|struct|union|enum|extern)\b|.*=\s*$', re.DOTALL)
_NAME = re.compile(r'([~\w:]+|operator\s*\S+)\s*\(')


def complaints(path):
    """Yield a line for each part of a file that is too long."""
    text = path.read_text(encoding='utf-8')
    lines = text.count('\n')
    if lines > FILE_LINES:
        yield f'{path}: {lines} lines, more than {FILE_LINES}'
    if path.suffix in _CPP:
        for number, line in enumerate(text.split('\n'), 1):
            if len(line) > LINE_CHARACTERS:
                yield f'{path}:{number}: {len(line)} characters, more than {LINE_CHARACTERS}'
    for number, name, lines in (cpp_functions if path.suffix in _CPP else python_functions)(text):
        if lines > FUNCTION_LINES:
            yield f'{path}:{number} {name}: {lines} lines, more than {FUNCTION_LINES}'


def python_functions(text):
    """Yield (line, name, number of lines) of each function."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            yield node.lineno, node.name, node.end_lineno - node.lineno + 1


def cpp_functions(text):
    """Yield (line, name, number of lines) of each function that is not inside another one."""
    text = _HIDDEN.sub(_blank, text)
    at = begin = 0  # position, and begin of a possible head of a function
    while at < len(text):
        letter = text[at]
        if letter in ';}' or letter == ':' and re.search(r'\b(?:public|private|protected)\s*$', text[begin:at]):
            begin = at + 1
        elif letter == '{':
            head = text[begin:at]
            if _opens_list(head):
                at = _end_of_block(text, at)
            elif _NO_FUNCTION.match(head) or '(' not in head:
                begin = at + 1
            else:
                at = _end_of_block(text, at)
                first = begin + len(head) - len(head.lstrip())
                yield text.count('\n', 0, first) + 1, _name(head), text.count('\n', first, at) + 1
                begin = at + 1
        at += 1


def _blank(match):
    return re.sub(r'[^\n]', ' ', match.group())


def _opens_list(head):
    """Return whether the brace begins a value: of a member that a constructor initialises, or of a variable."""
    return bool(re.search(r'\)\s*:.*[\w>]$', head, re.DOTALL)) or bool(re.search(r'[\w\]>]$', head)) and '(' not in head


def _end_of_block(text, at):
    depth = 0
    for match in re.compile('[{}]').finditer(text, at):
        depth += 1 if match.group() == '{' else -1
        if depth == 0:
            return match.start()
    return len(text)


def _name(head):
    names = _NAME.findall(head)
    return names[0] if names else '?'


def main():
    """Check the files and folders of the command line; return the exit code."""
    found = []
    for name in map(Path, sys.argv[1:]):
        for path in sorted(name.rglob('*')) if name.is_dir() else [name]:
            if path.suffix in ('.py', *_CPP):
                found += complaints(path)
    print('\n'.join(found))
    return 1 if found else 0


if __name__ == '__main__':
    sys.exit(main())
