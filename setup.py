"""Tell catkin which Python packages there are, and pip which of them need no ROS; not to be run by hand."""
import os
import xml.etree.ElementTree as ElementTree

from setuptools import find_packages, setup

DATA = {'move_base_abstract': ['py.typed'],
        'move_base_abstract_testing': ['py.typed'],
        'move_base_abstract_mapf': ['py.typed'],
        'move_base_abstract_calibration': ['py.typed', 'templates/*'],
        'move_base_abstract_experiments': ['py.typed', 'report/templates/*.j2'],
        'move_base_abstract_replay': ['py.typed', 'templates/*'],
        'move_base_abstract_worlds': ['py.typed'],
        'move_base_abstract_ros': ['lockstep/programs/follow/*.py'],
        'soil_mapping': ['py.typed', 'data/*.npy', 'data/*.csv', 'data/README.md', '*.txt']}
PLAIN = ('move_base_abstract', 'move_base_abstract_experiments', 'move_base_abstract_mapf',
         'move_base_abstract_replay', 'move_base_abstract_worlds')  # without ROS


def for_catkin():
    """Return the arguments of setup() with all packages; package.xml has the rest."""
    from catkin_pkg.python_setup import generate_distutils_setup
    return generate_distutils_setup(packages=find_packages('src'), package_dir={'': 'src'}, package_data=DATA)


def for_pip():
    """Return the arguments of setup() with the packages that need no ROS."""
    about = ElementTree.parse('package.xml').getroot()
    return {
        'name': 'move_base_abstract', 'version': about.find('version').text, 'license': about.find('license').text,
        'description': ' '.join(about.find('description').text.split()),
        'packages': [name for name in find_packages('src') if name.split('.')[0] in PLAIN],
        'package_dir': {'': 'src'}, 'package_data': {name: DATA[name] for name in PLAIN if name in DATA},
        'python_requires': '>=3.8',
        'install_requires': ['PyYAML', 'Jinja2', 'Pillow', 'networkx', 'numpy'],
        'extras_require': {'processes': ['simpy'],
                           'experiments': ['cryptography', 'distributed', 'matplotlib', 'pandas', 'scipy']}}


setup(**(for_pip() if 'MOVE_BASE_ABSTRACT_FOR_PIP' in os.environ else for_catkin()))
