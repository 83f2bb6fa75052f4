"""The programs of the package stand in one table: what `help` lists is there, and old names say the new ones."""
import os
import re
import sys
from pathlib import Path

import pytest

from move_base_abstract_ros import loopback
from move_base_abstract_ros.nodes import help as helps

ROOT = Path(__file__).resolve().parents[2]
PROGRAMS = [name for programs in helps.PROGRAMS.values() for name in programs]


def asked(monkeypatch, capsys, *words):
    """Return what a command line prints."""
    monkeypatch.setattr(sys, 'argv', list(words))
    helps.main()
    return capsys.readouterr()


def test_each_program_is_there_and_has_a_module_with_a_main():
    scripts = helps.scripts()
    assert sorted(PROGRAMS) == sorted({name for name in scripts if not name.startswith('old/')} | {'time_master'})
    assert len(PROGRAMS) <= 24
    for module in scripts.values():
        path = ROOT / 'src' / module.replace('.', '/') if module.startswith('move_base_abstract_') else \
            ROOT / 'src/move_base_abstract_ros/nodes' / module.replace('.', '/')
        assert re.search(r'^(def|from .* import) main\b', path.with_suffix('.py').read_text(encoding='utf-8'), re.M)
    assert not set(PROGRAMS) & set(helps.OLD_NAMES)


def test_help_lists_all_programs_with_a_sentence(monkeypatch, capsys):
    lines = asked(monkeypatch, capsys, '/lib/help').out.splitlines()
    assert [line.split()[0] for line in lines if line.startswith('  ')] == PROGRAMS
    assert [line for line in lines if line.startswith('  ') and len(line.split()) < 4] == []


@pytest.mark.parametrize('name', PROGRAMS)
def test_help_names_a_page_of_each_program(monkeypatch, capsys, name):
    page = asked(monkeypatch, capsys, 'help', name).out.splitlines()[-1].partition('docs/')[2].partition('#')[0]
    assert name in (ROOT / 'docs' / page).read_text(encoding='utf-8')


def test_an_unknown_name_is_answered_with_the_most_similar_one(monkeypatch, capsys):
    with pytest.raises(SystemExit, match="got 'verfy'; allowed: move_base, .*; did you mean 'verify'"):
        asked(monkeypatch, capsys, 'help', 'verfy')


@pytest.mark.parametrize('name', sorted(helps.OLD_NAMES))
def test_an_old_name_says_the_new_one_and_becomes_the_program(monkeypatch, capsys, name):
    started = []
    monkeypatch.setenv('ROS_PACKAGE_PATH', str(ROOT))
    monkeypatch.setattr(os, 'execv', lambda path, words: started.append((path, words)))
    monkeypatch.setattr(loopback, 'find_executable', lambda program: program if program in PROGRAMS else None)
    with pytest.raises(SystemExit):  # as nobody became another program, `help` reads the words
        asked(monkeypatch, capsys, '/share/old/' + name, '--word')
    said = capsys.readouterr().err.splitlines()[0]
    instead = helps.OLD_NAMES[name][-1].replace('`', '')
    assert said == f'{name}: this name goes with the next release; write instead: {instead}'
    path, words = started[0]
    assert os.path.exists(path) or path in PROGRAMS
    assert words[-1] == '--word'
    assert instead in asked(monkeypatch, capsys, 'help', name).out
