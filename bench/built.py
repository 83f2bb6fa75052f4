"""Imported first: ends a benchmark that is run outside of the built environment."""
import importlib.util
import os
import sys

for _needed in ('rospy', 'move_base_abstract_ros', 'move_base_abstract.msg'):
    if importlib.util.find_spec(_needed) is None:
        sys.exit(f'bench/{os.path.basename(sys.argv[0])}: {_needed} is not here; run it by `make bench`, or source the '
                 'built environment first')
