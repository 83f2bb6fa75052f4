"""Where the nodes of the tests are that launch files name by package and type.

Completion of rosrun and roslaunch does not look into a folder that begins with a dot. The build makes a link to it in
the devel space, so `pkg="move_base_abstract" type="NAME.py"` finds them, as it finds the programs of test/cpp_nodes.
"""
import os

NODES = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), '.nodes')
