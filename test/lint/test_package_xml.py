"""package.xml and the lists of Debian packages, tools/apt, name what is imported and what is started."""
import ast
import importlib.util
import re
import sysconfig
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = {path.parent.name for path in (ROOT / 'src').glob('*/__init__.py')}
EXAMPLES = {path.stem for path in (ROOT / 'examples').glob('*.py')}  # their tests import those beside them
INSTALLED = [*sorted(path for package in sorted(PACKAGES) for path in (ROOT / 'src' / package).rglob('*.py')),
             ROOT / 'scripts' / 'program',
             *sorted((ROOT / 'examples').glob('*.py'))]
FOR_USERS, FOR_TESTS = ('run', 'experiment', 'study', 'picture'), ('test',)  # lists of tools/apt
#: Debian's names of the keys of package.xml that are in the lists; without an entry: python3-KEY, or KEY itself
DEBIAN = {
    'actionlib': 'python3-actionlib libactionlib-dev', 'actionlib_msgs': 'libactionlib-msgs-dev ros-actionlib-msgs',
    'dynamic_reconfigure': 'libdynamic-reconfigure-config-init-mutex-dev python3-dynamic-reconfigure',
    'geometry_msgs': 'libgeometry-msgs-dev ros-geometry-msgs python3-geometry-msgs', 'gtest': 'libgtest-dev',
    'message_generation': 'ros-message-generation', 'message_runtime': 'ros-message-runtime',
    'move_base_msgs': 'python3-move-base-msgs libmove-base-msgs-dev',
    'nav_msgs': 'libnav-msgs-dev ros-nav-msgs python3-nav-msgs', 'nlohmann-json-dev': 'nlohmann-json3-dev',
    'nodelet': 'libnodeletlib-dev libnodeletlib-tools', 'pluginlib': 'pluginlib-dev', 'roscpp': 'libroscpp-dev',
    'rosgraph_msgs': 'libros-rosgraph-msgs-dev', 'rostest': 'librostest-dev python3-rostest',
    'std_msgs': 'libstd-msgs-dev ros-std-msgs', 'std_srvs': 'libstd-srvs-dev python3-std-srvs',
    'tf2_ros': 'python3-tf2-ros libtf2-ros-dev', 'xmlrpcpp': 'libxmlrpcpp-dev'}
#: packages of the lists that package.xml does not name, and why
WITHOUT_KEY = {
    **dict.fromkeys(('cmake', 'g++', 'make', 'python3-catkin-pkg', 'ros-environment', 'rosout'),
                    'catkin, or the start of roscore, needs it on any system'),
    **dict.fromkeys(('python3-venv',), 'for the environment in .ws/venv that `make study` makes'),
    **dict.fromkeys(('python3-distributed', 'python3-tornado'), 'rosdep has no key for Dask'),
    **dict.fromkeys(('fonts-liberation', 'imagemagick', 'libgl1-mesa-dri', 'xvfb'), 'takes the pictures of the pages'),
    **dict.fromkeys(('chromium', 'chromium-driver'), 'shows pages to the tests; no key for Debian')}


def listed(purposes):
    """Return the Debian packages of lists, without those that they take in from others."""
    lines = [line for name in purposes for line in (ROOT / 'tools' / 'apt' / f'{name}.txt').read_text().splitlines()]
    return {line for line in lines if line[0] not in '#+'}


def named(*tags):
    """Return the keys of elements of package.xml, without those that only distributions of ROS's own have."""
    package = ElementTree.parse(ROOT / 'package.xml').getroot()
    return {element.text for tag in tags for element in package.iter(tag)
            if '$ROS_DISTRO' not in element.get('condition', '')}


def in_debian(key):
    """Return the names that a key of package.xml may have in the lists."""
    name = key.replace('_', '-')
    return set(DEBIAN.get(key, f'{name} python3-{name}').split())


def declared():
    """Return the names that package.xml says are there when the package runs, whatever their condition."""
    package = ElementTree.parse(ROOT / 'package.xml').getroot()
    return {element.text for tag in ('depend', 'exec_depend') for element in package.iter(tag)}


def only_on_pypi():
    """Return the modules that environments of their own bring, for the study and for plain Python."""
    lines = [line for path in ('src/soil_mapping/requirements.txt', 'tools/requirements-plain.txt')
             for line in (ROOT / path).read_text().splitlines()]
    return {re.match(r'[\w-]+', line).group().lower() for line in lines if line and not line.startswith('#')}


def without_rosdep():
    """Return the modules for which rosdep has no key; the list of Debian packages for experiments names them."""
    assert 'python3-distributed' in listed(['experiment'])  # which needs python3-dask
    return {'dask', 'distributed'}


def imported(path):
    """Return the first parts of the names of all modules that a file imports, wherever in it."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            found.update(alias.name.split('.')[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            found.add(node.module.split('.')[0])
    return found


def of_python_itself(module):
    try:
        spec = importlib.util.find_spec(module)
    except ValueError:  # __main__
        return True
    folder = sysconfig.get_path('stdlib')
    return spec is not None and (spec.origin in ('built-in', 'frozen') or (
        spec.origin.startswith((folder, sysconfig.get_path('platstdlib'))) and '-packages' not in spec.origin))


def wanted():
    """Return {module: the files that import it} of all that is neither Python's own nor this package's."""
    users = {}
    for path in INSTALLED:
        for module in imported(path) - PACKAGES - EXAMPLES:
            users.setdefault(module, []).append(str(path.relative_to(ROOT)))
    return {module: files for module, files in users.items() if not of_python_itself(module)}


def missing(names):
    """Return those of a mapping's keys that package.xml names neither as a ROS package nor as a Debian one."""
    there = declared()
    return {name: users for name, users in sorted(names.items())
            if name not in there and f'python3-{name.lower()}' not in there}


def test_package_xml_names_what_installed_python_imports():
    names = wanted()
    assert {'rospy', 'numpy', 'scipy', 'mesa', 'rosgraph'} <= set(names)  # the search finds something
    beside = missing(names)
    assert {name: files for name, files in beside.items() if name not in only_on_pypi() | without_rosdep()} == {}


def test_package_xml_names_what_launch_files_start():
    nodes = {}
    for path in sorted((ROOT / 'launch').rglob('*.launch')):
        for element in ElementTree.parse(path).getroot().iter('node'):
            if not element.get('pkg').startswith('$'):
                nodes.setdefault(element.get('pkg'), []).append(path.name)
    nodes.pop('move_base_abstract')
    assert missing(nodes) == {}


@pytest.mark.parametrize('name', ['python3-matplotlib', 'python3-scipy', 'rosbag', 'rosbash', 'roslaunch', 'rosmaster'])
def test_package_xml_names_programs_that_are_started_by_name_and_what_debian_has_of_the_study(name):
    assert name in declared()


@pytest.mark.parametrize('tags, lists', [
    (('buildtool_depend', 'depend', 'build_depend'), ('run',)), (('build_export_depend', 'exec_depend'), FOR_USERS),
    (('test_depend',), FOR_USERS + FOR_TESTS)])
def test_each_key_of_package_xml_is_in_the_lists_of_debian_packages(tags, lists):
    assert {key for key in named(*tags) if not in_debian(key) & listed(lists)} == set()


@pytest.mark.parametrize('lists, tags', [
    (FOR_USERS, ('buildtool_depend', 'depend', 'build_depend', 'build_export_depend', 'exec_depend')),
    (FOR_TESTS, ('exec_depend', 'test_depend'))])
def test_each_listed_debian_package_is_named_by_package_xml(lists, tags):
    assert listed(lists) - set().union(*map(in_debian, named(*tags))) - set(WITHOUT_KEY) == set()


def test_what_is_said_about_debian_packages_is_about_those_that_are_listed():
    names = set(WITHOUT_KEY).union(*(words.split() for words in DEBIAN.values()))
    assert names - listed(FOR_USERS + FOR_TESTS) == set()


def test_pip_installs_for_experiments_what_debian_does():
    found = re.search(r"'experiments': (\[.*?\])", (ROOT / 'setup.py').read_text()).group(1)
    assert {f'python3-{name}' for name in ast.literal_eval(found)} - listed(['experiment']) == set()


def test_the_version_is_the_same_everywhere():
    version = ElementTree.parse(ROOT / 'package.xml').getroot().find('version').text
    assert re.findall(r'^version: (.*)$', (ROOT / 'CITATION.cff').read_text(), re.MULTILINE) == [version]
    released = re.findall(r'^(\d+\.\d+\.\d+) \((.*)\)\n-+$', (ROOT / 'CHANGELOG.rst').read_text(), re.MULTILINE)
    assert released[0][0] == version
    assert f'date-released: {released[0][1]}\n' in (ROOT / 'CITATION.cff').read_text()
