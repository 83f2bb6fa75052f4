"""What a trial is made of: whatever of it changes, complete trials are no longer taken as the new program's."""
import dataclasses
import importlib.util
import io
import json
import os
import shutil
import subprocess
import sys

import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract_experiments import records
from move_base_abstract_experiments.carrying import jobs
from move_base_abstract_experiments.description import ingredients, plan, program_files, spec, worker_files
from move_base_abstract_experiments.description.experiment import Metrics
from move_base_abstract_experiments.results import outputs, resumption, state, tables
from move_base_abstract_experiments.trials import bundle, execution
from test_experiment_outputs import ABOUT, packed

LAUNCH = """<launch>
  <arg name="world"/> <arg name="algorithm" default="greedy"/>
  <include file="$(dirname)/robots.launch"/>
  <rosparam file="$(dirname)/$(arg algorithm).yaml"/>
  <node pkg="walkers" type="coordinator.py" name="coordinator" args="--table $(find walkers)/table.csv"/>
  <node pkg="walkers" type="unused.py" name="unused"/>
  <param name="world" value="$(arg world)"/>
</launch>"""
FILES = {
    'walkers/package.xml': '<package><name>walkers</name><version>1.0.0</version><description>x</description>'
    '<maintainer email="a@example.org">a</maintainer><license>x</license></package>',
    'walkers/coordinator.py': '#!/usr/bin/env python3\nimport beside\nfrom tools.main import run\n',
    'walkers/unused.py': '#!/usr/bin/env python3\n', 'walkers/beside.py': 'import far\n', 'walkers/other.py': '',
    'walkers/table.csv': '1', 'walkers/system.launch': LAUNCH, 'walkers/robots.launch': '<launch/>',
    'walkers/greedy.yaml': 'gain: 1', 'walkers/world.yaml': 'image: world.pgm', 'walkers/world.pgm': 'P5',
    'lib/tools/__init__.py': '', 'lib/tools/main.py': 'from . import part', 'lib/tools/part.py': '',
    'lib/tools/by_name.py': '', 'lib/far.py': 'import_module("computed")', 'lib/computed.py': '', 'lib/never.py': '',
    'measure.py': 'import statistics\nimport near\n', 'near.py': '', 'input.csv': ''}
EXPERIMENT = """
experiment: walk
launch: $(find walkers)/system.launch
args: {world: '{world}'}
factors: {world: [walkers/world.yaml]}
leave_out: [unused]
metrics: measure:count
inputs: [input.csv]
"""
MATTERS = ['walkers/coordinator.py', 'walkers/beside.py', 'walkers/table.csv', 'walkers/system.launch',
           'walkers/robots.launch', 'walkers/greedy.yaml', 'walkers/world.yaml', 'walkers/world.pgm',
           'lib/tools/__init__.py', 'lib/tools/main.py', 'lib/tools/part.py', 'lib/tools/by_name.py', 'lib/far.py',
           'lib/computed.py', 'measure.py', 'near.py', 'input.csv']


def told(folder):
    """Return what a trial that was carried out in a folder says of itself."""
    with outputs.opened((folder / bundle.OUTPUTS).read_bytes()) as archive:
        return outputs.result_in(archive).written


@pytest.fixture
def workspace(tmp_path, monkeypatch):
    """A package with programs, modules elsewhere, and an experiment; gives its folder."""
    for name, text in FILES.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        path.chmod(0o755)
    (tmp_path / 'walk.yaml').write_text(EXPERIMENT)
    monkeypatch.setenv('ROS_PACKAGE_PATH', f"{tmp_path}:{os.environ.get('ROS_PACKAGE_PATH', '')}")
    monkeypatch.setenv('PYTHONPATH', f"{tmp_path / 'lib'}:{os.environ.get('PYTHONPATH', '')}")
    monkeypatch.setattr('roslaunch.substitution_args._rospack', None)  # it remembers packages
    plan.forget()
    yield tmp_path
    plan.forget()


def made_of(folder):
    """Return what the experiment's first trial is made of, looked at anew."""
    plan.forget()
    experiment = spec.read(str(folder / 'walk.yaml'))
    return plan.made_of(plan.trials(experiment)[0])


def unnoticed(workspace, names, more):
    """Return those of a workspace's files of which a trial stays the same when ``more`` is written to their end."""
    before, same = made_of(workspace), []
    for name in names:
        text = (workspace / name).read_text()
        (workspace / name).write_text(text + more)
        if made_of(workspace) == before:
            same.append(name)
        (workspace / name).write_text(text)
    assert made_of(workspace) == before
    return same


def test_whatever_a_trial_is_made_of_makes_it_another_one(workspace):
    assert unnoticed(workspace, MATTERS, '\nmore: 2') == []


def test_what_it_is_not_made_of_changes_nothing(workspace):
    names = ['walkers/other.py', 'walkers/unused.py', 'lib/never.py', 'walk.yaml']
    assert unnoticed(workspace, names, '\n# changed') == names


@pytest.mark.parametrize('quote', ['"', "'"])
def test_a_package_in_a_devel_space_leads_to_its_sources(tmp_path, quote):
    for name in ('devel/tools/__init__.py', 'src/tools/__init__.py', 'src/tools/part.py'):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    relay = tmp_path / 'devel' / 'tools' / '__init__.py'
    relay.write_text(f'# of catkin\n__extended_path = {quote}{tmp_path / "src"}{quote}.split({quote};{quote})\n')
    found = program_files.files_of_module(str(tmp_path / 'devel'), 'tools')
    assert set(found) == {str(relay), *(str(tmp_path / 'src' / 'tools' / name) for name in ('__init__.py', 'part.py'))}


def test_a_relay_and_a_link_lead_to_the_program(workspace):
    source = workspace / 'walkers' / 'coordinator.py'
    relay = workspace / 'relay'
    relay.write_text(f"#!/usr/bin/python3\npython_script = '{source}'\nexec(compile(fh.read(), python_script, 'exec'))")
    (workspace / 'link').symlink_to(relay)
    files = program_files.files_of(str(workspace / 'link'))
    assert {str(relay), str(source), str(workspace / 'walkers' / 'beside.py')} <= files


@pytest.mark.skipif(not shutil.which('cc'), reason='needs a C compiler')
def test_libraries_that_a_binary_links_count_but_for_the_systems(tmp_path):
    (tmp_path / 'far.c').write_text('int far(void) { return 1; }')
    (tmp_path / 'near.c').write_text('int far(void); int near(void) { return far(); }')
    (tmp_path / 'main.c').write_text('int near(void); int main(void) { return near(); }')
    here = ['-L', str(tmp_path), f'-Wl,-rpath,{tmp_path}']
    for words in (['-shared', '-fPIC', 'far.c', '-o', 'libfar.so'],
                  ['-shared', '-fPIC', 'near.c', '-o', 'libnear.so', *here, '-lfar'],
                  ['main.c', '-o', 'main', *here, '-lnear']):
        subprocess.run(['cc', *words], cwd=tmp_path, check=True)
    assert program_files.files_of(str(tmp_path / 'main')) == {
        str(tmp_path / name) for name in ('main', 'libnear.so', 'libfar.so')}


def test_a_command_is_made_of_the_programs_that_it_names(workspace):
    (workspace / 'walk.yaml').write_text(
        "experiment: c\ncommand: [rosrun, walkers, coordinator.py, '{seed}']\nparticipants: [/c]\n")
    before = made_of(workspace)
    (workspace / 'walkers' / 'beside.py').write_text('x = 1')
    assert made_of(workspace) != before


def job_of(folder):
    experiment = spec.read(str(folder / 'walk.yaml'))
    return jobs.make_job(plan.trials(experiment)[0])


def test_a_file_that_changes_while_the_experiment_runs_fails_the_trials_that_follow(workspace, tmp_path):
    job = job_of(workspace)
    ingredients.check(job.files)
    os.utime(workspace / 'walkers' / 'beside.py')  # touched, but the same
    ingredients.check(job.files)
    (workspace / 'walkers' / 'beside.py').write_text('x = 1')
    with pytest.raises(ingredients.ChangedError, match='beside.py is another file since the experiment was started'):
        ingredients.check(job.files)
    (tmp_path / 'trial').mkdir()
    execution.carry_out(job, str(tmp_path / 'trial'))
    about = told(tmp_path / 'trial')
    assert (about['status'], 'beside.py is another file' in about['error']) == ('failed', True)
    assert (tmp_path / 'trial' / bundle.OUTPUTS).exists()


def test_a_worker_elsewhere_with_other_files_says_so(workspace):
    files = job_of(workspace).files._replace(host='elsewhere')
    ingredients.check(files)
    (workspace / 'walkers' / 'beside.py').write_text('x = 1')
    with pytest.raises(ingredients.ChangedError, match='beside.py is another file on '):
        ingredients.check(files)
    (workspace / 'walkers' / 'beside.py').unlink()
    ingredients.check(files)


@pytest.fixture
def other_place(workspace, monkeypatch):
    """The package once more, where the worker finds it; gives (the job, that folder, what its worker says)."""
    (workspace / 'walkers' / 'binary').write_bytes(b'\x7fELF 1')
    (workspace / 'walkers' / 'binary').chmod(0o755)
    with open(workspace / 'walkers' / 'system.launch', 'w') as stream:
        stream.write(LAUNCH.replace('coordinator.py', 'binary', 1).replace('</launch>', '<node pkg="walkers" '
                                                                           'type="coordinator.py" name="c"/></launch>'))
    plan.forget()
    job = job_of(workspace)
    other = shutil.copytree(workspace, workspace / 'other')
    for name in ('ROS_PACKAGE_PATH', 'PYTHONPATH'):
        monkeypatch.setenv(name, os.environ[name].replace(str(workspace), str(other), 1))
    monkeypatch.setattr('roslaunch.substitution_args._rospack', None)
    return job, other


def test_a_worker_that_finds_the_same_programs_in_another_place_has_no_label(other_place):
    assert worker_files.check(other_place[0]) == []


@pytest.mark.parametrize('name', ['walkers/coordinator.py', 'lib/tools/by_name.py', 'walkers/robots.launch',
                                  'walkers/greedy.yaml', 'walkers/table.csv'])
def test_a_worker_that_finds_another_program_in_another_place_complains(other_place, tmp_path, name):
    job, other = other_place
    with open(other / name, 'a') as stream:
        stream.write('0\n' if name.endswith('yaml') else '\n')
    ingredients.check(job.files)  # those of who has started the experiment are as they were
    (tmp_path / 'trial').mkdir()
    execution.carry_out(job, str(tmp_path / 'trial'))
    about = told(tmp_path / 'trial')
    other_file = name.rpartition('/')[2] + ' is another file'
    what = 'the parameter /gain is another one' if name.endswith('yaml') else other_file
    assert (about['status'], f'{what} on ' in about['error']) == ('failed', True)


def test_what_only_one_side_has_or_was_built_apart_is_a_label(other_place):
    job, other = other_place
    (other / 'walkers' / 'binary').write_bytes(b'\x7fELF 2')
    (other / 'lib' / 'tools' / 'more.py').write_text('')
    (other / 'lib' / 'tools' / 'by_name.py').unlink()
    apart, own, missing = worker_files.check(job)
    assert apart.startswith('built on the worker') and apart.endswith(': binary')
    assert own.startswith('of its program only the worker has more.py (digest ')
    assert missing == 'of its files the worker has no by_name.py'


def test_programs_that_are_on_workers_only_are_told_by_their_digests(workspace, monkeypatch):
    there = os.environ['ROS_PACKAGE_PATH']
    monkeypatch.setenv('ROS_PACKAGE_PATH', '/nowhere')
    plan.forget()
    job = job_of(workspace)
    monkeypatch.setenv('ROS_PACKAGE_PATH', there)
    labels = []
    for text in ('x = 1', 'x = 2', 'x = 2'):
        (workspace / 'walkers' / 'beside.py').write_text(text)
        labels += worker_files.check(job)
    assert len(labels) == 3 and labels[0] != labels[1] == labels[2]
    assert all(label.startswith('of its program only the worker has ') for label in labels)


def resume(folder, keep_old):
    """Return (ids that are to run, what is said, plan.json's content), as when an experiment goes on."""
    plan.forget()
    experiment = spec.read(str(folder / 'walk.yaml'))
    chosen = plan.trials(experiment)
    stream = io.StringIO()
    with outputs.OutputFolder(folder / 'out') as out:
        about = plan.describe(experiment, chosen, b'')
        found = resumption.missing(chosen, out, about, keep_old, stream)
        out.write_pieces('plan.json', tables.plan_text(about))
        for one in found:
            planned = next(each for each in about.trials if each.id == one.id)
            out.put(packed([('trial.json', json.dumps({**ABOUT, **planned.written}).encode())]), 'w', 1)
        tables.write(out, about)
    return [one.id for one in found], stream.getvalue(), about


def test_trials_of_another_program_run_again_or_stay_labelled(workspace):
    (workspace / 'walk.yaml').write_text(EXPERIMENT + 'replications: 3\n')
    first, said, _ = resume(workspace, False)
    assert (len(first), said) == (3, '')
    assert resume(workspace, False)[:2] == ([], '')
    (workspace / 'walkers' / 'beside.py').write_text('x = 1')
    kept, said, about = resume(workspace, True)
    assert kept == []
    assert said == 'experiment: beside.py, computed.py, far.py have changed: 3 trials are kept, labelled\n'
    assert all('beside.py' in one.kept for one in about.trials)
    assert 'kept from before: beside.py' in (workspace / 'out' / 'trials.csv').read_text()
    assert 'kept of another program: 3' in list(state.lines(workspace / 'out'))
    again, said, about = resume(workspace, False)
    assert (again, 'have changed: 3 trials run again (--keep-old keeps them, labelled)' in said) == (first, True)
    assert not any(one.kept for one in about.trials)


def test_trials_that_cannot_be_read_run_again_and_the_user_is_told(workspace):
    (workspace / 'walk.yaml').write_text(EXPERIMENT + 'replications: 3\n')
    ids, _, _ = resume(workspace, False)
    for name in ids[1:]:
        (workspace / 'out' / 'trials' / name / 'trial.json').write_text('{"format": 0}')
    again, said, _ = resume(workspace, True)
    assert again == ids[1:]
    assert said == f"experiment: {workspace / 'out' / 'trials' / ids[1] / 'trial.json'}: 'format' must be 1, got 0; " \
                   'another version of this program wrote it: 2 trials run again\n'


def test_a_trial_that_has_run_twice_keeps_its_mark_whatever_is_chosen_now(workspace, monkeypatch):
    (workspace / 'walk.yaml').write_text(EXPERIMENT + 'replications: 8\nverify: 0.5\n')
    monkeypatch.setattr(plan, '_condition', lambda number, *rest: ('', 'delays')[number % 2])  # as another version may
    assert len(resume(workspace, False)[0]) == 8
    monkeypatch.setattr(plan, '_condition', lambda number, *rest: ('', 'hash')[number in (1, 3, 6)])
    none, said, about = resume(workspace, True)
    assert (none, said) == ([], '') and not any(one.kept for one in about.trials)
    again, said, _ = resume(workspace, False)
    assert [one[:4] for one in again] == ['0006']
    assert said == 'experiment: 1 trial that has run once shall run twice (verify): it runs again (--keep-old keeps ' \
                   'it as it is)\n'
    (workspace / 'walk.yaml').write_text(EXPERIMENT + 'replications: 8\n')
    monkeypatch.setattr(plan, '_condition', lambda number, *rest: '')
    assert resume(workspace, False)[:2] == ([], '')
    chosen = plan.trials(spec.read(str(workspace / 'walk.yaml')))
    assert [resumption.changed_since(str(workspace / 'out'), one, records.read_trial(
        str(workspace / 'out'), one.id)) for one in chosen] == [''] * 8


def test_rows_of_an_old_program_are_in_no_table_before_they_have_run_again(workspace, monkeypatch):
    resume(workspace, False)
    (workspace / 'walkers' / 'beside.py').write_text('x = 1')
    monkeypatch.setattr(outputs.OutputFolder, 'put', lambda *_all: None)  # it is interrupted
    resume(workspace, False)
    assert len((workspace / 'out' / 'trials.csv').read_text().splitlines()) == 1
    assert '0 of 1 trials complete' in next(state.lines(workspace / 'out'))


def test_the_commit_and_whether_it_is_changed_are_in_the_provenance(workspace):
    git = ['git', '-c', 'user.name=a', '-c', 'user.email=a@example.org', '-C', str(workspace)]
    for words in (['init', '-q'], ['add', '.'], ['commit', '-qm', 'x']):
        subprocess.run([*git, *words], check=True)
    commit = subprocess.run([*git, 'rev-parse', 'HEAD'], check=True, stdout=subprocess.PIPE).stdout.decode().strip()
    for is_dirty in (False, True):
        plan.forget()
        experiment = spec.read(str(workspace / 'walk.yaml'))
        found = plan.describe(experiment, plan.trials(experiment), b'').provenance['sources']
        assert {'folder': str(workspace), 'commit': commit, 'dirty': is_dirty} in found
        (workspace / 'new').write_text('')


def test_a_launch_file_that_is_not_here_is_no_error_before_the_check(workspace):
    (workspace / 'walk.yaml').write_text(EXPERIMENT.replace('system.launch', 'none.launch'))
    assert made_of(workspace)
    with pytest.raises(ConfigurationError, match='none.launch'):
        from move_base_abstract_experiments import sweep
        experiment = spec.read(str(workspace / 'walk.yaml'))
        sweep.check(dataclasses.replace(experiment, metrics=Metrics()), plan.trials(experiment))


def test_of_what_pip_has_installed_the_files_count_but_not_what_they_import(tmp_path, monkeypatch):
    site = tmp_path / 'site-packages'
    for path, text in (('solver/__init__.py', 'import far'), ('solver/core.py', ''), ('lonely.py', 'import far'),
                       ('far.py', '')):
        (site / path).parent.mkdir(parents=True, exist_ok=True)
        (site / path).write_text(text)
    program = tmp_path / 'main.py'
    program.write_text('import solver\nimport lonely\n')
    monkeypatch.syspath_prepend(str(site))
    wanted = {str(program), *(str(site / name) for name in ('solver/__init__.py', 'solver/core.py', 'lonely.py'))}
    assert program_files.files_of(str(program)) == wanted


def test_what_only_a_finder_knows_counts(tmp_path, monkeypatch):
    """As of `pip install -e`, which maps a package's name to a folder that may be called otherwise."""
    package, program = tmp_path / 'mine' / 'sources', tmp_path / 'program' / 'main.py'
    for folder in (package, program.parent):
        folder.mkdir(parents=True)
    (package / '__init__.py').write_text('')
    program.write_text('import mine_e, os, no_such_module\n')

    class Finder:
        """Knows one package, and fails for another one."""

        @staticmethod
        def find_spec(name, _path=None, _target=None):
            if name == 'no_such_module':
                raise ImportError(name)
            return importlib.util.spec_from_file_location(
                name, package / '__init__.py', submodule_search_locations=[str(package)]) if name == 'mine_e' else None
    monkeypatch.setattr(sys, 'meta_path', [*sys.meta_path, Finder])
    program_files.forget()
    assert program_files.files_of(str(program)) == {str(program), str(package / '__init__.py')}
