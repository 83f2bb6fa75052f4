"""The package can be installed, and what it installs runs without the source tree and the devel space."""
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
from pathlib import Path

import completion
import pytest

from move_base_abstract_ros.nodes.help import scripts

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
BUILD = ROOT / '.ws' / 'build'
DEVEL = ROOT / '.ws' / 'devel'
ONE_ROBOT = """
<launch>  <!-- the smallest system that drives: a clock and one robot, both from the install space -->
  <node pkg="move_base_abstract" type="time_master" name="time_master" required="true" output="screen">
    <param name="factor" value="10"/>
  </node>
  <node pkg="move_base_abstract" type="move_base" name="move_base" required="true" output="screen"/>
  <param name="/use_sim_time" value="true"/>
</launch>
"""
PATROL = {
    'package.xml': """
<package format="2">
  <name>patrol</name> <version>0.0.0</version> <description>-</description> <license>-</license>
  <maintainer email="a@example.com">a</maintainer> <buildtool_depend>catkin</buildtool_depend>
  <depend>move_base_abstract</depend>
</package>
""",
    'CMakeLists.txt': """
cmake_minimum_required(VERSION 3.16)
project(patrol)
find_package(catkin REQUIRED COMPONENTS move_base_abstract roscpp)
catkin_package()
include_directories(${catkin_INCLUDE_DIRS})
add_executable(patrol patrol.cpp)
move_base_abstract_take_part(patrol)
target_link_libraries(patrol ${catkin_LIBRARIES})
add_executable(old EXCLUDE_FROM_ALL old.cpp)
""",
    'patrol.cpp': """
#include <ros/ros.h>
int main(int argc, char** argv) {
  ros::init(argc, argv, "patrol");
  ros::NodeHandle node;
  ros::Duration(1000.0).sleep();
}
""",
    'old.cpp': '#include <move_base_abstract/lockstep_participant.h>'}
GUARD_S = 120.0  # wall seconds; only a guard
# Variables that another workspace, or the devel space of the tests, would set.
FOREIGN = ('CMAKE_PREFIX_PATH', 'LD_LIBRARY_PATH', 'PKG_CONFIG_PATH', 'PYTHONPATH', 'ROSLISP_PACKAGE_DIRECTORIES',
           'ROS_HOSTNAME', 'ROS_MASTER_URI', 'ROS_NAMESPACE', 'ROS_PACKAGE_PATH')


def run(*command, env=None):
    """Run a command to its end and return its output; a failure shows its error output, too."""
    done = subprocess.run([str(word) for word in command], env=env, stdin=subprocess.DEVNULL, timeout=GUARD_S,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
    assert done.returncode == 0, f'{command}: exit code {done.returncode}\n{done.stdout[-3000:]}\n{done.stderr[-3000:]}'
    return done.stdout


def configured(name):
    """Return the value of a variable in CMake's cache."""
    return re.search(f'^{name}:[A-Z]+=(.*)$', (BUILD / 'CMakeCache.txt').read_text(), re.MULTILINE).group(1)


def free_port():
    """Return a free TCP port on the loopback."""
    with socket.socket() as probe:
        probe.bind(('127.0.0.1', 0))
        return probe.getsockname()[1]


@pytest.fixture(scope='session')
def clean_env():
    """Return the environment of a shell in which no workspace was sourced except the system's."""
    env = {key: value for key, value in os.environ.items() if key not in FOREIGN}
    found = [path for path in map(Path, ('/opt/ros/noetic/setup.sh', '/opt/ros/one/setup.sh')) if path.exists()]
    return sourced(found[0], env) if found else env


def sourced(setup, env):
    """Return env as it is after sourcing a setup file in a POSIX shell."""
    text = run('/bin/sh', '-c', f'. "{setup}" && env -0', env=env)
    return dict(pair.split('=', 1) for pair in text.split('\0') if '=' in pair)


@pytest.fixture(scope='session')
def prefix(clean_env, tmp_path_factory):
    """Yield a fresh install space of the build, far from the source tree, all of which rosrun searches.

    It is staged (DESTDIR), as packagers do: catkin writes to the configured prefix, whatever ``--prefix`` says.
    """
    folder = tmp_path_factory.mktemp('install_test')
    run('cmake', '--install', BUILD, env={**clean_env, 'DESTDIR': str(folder)})
    yield folder / configured('CMAKE_INSTALL_PREFIX').lstrip('/')
    shutil.rmtree(folder)


@pytest.fixture(scope='session')
def installed(clean_env, prefix):
    """Return the environment of the install space, with an address for a ROS master of its own."""
    # setup.sh holds the configured prefix; setup.bash would use its own folder.
    env = sourced(prefix / 'setup.sh', {**clean_env, '_CATKIN_SETUP_DIR': str(prefix)})
    return {**env, 'ROS_IP': '127.0.0.1', 'ROS_MASTER_URI': f'http://127.0.0.1:{free_port()}'}


def script_names():
    """Return the names of all programs that are scripts."""
    return sorted(name for name in scripts() if not name.startswith('old/'))


def test_of_our_own_headers_only_what_users_may_include_is_installed(prefix):
    """Generated headers begin with a capital letter, and do not count."""
    names = sorted(path.name for path in (prefix / 'include' / 'move_base_abstract').glob('*.h'))
    assert [name for name in names if name[0].islower()] == ['lockstep_participant.h', 'properties.h']


@pytest.mark.parametrize('name', script_names())
def test_an_installed_script_names_catkins_python(prefix, name):
    first_line = (prefix / 'lib' / 'move_base_abstract' / name).read_text().splitlines()[0]
    assert first_line == '#!' + configured('PYTHON_EXECUTABLE')


@pytest.mark.parametrize('name', ['time_master', *script_names()])
def test_rosrun_finds_one_executable_in_the_install_space(installed, prefix, name):
    found = run('rosrun', '--prefix', 'echo', 'move_base_abstract', name, env=installed)
    assert found.strip() == str(prefix / 'lib' / 'move_base_abstract' / name)


@pytest.mark.parametrize('name', ['time_master', *script_names()])
def test_rosrun_finds_one_executable_in_the_built_environment(clean_env, name):
    # If a script were executable in the source tree, too, rosrun would ask which one is meant.
    env = sourced(DEVEL / 'setup.sh', clean_env)
    found = run('rosrun', '--prefix', 'echo', 'move_base_abstract', name, env=env)
    assert found.strip() == str(DEVEL / 'lib' / 'move_base_abstract' / name)


def test_completion_offers_the_documented_programs_and_launch_files_in_the_install_space(installed):
    old = [*completion.documented('Old names'), 'sim_time_controller']
    assert completion.offered('rosrun', installed) == sorted(completion.documented('Programs') + old)
    assert completion.offered('roslaunch', installed) == completion.documented('Launch files')


def test_the_installed_python_packages_are_imported(installed, prefix):
    code = ('import move_base_abstract.msg as m, move_base_abstract.motion.geometry as g, move_base_abstract_ros as r;'
            'print(m.__file__, g.__file__, r.__file__, sep="\\n")')
    for path in run(sys.executable, '-c', code, env=installed).split():
        assert Path(path).is_relative_to(prefix)


@pytest.mark.parametrize(('package', 'folders'), [
    ('move_base_abstract_calibration', {'py.typed', 'templates'}),
    ('soil_mapping', {'py.typed', 'data', 'requirements.txt', 'constraints.txt'}),
    ('move_base_abstract_experiments', {'py.typed', 'report'})])
def test_every_file_beside_the_python_of_a_package_is_installed(prefix, package, folders):
    source = ROOT / 'src' / package
    installed, = prefix.glob(f'lib/python3*/*-packages/{package}')
    wanted = _beside_the_python(source)
    assert {path.parts[0] for path in wanted} == folders
    assert wanted == _beside_the_python(installed)


def _beside_the_python(folder):
    """Return the files below a folder except code, settings for lint, and files that tools leave."""
    return {path.relative_to(folder) for path in folder.rglob('*')
            if path.is_file() and path.suffix not in ('.py', '.pyc', '.toml')
            and not any(part.startswith('.') for part in path.relative_to(folder).parts)}


def test_an_installed_replay_shows_a_log(installed, tmp_path):
    log, page = tmp_path / 'run.jsonl', tmp_path / 'replay.html'
    log.write_text('{"event_log":1,"start_ns":0}\n{"time_ns":0,"robot":"r","kind":"stands","values":[1.0,2.0,0.0]}\n')
    run('rosrun', 'move_base_abstract', 'replay', log, '-o', page, env=installed)
    templates = ROOT / 'src' / 'move_base_abstract_replay' / 'templates'
    assert (templates / 'data.js').read_text().strip() in page.read_text()


def test_an_installed_calibration_is_found_by_its_name(installed):
    run(sys.executable, '-c', "from move_base_abstract.motion.calibration import read_calibration; "
        "assert 'Stage' in read_calibration('move_base_dwa_stage', 'x').source", env=installed)


def test_every_file_that_people_start_with_is_installed(prefix):
    for folder in ('launch', 'config', 'maps', 'worlds', 'rviz'):
        wanted = {path.relative_to(ROOT) for path in (ROOT / folder).rglob('*') if path.is_file()}
        share = prefix / 'share' / 'move_base_abstract'
        assert wanted == {path.relative_to(share) for path in (share / folder).rglob('*') if path.is_file()}


def test_a_stock_client_drives_one_goal_in_the_install_space(installed, tmp_path):
    port = installed['ROS_MASTER_URI'].rsplit(':', 1)[1]
    log_path, file = tmp_path / 'roslaunch.log', tmp_path / 'one_robot.launch'
    file.write_text(ONE_ROBOT)
    with open(log_path, 'w', encoding='utf-8') as log:
        launch = subprocess.Popen(['roslaunch', '-p', port, str(file)], env=installed,
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
    # Debian 11's rospy adds a traceback at the end of each program, since it calls a function that its Python lacks.
    assert 'SUCCEEDED Goal reached.' in said.splitlines(), f'{said}\n{log_path.read_text()}'


def test_a_users_package_takes_part_by_one_line_and_the_old_header_says_so(installed, prefix, tmp_path):
    for name, text in PATROL.items():
        (tmp_path / name).write_text(text.lstrip())
    build = tmp_path / 'build'
    run('cmake', '-S', tmp_path, '-B', build, f'-DPYTHON_EXECUTABLE={configured("PYTHON_EXECUTABLE")}', env=installed)
    run('cmake', '--build', build, env=installed)
    program = build / 'devel' / 'lib' / 'patrol' / 'patrol'
    found = [line.split()[0] for line in run('ldd', program, env=installed).splitlines() if '=>' in line]
    assert found[0] == 'libmove_base_abstract_roscpp_shim.so'
    assert f'{prefix}/lib/{found[0]} ' in run('ldd', program, env=installed)
    old = subprocess.run(['cmake', '--build', str(build), '--target', 'old'], env=installed, timeout=GUARD_S, text=True,
                         stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    assert old.returncode and 'use plain roscpp and move_base_abstract_take_part(TARGET)' in old.stdout
    port = installed['ROS_MASTER_URI'].rsplit(':', 1)[1]
    file, note = tmp_path / 'patrol.launch', tmp_path / 'end.json'
    file.write_text(f"""<launch><node pkg="move_base_abstract" type="time_master" name="time_master" required="true">
        <rosparam>{{mode: lockstep, participants: [/patrol], end_with: [/patrol], note_of_end: {note}}}</rosparam>
        </node><node pkg="patrol" type="patrol" name="patrol"/><param name="use_sim_time" value="true"/></launch>""")
    env = sourced(build / 'devel' / 'setup.sh', {**installed, '_CATKIN_SETUP_DIR': str(build / 'devel')})
    run('roslaunch', '-p', port, file, env=env)
    assert '1001' in note.read_text()
