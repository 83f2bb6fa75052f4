"""package.xml names what installed programs need: what their Python imports and what launch files start."""
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
             *sorted(path for path in (ROOT / 'scripts').iterdir() if path.is_file()),
             *sorted((ROOT / 'examples').glob('*.py'))]


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
    lines = (ROOT / 'tools' / 'apt' / 'experiment.txt').read_text().splitlines()
    assert 'python3-distributed' in lines  # which needs python3-dask
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


def test_the_version_is_the_same_everywhere():
    version = ElementTree.parse(ROOT / 'package.xml').getroot().find('version').text
    assert re.findall(r'^version: (.*)$', (ROOT / 'CITATION.cff').read_text(), re.MULTILINE) == [version]
    released = re.findall(r'^(\d+\.\d+\.\d+) \((.*)\)\n-+$', (ROOT / 'CHANGELOG.rst').read_text(), re.MULTILINE)
    assert released[0][0] == version
    assert f'date-released: {released[0][1]}\n' in (ROOT / 'CITATION.cff').read_text()
