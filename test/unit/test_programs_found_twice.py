"""A package that has several programs of one name: the user hears which one is started, and which ones are not."""
import os
import shutil

import pytest

from move_base_abstract_experiments import sweep
from move_base_abstract_experiments.description import plan as trials, spec
from move_base_abstract_ros.launching import plan, programs, roles
from strangers_package import package_fixture  # noqa: F401 - a fixture

WALKER = '#!/usr/bin/env python3\nimport rospy\n'
LAUNCH = '<launch><node pkg="of_a_stranger" type="walker.py" name="walker"/></launch>'


@pytest.fixture(name='twins')
def twins_fixture(package, monkeypatch):
    """Return the launch file of a package with two programs of one name."""
    first, _ = (package(f'{folder}/walker.py', WALKER, 0o755) for folder in ('scripts', 'old'))
    folder = os.path.dirname(os.path.dirname(first))
    monkeypatch.setenv('ROS_PACKAGE_PATH', '{}:{}'.format(folder, os.environ['ROS_PACKAGE_PATH']))
    return package('walk.launch', LAUNCH)


def said_of(path):
    return [note for note in plan.make_plan([path], plan.LaunchOptions()).notes if 'programs' in note]


def test_both_are_named_and_the_one_that_roslaunch_takes_is_started(twins):
    note, = said_of(twins)
    node, = plan.read([twins]).nodes
    taken = roles.program_of(node)
    other = taken.replace('/old/', '/scripts/') if '/old/' in taken else taken.replace('/scripts/', '/old/')
    assert note.startswith("the package 'of_a_stranger' has 2 programs 'walker.py'; /walker is {}, ".format(taken))
    assert note.endswith('and not {}. On another disk it may be another one'.format(other))


@pytest.mark.parametrize('others', [{'leave_out': ('/walker',)}, {'replace': {
    'of_a_stranger/walker.py': 'move_base_abstract/move_base'}}])
def test_nothing_is_said_of_a_program_that_is_not_started(twins, others):
    with open(twins, 'w', encoding='utf-8') as stream:
        stream.write(LAUNCH.replace('</launch>', '<node pkg="move_base_abstract" type="move_base" name="b"/></launch>'))
    notes = plan.make_plan([twins], plan.LaunchOptions(**others)).notes
    assert not any('programs' in note for note in notes)


def test_one_program_and_what_leads_to_it_is_one(twins, tmp_path):
    folder = os.path.dirname(os.path.dirname(twins))
    script, relay, link = (os.path.join(folder, *parts) for parts in (
        ('scripts', 'walker.py'), ('devel', 'walker.py'), ('bin', 'walker.py')))
    shutil.rmtree(os.path.join(folder, 'old'))
    for path in (relay, link):
        os.mkdir(os.path.dirname(path))
    with open(relay, 'w', encoding='utf-8') as stream:
        stream.write("python_script = '{}'\n".format(script))
    os.chmod(relay, 0o755)
    os.symlink(script, link)
    assert said_of(twins) == []
    assert programs.different([relay, script, link]) == [relay]


def test_a_program_that_is_installed_is_the_one(twins, monkeypatch):
    node, = plan.read([twins]).nodes
    for folder, is_told in (('/w/lib/of_a_stranger', False), ('/w/src/lib', True)):
        monkeypatch.setattr(roles.packages, 'find_node', lambda *kind, at=folder: [at + '/walker.py', '/w/walker.py'])
        assert ('2 programs' in roles.choice_of_program(node)) == is_told


def test_an_experiment_says_it_once_for_all_trials(twins):
    document = spec.checked({'experiment': 'x', 'launch': twins, 'replications': 3, 'until': {'seconds': 1}}, '/')
    note, = sweep.check(document, trials.trials(document))
    assert "has 2 programs 'walker.py'" in note
    for others in ({'leave_out': ['/walker']},
                   {'replace': {'of_a_stranger/walker.py': 'move_base_abstract/move_base'}}):
        document = spec.checked({'experiment': 'x', 'launch': twins, 'until': {'seconds': 1}, **others}, '/')
        assert sweep.check(document, trials.trials(document)) == []
