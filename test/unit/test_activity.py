"""What robots are said to do above them in RViz."""
from move_base_abstract.fleet import Fleet
from move_base_abstract.goals.activity import activity
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.scenario import make_scenario
from move_base_abstract.tasks.arrivals import Task

S = 1_000_000_000


def doing(fleet):
    return [activity(member.navigator, member.condition, member._tasks)
            for member in fleet.robots]


def test_idle_driving_waiting_working_held_and_failed():
    robots = [{'name': 'a'}, {'name': 'b'}, {'name': 'c', 'start_x': 3.0, 'failure_kind': 'stall'}]
    fleet = Fleet(make_scenario({'places': [{'name': 'dock', 'capacity': 1, 'duration': 5.0}], 'robots': robots}),
                  start_ns=0)
    assert doing(fleet) == ['idle'] * 3
    for name in 'ab':
        fleet.robot(name).send_task(Task(name, 0, 'dock', Pose2D()))
    fleet.robot('c').send(9.0, 0.0)
    fleet.run(S)
    assert doing(fleet) == ['working', 'waiting', 'driving']
    navigator = fleet.robot('c').navigator
    navigator.travel.hold('gate', S)
    assert doing(fleet)[2] == 'held: gate'
    navigator.travel.hold('yard ' + 'x' * 40, S)
    assert doing(fleet)[2] == 'held: gate, yard xxxxxxxxxxxxxxxxxxxx...'
    navigator.travel.release('yard ' + 'x' * 40, S)
    fleet.robot('c').fail('stall', 5.0)
    assert doing(fleet)[2] == 'failed: stall, held: gate'


def test_a_robot_without_places_that_has_no_goal_is_idle():
    fleet = Fleet(make_scenario({'robots': [{'name': 'a'}]}))
    assert doing(fleet) == ['idle']


def test_the_charge_of_a_battery_is_told_and_that_it_is_empty():
    fleet = Fleet(make_scenario({'robots': [{'name': 'a', 'battery_capacity': 1.0, 'battery_start': 0.5}]}), start_ns=0)
    assert doing(fleet) == ['idle, 50 %']
    fleet.robot('a').set_charge(0.0)
    assert doing(fleet) == ['battery empty, 0 %']


def test_a_robot_that_stands_at_a_charger_charges_until_it_is_full():
    fleet = Fleet(make_scenario({'zones': [{'name': 'dock', 'rectangle': [-1, -1, 1, 1], 'charger': True}],
                                 'robots': [{'name': 'a', 'battery_capacity': 1.0, 'battery_start': 0.5}]}), start_ns=0)
    fleet.run(S)
    assert doing(fleet) == ['charging, 51 %']
    fleet.run(3600 * S)
    assert doing(fleet) == ['idle, 100 %']
