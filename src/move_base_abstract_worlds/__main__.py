"""The command scenario without ROS: python3 -m move_base_abstract_worlds check FILE."""
import sys

from .command import main

sys.exit(main())
