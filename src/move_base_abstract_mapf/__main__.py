"""The command mapf without ROS: python3 -m move_base_abstract_mapf run FOLDER PLAN."""
import sys

from .command import main

sys.exit(main())
