"""What pages and targets need is there when only what they say is installed; test/tutorials runs whole tutorials so."""
import re
import subprocess
import sys
from functools import lru_cache

import bare
import imports
import pytest

for folder in ('tools', 'test/tutorials'):
    sys.path.append(str(bare.ROOT / folder))
from docs_site import reference  # noqa: E402 - from these folders
from typing_of_pages import needs, tutorials  # noqa: E402

DOCS = bare.ROOT / 'docs'
SAID = (['build'], [])  # where a page says nothing
CODE = re.compile(r'^```\w*\n(.*?)^```', re.DOTALL | re.MULTILINE)
RUN = re.compile(r'\brosrun move_base_abstract (\w+)')
STUDY = 'examples/study.py'  # the one program that is none of ROS
#: imports that are not made, or are answered by a message, where the module is missing: (our module, theirs)
OPTIONAL = {('move_base_abstract.orders.policies', 'scipy'), ('move_base_abstract.processes', 'simpy'),
            ('move_base_abstract_worlds.picture', 'matplotlib'),
            ('move_base_abstract_ros.backends.gazebo', 'gazebo_msgs')}  # Debian has no Gazebo for ROS 1
FOUND = 'import importlib.util, sys\nprint(*(name for name in sys.argv[1:] if importlib.util.find_spec(name) is None))'


def pages():
    """Return the tutorials and how-tos, and other pages that say what they need."""
    index = (DOCS / 'site' / 'index.md').read_text(encoding='utf-8')
    groups = re.findall(r'^:caption: (?:Tutorials|How to)\n(.*?)^```', index, re.DOTALL | re.MULTILINE)
    named = [bare.ROOT / f'{line}.md' for group in groups for line in group.split() if line.startswith('docs/')]
    return [*named, *(path for path in sorted(DOCS.glob('*.md')) if path not in named and
                      needs(path.read_text(encoding='utf-8')))]


def tops(found):
    """Return the modules of others in pairs (our module, theirs), without what is optional and below packages."""
    pairs = {(ours, other.partition('.')[0]) for ours, other in found}
    return {other for ours, other in pairs - OPTIONAL if other != '__main__'}


def imported_by(text):
    """Return the modules of others that programs which a text names import, and those of its own lines."""
    code = '\n'.join([*CODE.findall(text), *re.findall(r'^    (.*)$', text, re.MULTILINE)])
    programs = {name for name in RUN.findall(code) if name in imports.scripts()}
    found = set().union(*map(imports.of_program, programs | ({bare.ROOT / STUDY} if STUDY in code else set())))
    lines = re.findall(r'^(?:from|import) +([\w.]+)|\bpython3 -m +([\w.]+)', code, re.MULTILINE)
    return tops(found | {('', one) for names in lines for one in names if one})


@pytest.fixture(scope='session')
def environment(tmp_path_factory):
    """Return a function that makes the environment for targets and packages, once for all that ask for the same."""
    @lru_cache(maxsize=None)
    def make(targets, packages):
        try:
            return bare.environment(tmp_path_factory.mktemp('bare'), list(targets), packages)
        except bare.NotInstalled as error:
            pytest.skip(str(error))
    return lambda needed: make(tuple(needed[0]), tuple(needed[1]))


def missing(names, environment):
    """Return those of the modules that Python does not find in an environment."""
    done = subprocess.run(['python3', '-c', FOUND, *sorted(names)], env=environment, stdout=subprocess.PIPE, check=True,
                          text=True, cwd='/')
    return done.stdout.split()


@pytest.mark.parametrize('page', pages(), ids=lambda path: path.stem)
def test_a_page_names_the_targets_that_bring_what_its_programs_import(page, environment):
    text = page.read_text(encoding='utf-8')
    targets, packages = needs(text) or SAID
    if targets:  # elsewhere pip brings the modules
        assert missing(imported_by(text), environment((targets, packages))) == []


@pytest.mark.parametrize('page', tutorials(), ids=lambda path: path.stem)
def test_the_programs_of_a_tutorial_start_where_only_its_targets_have_run(page, environment):
    text = page.read_text(encoding='utf-8')
    for name in sorted(set(RUN.findall(text))):
        done = subprocess.run(['rosrun', 'move_base_abstract', name, '--help'], env=environment(needs(text)),
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        assert done.returncode == 0 and 'usage' in done.stdout, (name, done.stdout)


@pytest.mark.parametrize('target', ['demo', 'experiment', 'study', 'study-trial'])
def test_a_target_installs_what_its_program_imports(target, environment):
    makefile = (bare.ROOT / 'Makefile').read_text(encoding='utf-8')
    recipe = re.search(rf'^{target}:.*\n((?:\t.*\n)+)', makefile, re.MULTILINE).group(1)
    assert RUN.search(recipe) or STUDY in recipe
    assert missing(imported_by('```\n' + recipe + '```'), environment(([target], []))) == []


def test_the_site_needs_what_deps_docs_installs(environment):
    public = [f'{reference.CORE}.{room}'.rstrip('.') for room, _ in reference._rooms(reference.CORE)]
    names = tops(imports.of_modules([*public, *reference.FOR_NODES, 'move_base_abstract_experiments.command']))
    names |= {'furo', 'myst_parser', 'sphinx'}
    assert missing(names - {'simpy'}, environment((['docs'], []))) == []


def test_a_program_says_what_is_missing_and_what_to_install(environment, tmp_path):
    legs = bare.ROOT / 'examples' / 'calibration' / 'move_base_stage_legs.csv'
    plan = bare.ROOT / 'config' / 'experiments' / 'patrol.yaml'
    for words in (['calibrate', legs], ['experiment', 'run', plan, '-o', 'out']):
        done = subprocess.run(['rosrun', 'move_base_abstract', *map(str, words)], env=environment(SAID), cwd=tmp_path,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        assert done.returncode == 2, done.stdout
        assert re.search('is not installed for .*make deps-experiment', done.stdout), done.stdout


def test_what_is_not_named_is_not_found(environment):
    there = environment((['build'], []))
    assert missing(['scipy', 'pandas', 'distributed', 'sphinx', 'numpy', 'rospy'], there) == [
        'distributed', 'pandas', 'scipy', 'sphinx']
    for words in (['python3', '-E', '-c', 'import scipy'], ['sphinx-build', '--version']):
        done = subprocess.run(['bash', '-c', ' '.join(words[:2]) + ' "$@"', 'bash', *words[2:]], env=there, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
        assert done.returncode and ('No module named' in done.stdout or 'not found' in done.stdout), done.stdout
    assert missing(['scipy'], environment((['deps-experiment', 'build'], []))) == []


def test_each_tutorial_says_what_it_needs():
    assert [page.stem for page in tutorials() if needs(page.read_text(encoding='utf-8')) is None] == []
