"""Types reach the users' own programs: mypy knows each public name, and finds a wrong call."""
import re
import subprocess
from pathlib import Path

import pytest

from move_base_abstract.common.lazy_exports import exports_of

ROOT = Path(__file__).resolve().parents[2]
SRC = ROOT / 'src'
MYPY = ROOT / '.ws' / 'lint' / 'bin' / 'mypy'
OURS = re.compile(r'^ *from ((?:move_base_abstract|soil_mapping)[\w.]*) import ([\w, ]+)$', re.MULTILINE)
GENERATED = ('cfg', 'msg', 'srv')  # catkin makes these modules

pytestmark = pytest.mark.skipif(not MYPY.exists(), reason='needs `make deps-lint`')


def checked(tmp_path, text):
    """Return mypy's lines on a user's program."""
    path = tmp_path / 'program.py'
    path.write_text(text)
    options = ['--strict', '--follow-imports=silent', '--config-file=', f'--cache-dir={ROOT}/.ws/mypy_cache_of_users']
    done = subprocess.run([MYPY, *options, path.name], cwd=tmp_path, env={'MYPYPATH': str(SRC)}, check=False,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    return done.stdout.splitlines()


def public_names():
    """Return [(module, name), ...]: what packages export, and what pages and examples import."""
    names = {('.'.join(path.parent.relative_to(SRC).parts), name)
             for path in SRC.rglob('__init__.py') for name in exports_of(path.read_text())}
    for path in [ROOT / 'README.md', *(ROOT / 'docs').rglob('*.md'), *(ROOT / 'examples').rglob('*.py')]:
        names |= {(module, name.strip()) for module, own in OURS.findall(path.read_text()) for name in own.split(',')
                  if not set(module.split('.')) & set(GENERATED)}
    return sorted(names)


def test_no_public_name_is_any(tmp_path):
    names = public_names()
    lines = [f'from {module} import {name} as name_{at}' for at, (module, name) in enumerate(names)]
    found = checked(tmp_path, '\n'.join([*lines, *(f'reveal_type(name_{at})' for at in range(len(names)))]))
    assert [line for line in found if ': error: ' in line] == []
    types = [line.partition('note: Revealed type is ')[2] for line in found if 'Revealed type' in line]
    assert len(types) == len(names) > 100
    assert [name for name, own in zip(names, types) if own == '"Any"'] == []


def test_a_wrong_call_of_a_user_is_an_error(tmp_path):
    lines = checked(tmp_path, """
import move_base_abstract
from move_base_abstract import Dispatch, Environment, Fleet, make_scenario
from move_base_abstract.goals import GoalState
def ended(robot: str, goal_id: str, state: GoalState, text: str, now_ns: int) -> None:
    fleet.robot(robot).send(0.0, 1)
scenario = make_scenario({'robots': [{'name': 'bot'}]}, overrides={'max_speed': 2.0})
fleet = Fleet(scenario, on_end=ended, trace=None)
fleet.at(5, lambda one: one.robot('bot').hold('lunch'))
distance: float = Environment(scenario).robot('bot').distance + Dispatch(scenario, policy='batch').run()
move_base_abstract.Flet
fleet.send('bot', '1', None, colour='red')
fleet.robot('bot').send(1.0, 2.0, colour='red')
Fleet('x.yaml')
fleet.robot('bot').pose.z
make_scenario(bots={})
""")
    wrong = ['Module has no attribute "Flet"', '"Fleet" has no attribute "send"',
             'argument "colour" for "send" of "Member"', 'Argument 1 to "Fleet"', '"Pose2D" has no attribute "z"',
             'argument "bots" for "make_scenario"']
    errors = [line for line in lines if ': error: ' in line]
    assert [part for part, line in zip(wrong, errors) if part not in line] == [], errors
    assert len(errors) == len(wrong)
