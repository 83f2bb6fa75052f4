"""The package installs, and what it installs runs with nothing of the source tree or the devel space."""
import os
import shutil
import signal
import socket
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
SPACE = ROOT / '.ws' / 'install_test'
PREFIX = SPACE / 'install'
EXECUTABLES = PREFIX / 'lib' / 'move_base_abstract'
GUARD_S = 60.0  # wall seconds; only a guard
# What another workspace, or the devel space that the tests run in, would bring along.
FOREIGN = ('CMAKE_PREFIX_PATH', 'LD_LIBRARY_PATH', 'PKG_CONFIG_PATH', 'PYTHONPATH', 'ROSLISP_PACKAGE_DIRECTORIES',
           'ROS_HOSTNAME', 'ROS_MASTER_URI', 'ROS_NAMESPACE', 'ROS_PACKAGE_PATH')


def run(*command, env=None):
    """Run a command to its end and return what it printed; its error output shows in a failure."""
    done = subprocess.run([str(word) for word in command], env=env, stdin=subprocess.DEVNULL, timeout=240.0,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
    assert done.returncode == 0, f'{command}: exit code {done.returncode}\n{done.stdout[-3000:]}\n{done.stderr[-3000:]}'
    return done.stdout


def free_port():
    """Return a free TCP port on the loopback."""
    with socket.socket() as probe:
        probe.bind(('127.0.0.1', 0))
        return probe.getsockname()[1]


@pytest.fixture(scope='session')
def clean_env():
    """The environment of a shell in which no workspace was sourced but the system's."""
    env = {key: value for key, value in os.environ.items() if key not in FOREIGN}
    noetic = Path('/opt/ros/noetic/setup.sh')
    return sourced(noetic, env) if noetic.exists() else env


def sourced(setup, env):
    """Return env as it is after sourcing a setup file in a POSIX shell."""
    text = run('/bin/sh', '-c', f'. "{setup}" && env -0', env=env)
    return dict(pair.split('=', 1) for pair in text.split('\0') if '=' in pair)


@pytest.fixture(scope='session')
def installed(clean_env):
    """Environment of a fresh install space."""
    shutil.rmtree(PREFIX, ignore_errors=True)
    run('cmake', '-S', ROOT, '-B', SPACE / 'build', f'-DCMAKE_INSTALL_PREFIX={PREFIX}',
        f'-DCATKIN_DEVEL_PREFIX={SPACE / "devel"}', f'-DPYTHON_EXECUTABLE={sys.executable}',
        '-DCMAKE_BUILD_TYPE=RelWithDebInfo', '-DCATKIN_ENABLE_TESTING=OFF', env=clean_env)
    run('cmake', '--build', SPACE / 'build', '-j2', '--target', 'install', env=clean_env)
    port = free_port()
    return {**sourced(PREFIX / 'setup.sh', clean_env), 'ROS_IP': '127.0.0.1',
            'ROS_MASTER_URI': f'http://127.0.0.1:{port}'}


def test_every_script_is_installed_and_names_catkins_python(installed):
    names = {path.name for path in (ROOT / 'scripts').iterdir() if path.is_file()}
    assert 'move_base' in names
    shebangs = {name: (EXECUTABLES / name).read_text().splitlines()[0] for name in names}
    assert shebangs == {name: f'#!{sys.executable}' for name in names}


def test_rosrun_finds_the_installed_executables(installed):
    for name in ('move_base', 'time_master'):
        path = run('rosrun', '--prefix', 'echo', 'move_base_abstract', name, env=installed).strip()
        assert path == str(EXECUTABLES / name)


def test_the_installed_python_packages_are_imported(installed):
    code = ('import move_base_abstract.msg as m, move_base_abstract.geometry as g, move_base_abstract_ros as r;'
            'print(m.__file__, g.__file__, r.__file__, sep="\\n")')
    for path in run(sys.executable, '-c', code, env=installed).split():
        assert Path(path).is_relative_to(PREFIX)


def test_every_launch_and_config_file_is_installed(installed):
    for folder in ('launch', 'config'):
        wanted = {path.relative_to(ROOT) for path in (ROOT / folder).rglob('*') if path.is_file()}
        share = PREFIX / 'share' / 'move_base_abstract'
        assert wanted == {path.relative_to(share) for path in (share / folder).rglob('*') if path.is_file()}


def test_a_stock_client_drives_one_goal_in_the_install_space(installed):
    port = installed['ROS_MASTER_URI'].rsplit(':', 1)[1]
    log_path = SPACE / 'roslaunch.log'
    with open(log_path, 'w', encoding='utf-8') as log:
        launch = subprocess.Popen(['roslaunch', '-p', port, str(HERE / 'install_space.launch')], env=installed,
                                  stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT)
    try:
        client = subprocess.run([sys.executable, str(HERE / 'drive_one_goal.py')], env=installed, timeout=GUARD_S,
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        said = client.stdout
    except subprocess.TimeoutExpired as error:
        said = f'{(error.stdout or b"").decode()}\n{error}'
    finally:
        launch.send_signal(signal.SIGINT)
        launch.wait(timeout=GUARD_S)
    assert said.strip().splitlines()[-1] == 'SUCCEEDED Goal reached.', f'{said}\n{log_path.read_text()}'
