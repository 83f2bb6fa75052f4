"""Tell catkin which Python packages there are; not to be run by hand."""
from catkin_pkg.python_setup import generate_distutils_setup
from setuptools import find_packages, setup

setup(**generate_distutils_setup(
    packages=find_packages('src'),
    package_dir={'': 'src'},
    package_data={'move_base_abstract': ['py.typed'],
                  'move_base_abstract_calibration': ['templates/*'],
                  'move_base_abstract_experiments': ['report/templates/*.j2'],
                  'move_base_abstract_replay': ['templates/*'],
                  'move_base_abstract_ros': ['lockstep/programs/follow/*.py'],
                  'soil_mapping': ['data/*.npy', 'data/*.csv', 'data/README.md', '*.txt']},
))
