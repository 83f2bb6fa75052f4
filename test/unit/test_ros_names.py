"""Which texts are names of robots and of namespaces."""
import pytest

from move_base_abstract import Fleet, make_scenario
from move_base_abstract.common.ros_names import is_namespace, is_robot_name, natural_order


@pytest.mark.parametrize('value, robot, namespace', [
    ('robot_0', True, True), ('R2', True, True), ('', False, True), ('/', False, True), ('/a', False, True),
    ('/a/b_1/', False, True), ('a b', False, False), ('a\n', False, False), ('7up', False, False),
    ('a//b', False, False), ('//', False, False), ('a/7', False, False), ('~a', False, False), ('a-b', False, False),
    ('gr\u00fcn', False, False), ('x' * 201, False, False), (None, False, False), (['a'], False, False),
    (7, False, False)])
def test_names_are_those_of_the_ros_graph(value, robot, namespace):
    assert is_robot_name(value) is robot
    assert is_namespace(value) is namespace


def test_names_are_sorted_as_people_count_whatever_their_form():
    names = ['9', '10', '10a', 'a', 'a1', 'a1b', 'a1b2', 'ab', 'r', 'r2', 'r10', 'r_', 'r_2', 'r_2/x', 'r_10']
    assert sorted(sorted(names), key=natural_order) == names


def test_robots_of_which_one_has_the_name_of_another_and_a_number_wait_in_one_zone():
    fleet = Fleet(make_scenario({
        'robots': [{'name': 'bot1', 'max_speed': 1.0}, {'name': 'bot', 'max_speed': 1.0}],
        'zones': [{'name': 'gate', 'rectangle': [4.0, -1.0, 6.0, 1.0], 'capacity': 1}]}))
    for robot in fleet.robots:
        robot.send(10.0, 0.0)
    fleet.run()
    assert [entry.robot for entry in fleet.trace if entry.kind == 'entered'] == ['bot', 'bot1']
