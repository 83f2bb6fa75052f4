"""Which Pythons that a followed shell script starts are the node; read by its path, as Python itself reads it."""
import importlib.util
from pathlib import Path

import pytest

FILE = Path(__file__).resolve().parents[2] / 'src/move_base_abstract_ros/lockstep/follow/sitecustomize.py'


@pytest.fixture(scope='module')
def follow():
    spec = importlib.util.spec_from_file_location('followed', FILE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize('words, has_command', [
    ('node.py -c config.yaml', False), ('-u node.py -c x', False), ('-m node -c x', False),
    ('-W ignore n.py -c', False),
    ('-Xdev n.py', False),
    ('--check-hash-based-pycs=never n.py -c x', False),
    ('-c x', True), ('-u -c x', True), ('-uc x', True), ('-W ignore -c x', True), ('-Werror -c x', True)])
def test_a_command_is_what_comes_before_a_file(follow, words, has_command):
    assert follow._has_command(words.split()) == has_command
