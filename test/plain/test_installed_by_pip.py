"""pip installs the part in plain Python on a computer without ROS."""
import csv
import importlib.util
import os
import subprocess
import sys
import sysconfig
import venv
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
# No process can import modules of ROS, as on a computer without ROS.
NO_ROS = """
import sys
class NoRos:
    def find_spec(self, name, path=None, target=None):
        if name.split('.')[0] in ('rospy', 'roslib', 'rosgraph', 'rospkg', 'roslaunch', 'genpy', 'genmsg', 'catkin',
                                  'actionlib'):
            raise ImportError(name + ': there is no ROS')
sys.meta_path.insert(0, NoRos())
"""
MODEL = """
from move_base_abstract import Fleet, make_scenario
def run(trial):
    robots = [{'name': 'bot', 'max_speed': trial.args['speed']}]
    fleet = Fleet(make_scenario({'seed': trial.seed, 'robots': robots}))
    fleet.robot('bot').send(3.0, 4.0)
    fleet.run(until=60.0)
    fleet.write_log(trial.event_log)
    return {'cost': trial.args['speed'] * 2}
"""
EXPERIMENT = """
experiment: a model
function: model:run
args: {speed: '{speed}'}
factors: {speed: [0.5, 1.0]}
replications: 2
verify: 1
metrics: {columns: {cost: {unit: s, better: lower}}}
"""


@pytest.fixture(scope='module')
def python(tmp_path_factory):
    """Return (a Python in whose environment pip has installed this package, folder of that environment)."""
    folder = tmp_path_factory.mktemp('environment')
    # The pip of this test's own Python, below, serves the new one, too: to unpack another takes longer than to install.
    venv.create(folder, system_site_packages=True, with_pip=importlib.util.find_spec('pip') is None)
    python = str(folder / 'bin' / 'python')
    # Packages of this test's own Python, which may be in an environment of its own, come after those installed here.
    own = subprocess.run([python, '-c', 'import sysconfig; print(sysconfig.get_path("purelib"))'], check=True,
                         stdout=subprocess.PIPE, universal_newlines=True).stdout.strip()
    (Path(own) / 'tests_own.pth').write_text(sysconfig.get_path('purelib') + '\nimport no_ros\n')
    (Path(own) / 'no_ros.py').write_text(NO_ROS)
    sources = tmp_path_factory.mktemp('sources') / 'sources'
    subprocess.run(['git', 'clone', '-q', str(ROOT), str(sources)], check=True)
    # A copy of the working tree, with changes that are not committed: pip leaves build/ and *.egg-info where it builds.
    newest = [str(ROOT / name) for name in ('src', 'tools', 'setup.py', 'pyproject.toml', 'package.xml')]
    subprocess.run(['cp', '-r', *newest, str(sources)], check=True)
    subprocess.run([python, '-m', 'pip', 'install', '-q', '--no-index', '--no-deps', '--no-build-isolation',
                    '--disable-pip-version-check', str(sources)], check=True, env=plain_environment())
    return python, folder


def plain_environment():
    """Return the environment without the variables of ROS and Python."""
    return {name: value for name, value in os.environ.items() if 'ROS' not in name and 'PYTHON' not in name}


def output_of(python, *words):
    return subprocess.run([python, *map(str, words)], env=plain_environment(), stdout=subprocess.PIPE, check=True,
                          universal_newlines=True).stdout


def test_an_example_runs_without_ros(python):
    executable, folder = python
    path = output_of(executable, '-c', 'import move_base_abstract; print(move_base_abstract.__file__)')
    assert path.startswith(str(folder))
    assert output_of(executable, ROOT / 'examples' / 'plain' / 'patrol.py').splitlines()[-1].startswith('60 s: a ')


def test_a_log_is_compared_and_replayed_without_ros(python, tmp_path):
    executable, _ = python
    program = tmp_path / 'write.py'
    program.write_text("""
from move_base_abstract import Fleet, make_scenario
fleet = Fleet(make_scenario({'robots': [{'name': 'bot', 'log_motion': True}]}))
fleet.robot('bot').send(3.0, 4.0)
fleet.run(until=60.0)
fleet.write_log('run.jsonl')
import runpy, sys
sys.argv[:] = ['replay', 'run.jsonl', '-o', 'run.html']
runpy.run_module('move_base_abstract_replay', run_name='__main__')
""")
    subprocess.run([executable, str(program)], cwd=tmp_path, check=True, env=plain_environment())
    assert 'bot' in (tmp_path / 'run.html').read_text()


def test_a_scenario_is_made_and_checked_without_ros(python, tmp_path):
    executable, _ = python
    assert 'ward/scenario.yaml: 4 robots' in output_of(
        executable, '-m', 'move_base_abstract_worlds', 'make', 'ward', '--out', tmp_path / 'ward')
    assert output_of(executable, '-m', 'move_base_abstract_worlds', 'check',
                     tmp_path / 'ward' / 'scenario.yaml').endswith('nothing found\n')


@pytest.fixture(scope='module')
def experiment(python, tmp_path_factory):
    """Run an experiment of functions; return (its folder, a function that calls its command line)."""
    folder = tmp_path_factory.mktemp('experiment')
    (folder / 'model.py').write_text(MODEL)
    (folder / 'model.yaml').write_text(EXPERIMENT)

    def call(*words):
        return subprocess.run([python[0], '-m', 'move_base_abstract_experiments', *map(str, words)], cwd=folder,
                              env=plain_environment(), stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              universal_newlines=True, check=False)
    done = call('run', 'model.yaml', '-o', 'out', '--workers', '1')
    assert done.returncode == 0, done.stdout
    return folder, call


def test_an_experiment_of_functions_runs_without_ros(experiment):
    folder, call = experiment
    with open(folder / 'out' / 'trials.csv', newline='') as stream:
        rows = list(csv.DictReader(stream))
    assert [(row['status'], row['verified'], row['ended_by'], row['cost'], row['events'] > '0') for row in rows] == [
        ('complete', 'identical', 'returned', cost, True) for cost in ('1.0', '2.0') * 2]
    assert 'a model' in (folder / 'out' / 'report.html').read_text()
    again = call('run', 'model.yaml', '-o', 'out', '--workers', '1')
    assert (again.returncode, '4 of 4 trials are complete already' in again.stdout) == (0, True), again.stdout
    assert 'the same trial' in call('rerun', 'out', '1').stdout


def test_what_needs_ros_says_so(experiment):
    folder, call = experiment
    (folder / 'launch.yaml').write_text('{experiment: x, launch: x.launch}')
    done = call('run', 'launch.yaml', '-o', 'other')
    assert (done.returncode, "'launch' needs ROS" in done.stdout) == (2, True), done.stdout


def test_metadata_names_what_is_needed(python):
    executable, _ = python
    shown = output_of(executable, '-m', 'pip', 'show', 'move-base-abstract')
    assert 'Requires: ' in shown and 'PyYAML' in shown
    assert 'ros' not in shown.split('Requires: ')[1].splitlines()[0].lower()
    assert sys.version_info >= (3, 8)


def test_pip_brings_for_experiments_what_debian_does(python):
    """Tornado is left out, since pip installs it with distributed."""
    wanted = {line.strip().replace('python3-', '') for line in (ROOT / 'tools' / 'apt' / 'experiment.txt').open()
              if line.startswith('python3-')} - {'tornado'}
    brought = output_of(python[0], '-c', "import importlib.metadata as m; print(*m.requires('move_base_abstract'), "
                        "sep='\\n')").splitlines()
    names = {line.split(';')[0].strip().lower() for line in brought if 'extra' not in line or 'experiments' in line}
    assert wanted <= names
