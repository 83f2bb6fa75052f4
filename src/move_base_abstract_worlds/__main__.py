"""The command scenario without ROS: python3 -m move_base_abstract_worlds check FILE."""
from .command import main

main()
