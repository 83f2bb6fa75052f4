"""The command mapf without ROS: python3 -m move_base_abstract_mapf run FOLDER PLAN."""
from .command import main

main()
