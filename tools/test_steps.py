"""The steps of `make test` and `make nightly`: each is one process that writes JUnit XML into a folder of its own."""
import re
import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
WS = ROOT / '.ws'
TEST = ROOT / 'test'
VENV_PYTHON = WS / 'venv' / 'bin' / 'python'  # the same Python, with the study's packages from PyPI
PLAIN_PYTHON = WS / 'plain' / 'bin' / 'python'  # the same Python, with the packages for processes in plain Python
INDEX = ROOT / 'docs' / 'site' / 'index.md'  # the tutorials are its first group
BARE = TEST / 'prerequisites' / 'test_bare_machine.py::test_a_command_succeeds_on_a_bare_debian'
TUTORIALS = TEST / 'tutorials' / 'test_tutorials.py'
GTESTS = ('time_master_test', 'lockstep_test', 'event_log_writer_test', 'shim_fit_test', 'shim_heap_test',
          'pending_parameters_test', 'parameters_at_start_test')
UNIT_PARTS = 3  # processes for the unit tests, so that all cores have work to the end
IMPORTS_MUCH = re.compile(r'soil|report|experiment|calibrat')  # pandas, scipy, Mesa: tests of these run in one process
# What takes longest begins first. It matters where no run in this tree has told yet how long each step takes.
LONGEST = ('unit', 'gtest_time_master_test', 'lockstep_fleet', 'experiment', 'lockstep_launch', 'browser', 'plain')
OF_THE_NIGHT = re.compile(r'^pytestmark = pytest\.mark\.night$', re.MULTILINE)
HAS_MORE_BY_NIGHT = re.compile(r'run_scenario\(|repeated\(|\.scenario\(|mark\.night|^from night import', re.MULTILINE)


@dataclass(frozen=True)
class Step:
    """One process. ``files``: what it runs, for a part of a name; ``python``: for pytest; None for a program of gtest.

    ``forks``: whether it is a fork of the runner, which has imported ROS and pytest already.
    """

    name: str
    files: tuple
    python: object = sys.executable
    forks: bool = False
    options: tuple = ()

    def words(self, results):
        """Return the command line, with its results below a folder."""
        if self.python is None:
            return [str(self.files[0]), f'--gtest_output=xml:{results / self.name}/gtest.xml']
        return [str(self.python), '-m', 'pytest', *self.pytest_words(results)]

    def pytest_words(self, results):
        """Return the arguments of pytest."""
        return ['-p', 'no:cacheprovider', '-q', *self.options, *map(str, self.files),
                f'--junitxml={results / self.name}/pytest.xml']

    def chosen(self, part):
        """Return the step with the files that a part of a name chooses; None if there are none."""
        if part in self.name:
            return self
        files = tuple(one for one in self.files if part in Path(str(one).partition('::')[0]).stem)
        return Step(self.name, files, self.python, self.forks, self.options) if files else None


def by_day():
    """Return the steps of `make test`, those that take longest first."""
    steps = [*_gtests(), *_unit(), Step('plain', (TEST / 'plain',), PLAIN_PYTHON),
             *(Step(name, (TEST / name,)) for name in ('export', 'browser', 'plugin')),
             Step('tutorials', (TEST / 'tutorials' / 'test_runner.py',)),
             Step('prerequisites', (TEST / 'prerequisites',)),
             *(_system(path) for path in _files('systems') if not OF_THE_NIGHT.search(path.read_text()))]
    rank = {name: number for number, name in enumerate(LONGEST)}
    return sorted(steps, key=lambda step: rank.get(step.name.rstrip('_0123456789'), len(rank)))


def by_night():
    """Return the steps of `make nightly`: all that has scenarios, more examples or tests that the day leaves out."""
    pages = re.findall(r'^docs/(\w+)$', INDEX.read_text().split(':caption: ')[1], re.MULTILINE)
    tutorials = [Step(f'tutorial_{page}', (f'{TUTORIALS}::test_a_tutorial_shows_what_it_says[{page}]',))
                 for page in pages]
    systems = [_system(path) for path in _files('systems') if HAS_MORE_BY_NIGHT.search(path.read_text())]
    bare = [Step(f'bare_{name}', (f'{BARE}[{name}]',)) for name in ('docs', 'tutorials_in_turn', 'demo_and_test')]
    return [*_gtests(), *_unit(), *systems, *tutorials, Step('install', (TEST / 'install',)), *bare]


def _gtests():
    folder = WS / 'devel' / 'share' / 'move_base_abstract' / 'tests'
    return [Step(f'gtest_{name}', (folder / name,), None) for name in GTESTS]


def _files(folder):
    return sorted((TEST / folder).rglob('test_*.py'))


def _unit():
    """Return the unit tests, in parts of about the same size."""
    files = sorted(_files('unit'), key=lambda path: (not IMPORTS_MUCH.search(str(path.relative_to(TEST))), path))
    sizes = [path.stat().st_size for path in files]
    parts = [[] for _ in range(UNIT_PARTS)]
    for number, path in enumerate(files):
        parts[UNIT_PARTS * sum(sizes[:number]) // sum(sizes)].append(path)
    return [Step(f'unit_{number}', tuple(files), VENV_PYTHON) for number, files in enumerate(parts, 1)]


def _system(path):
    return Step(path.stem[len('test_'):], (path,), forks=True)
