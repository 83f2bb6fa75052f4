"""A user's own sampling and allocation by name: what they decide happens, and their mistakes are told."""

import hashlib

import pytest

from move_base_abstract.common.errors import ConfigurationError
from soil_mapping.config import TrialConfig
from soil_mapping.results.trial_folder import TrialFolder, read_about

pytest.importorskip('mesa', reason='Mesa is not installed; it needs Python 3.11')
from soil_mapping.mesa_models.mesa_model import run_mesa_trial  # noqa: E402

CODE = """
class Corners:
    def __init__(self, config, seed, grid):
        self.left = [(x * grid.width_m, y * grid.height_m) for x in (0.25, 0.75) for y in (0.25, 0.75)]
    @property
    def exhausted(self):
        return not self.left
    def new_tasks(self, estimate):
        assert estimate is not None
        return [self.left.pop()] if self.left else []

class Last:
    def __init__(self, config, seed, grid):
        pass
    def allocate(self, task, queues, free_at):
        assert len(queues) == len(free_at)
        return len(queues) - 1, len(queues[-1])

class Outside(Corners):
    def new_tasks(self, estimate):
        return [(1e9, 0.0)]

class Wrong(Last):
    def allocate(self, task, queues, free_at):
        return 3, 0

class Broken(Last):
    def new_tasks(self, estimate):
        return 1 / 0

class Nothing:
    pass
"""


@pytest.fixture(autouse=True)
def module(tmp_path, monkeypatch):
    (tmp_path / 'soil_own_example.py').write_text(CODE)
    monkeypatch.syspath_prepend(tmp_path)


def run(hill, **options):
    return run_mesa_trial(TrialConfig(field='hill', cell_m=2, **options), 1, truth=hill)


def test_what_they_decide_happens_and_is_recorded(hill, tmp_path):
    names = {'sampling': 'soil_own_example:Corners', 'allocation': 'soil_own_example:Last'}
    result = run(hill, **names)
    drives = [event for event in result.events if event.event == 'allocate']
    assert [(event.robot, event.x_m, event.y_m) for event in drives] == [
        (2, 243.0, 165.0), (2, 243.0, 55.0), (2, 81.0, 165.0)] + [(2, 81.0, 55.0)] * (len(drives) == 4)
    with TrialFolder(tmp_path / 'trial') as folder:
        folder.finish(result)
    about = read_about(tmp_path / 'trial')
    assert {name: about['config'][name] for name in names} == names
    assert about['own_code'] == dict.fromkeys(names.values(), hashlib.sha256(CODE.encode()).hexdigest())
    assert TrialConfig.from_dict(about['config']).label == 'soil_own_example.Last_soil_own_example.Corners'


@pytest.mark.parametrize('options, complaint', [
    ({'sampling': 'soil_own_example:Outside'}, r'new_tasks must return places .*, got \(1000000000.0, 0.0\)'),
    ({'sampling': 'soil_own_example:Broken'}, 'new_tasks failed: ZeroDivisionError: division by zero'),
    ({'sampling': 'soil_own_example:Nothing'}, 'the class has no method new_tasks'),
    ({'sampling': 'soil_own_example:Nobody'}, 'has no class Nobody'),
    ({'sampling': 'soil_own_missing:Nobody'}, 'cannot import soil_own_missing: ModuleNotFoundError'),
    ({'allocation': 'soil_own_example:Wrong'}, r'allocate must return \(robot, place in its queue\).*, got \(3, 0\)'),
    ({'allocation': 'soil_own_example:Nothing'}, 'the class has no method allocate'),
    ({'allocation': 'none'}, "got 'none'; allowed: rr, ssi, or a class of your own as 'my_package.module:")])
def test_their_mistakes_are_told_with_their_names(hill, options, complaint):
    with pytest.raises(ConfigurationError, match=complaint):
        run(hill, **options)
