"""Limits of files, functions and lines: what make lint says of C++ that is too long."""
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / 'tools'))

import long_pieces  # noqa: E402

BODY = '\n'.join(f'  call({k});' for k in range(39))

#: (head of a function, its name)
HEADS = [
    ('void run() {', 'run'),
    ('std::vector<int> Server::take(const std::string& text,\n                  int count) const {', 'Server::take'),
    ('template <typename Value>\nvoid fields(Value&& value) {', 'fields'),
    ('Server::Server(int port)\n    : port_(port), names_{"{", "}"}, buffer_{} {', 'Server::Server'),
    ('Server::~Server() noexcept {', 'Server::~Server'),
    ('bool operator==(const Server& other) const {', 'operator=='),
    ('class Server {\n public:\n  explicit Server(int port) : port_(port) {', 'Server'),
    ('namespace one {\nnamespace {\nconstexpr int kNone[] = {1, 2};\n/* of { */ int sum() {', 'sum'),
]


def cpp(tmp_path, text, name='file.cpp'):
    path = tmp_path / name
    path.write_text(text)
    return [line[len(str(path)) + 1:] for line in long_pieces.complaints(path)]


@pytest.mark.parametrize('head, name', HEADS, ids=[name for _, name in HEADS])
def test_a_function_of_41_lines_is_named_and_one_of_40_is_not(tmp_path, head, name):
    function = head.split('\n')[-1] if 'class' in head or 'namespace' in head else head
    more = function.count('\n')
    body = '\n'.join(BODY.split('\n')[more:])
    first = head.count('\n') - more + 1
    assert cpp(tmp_path, f'{head}\n{body}\n}}\n') == [f'{first} {name}: 41 lines, more than 40']
    assert cpp(tmp_path, f'{head}\n{body[body.index(chr(10)) + 1:]}\n}}\n') == []


def test_a_lambda_counts_where_it_stands_and_braces_in_texts_count_nowhere(tmp_path):
    text = "void run() {\n  each([](int k) {\n    return '{' + \"}{\" + 1'000;  // {\n  });\n" + BODY + '\n}\n'
    assert cpp(tmp_path, text) == ['1 run: 44 lines, more than 40']


def test_what_is_no_function_may_be_long(tmp_path):
    table = 'const Names kNames = {\n' + '\n'.join(f'  {{{k}, "a"}},' for k in range(50)) + '\n};\n'
    kinds = 'enum class Kind : int {\n' + '\n'.join(f'  k{k},' for k in range(50)) + '\n};\n'
    struct = 'struct Table {\n' + '\n'.join(f'  int a{k} = 0;' for k in range(50)) + '\n  int one() { return 1; }\n};\n'
    assert cpp(tmp_path, table + kinds + struct) == []


def test_long_files_and_lines_are_named(tmp_path):
    assert cpp(tmp_path, '// a\n' * 400, 'file.h') == []
    assert cpp(tmp_path, '// a\n' * 401, 'file.h') == [' 401 lines, more than 400']
    assert cpp(tmp_path, '//' + 'a' * 118 + '\n//' + 'a' * 119 + '\n') == ['2: 121 characters, more than 120']


def test_python_is_held_to_the_same_limits(tmp_path):
    text = 'def run():\n' + '    call()\n' * 40
    assert cpp(tmp_path, text, 'file.py') == ['1 run: 41 lines, more than 40']
