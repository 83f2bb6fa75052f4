"""Tests of the runner of tutorials: it finds a page whose text differs from what its commands show."""
import pytest
from typing_of_pages import ROOT, as_readers_type, differences, needs, run, steps

PAGE = ('```sh\nx=5; mkdir a; cd a\n```\n```sh\necho "$x m"; echo between; echo 0.7 s; ls ..\n```\n\n'
        'It shows\n\n```text\n%s\n```\n')


@pytest.mark.parametrize('told, is_true', [
    ('5 m\n...\n... s\na', True), ('...\na', True), ('5 m\nbetween\n...\n0.7 s\na', True),
    ('5 m\n...\n0.8 s\na', False), ('5 m\nbetween\n0.7 s', False), ('4 m\n...', False), ('between\n...', False),
    ('5 .\n...', False)])
def test_what_a_page_says_is_held_to_what_is_shown(told, is_true, tmp_path):
    (tmp_path / 'outputs').mkdir()
    (tmp_path / 'folder').mkdir()
    assert (differences(run(PAGE % told, tmp_path / 'folder', tmp_path / 'outputs')) == []) is is_true


def test_a_command_that_fails_is_an_error_that_names_it(tmp_path):
    page = '```sh\necho first\n```\n```sh\necho second >&2\nfalse\n```\n```sh\necho third\n```\n'
    with pytest.raises(AssertionError, match='exit code 1 of\necho second >&2\nfalse\n\nwhich shows\nsecond\n'):
        run(page, tmp_path, tmp_path)


@pytest.mark.parametrize('text, said', [
    ('You need: `make deps-a build`, and x.\nMore `make b`.\n', (['deps-a', 'build'], [])),
    ('# T\n\nYou need: `apt-get install a b` on Debian, else\nmuch. `make c`\n', ([], ['a', 'b'])),
    ('You need a package: `make d`.\n', None)])
def test_what_a_page_says_is_read(text, said):
    assert needs(text) == said


def test_what_a_page_without_a_target_makes_first_is_typed_first():
    page = '# T\n\nYou need: `apt-get install a`.\n\n```console\npip install PATH_OF_THE_SOURCES\n```\n```sh\nls\n```\n'
    assert [words for words, _ in steps(as_readers_type(page))] == [f'pip install {ROOT}\n', 'ls\n']
    page = page.replace('apt-get install a', 'make build')
    assert as_readers_type(page) == page
