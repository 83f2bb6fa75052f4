"""Which texts are names of robots and of namespaces."""
import pytest

from move_base_abstract.common.ros_names import is_namespace, is_robot_name


@pytest.mark.parametrize('value, robot, namespace', [
    ('robot_0', True, True), ('R2', True, True), ('', False, True), ('/', False, True), ('/a', False, True),
    ('/a/b_1/', False, True), ('a b', False, False), ('a\n', False, False), ('7up', False, False),
    ('a//b', False, False), ('//', False, False), ('a/7', False, False), ('~a', False, False), ('a-b', False, False),
    ('gr\u00fcn', False, False), ('x' * 201, False, False), (None, False, False), (['a'], False, False),
    (7, False, False)])
def test_names_are_those_of_the_ros_graph(value, robot, namespace):
    assert is_robot_name(value) is robot
    assert is_namespace(value) is namespace
