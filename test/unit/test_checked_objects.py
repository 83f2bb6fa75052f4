"""Objects and functions that a user hands in are checked at the call, as numbers are."""
import pytest

from move_base_abstract import Dispatch, Fleet, make_scenario, read_scenario
from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.orders.policies import POLICIES

SCENARIO = make_scenario({'robots': [{'name': 'bot'}], 'places': [], 'zones': [
    {'name': 'gate', 'rectangle': [4.0, -9.0, 8.0, 9.0]}]})
A_SCENARIO = 'allowed: a Scenario, as read_scenario(path) or make_scenario(dictionary) returns it'
A_MAP = 'allowed: an OccupancyMap, as load_map(read_description(path)) of maps.map_files returns it'
A_PLANNER = 'allowed: a planner, an object with corners(start, goal)'
ENTRIES = 'allowed: None, or a list of TraceEntry'
A_POLICY = 'allowed: a name, or an object with choose(question)'
CALL = 'allowed: a function that is called as {}'.format
ENDING = '(robot, goal_id, state, text, now_ns)'


@pytest.mark.parametrize('call, text', [
    (lambda: Fleet('x.yaml'), f"scenario: got 'x.yaml'; {A_SCENARIO}"),
    (lambda: Fleet(None), f'scenario: got None; {A_SCENARIO}'),
    (lambda: Fleet(occupancy='m.yaml'), f"occupancy: got 'm.yaml'; {A_MAP}"),
    (lambda: Fleet(planner=3), f'planner: got 3; {A_PLANNER}'),
    (lambda: Fleet(on_end=3), 'on_end: got 3; ' + CALL('on_end' + ENDING)),
    (lambda: Fleet(on_worked='x'), "on_worked: got 'x'; " + CALL('on_worked' + ENDING)),
    (lambda: Fleet(on_event=3), 'on_event: got 3; ' + CALL('on_event(entry)')),
    (lambda: Fleet(trace=3), f'trace: got 3; {ENTRIES}'),
    (lambda: Fleet(trace='x'), f"trace: got 'x'; {ENTRIES}"),
    (lambda: Dispatch('x.yaml'), f"scenario: got 'x.yaml'; {A_SCENARIO}"),
    (lambda: Dispatch(SCENARIO, policy=3), f'policy: got 3; {A_POLICY}'),
    (lambda: Dispatch(SCENARIO, policy=POLICIES['nearest']), A_POLICY),
    (lambda: Dispatch(SCENARIO, seed='x'), "parameter scenario/seed: got 'x'; allowed: a whole number >= 0"),
    (lambda: Dispatch(SCENARIO, on_event=3), 'on_event: got 3; ' + CALL('on_event(entry)')),
    (lambda: SCENARIO.tasks(seed=1.5), 'parameter scenario/seed: got 1.5; allowed: a whole number >= 0'),
    (lambda: make_scenario({}, 3), 'where: got 3; allowed: a text'),
    (lambda: make_scenario({}, overrides=3), 'overrides: got 3; allowed: None, or a mapping of settings'),
    (lambda: make_scenario({}, base='x'), "base: got 'x'; allowed: None, or a mapping of settings"),
    (lambda: read_scenario(3), 'path: got 3; allowed: the path of a file'),
    (lambda: read_scenario(None), 'path: got None; allowed: the path of a file')])
def test_what_is_made_of_a_wrong_object_is_refused(call, text):
    with pytest.raises(ConfigurationError) as error:
        call()
    assert text in str(error.value)


@pytest.mark.parametrize('call, text', [
    (lambda fleet: fleet.use_map('m.yaml'), f"occupancy: got 'm.yaml'; {A_MAP}"),
    (lambda fleet: fleet.use_map(None), f'occupancy: got None; {A_MAP}'),
    (lambda fleet: fleet.at(10 ** 10, 3), 'action: got 3; ' + CALL('action(fleet)')),
    (lambda fleet: fleet.at(10 ** 10, None), 'action: got None; ' + CALL('action(fleet)')),
    (lambda fleet: fleet.robot(['bot']), "robot '['bot']' is unknown; there are: bot"),
    (lambda fleet: fleet.add(['bot']), 'bot'),
    (lambda fleet: fleet.close_zone('gate', 'no'), "closed: got 'no'; allowed: True or False"),
    (lambda fleet: fleet.close_zone(['gate']), "name: got ['gate']; allowed: a text"),
    (lambda fleet: fleet.set_zone_limit(3, 1.0), 'name: got 3; allowed: a text'),
    (lambda fleet: fleet.write_log(3), 'path: got 3; allowed: the path of a file'),
    (lambda fleet: fleet.robot('bot').cancel(5), 'goal_id: got 5; allowed: a text'),
    (lambda fleet: fleet.robot('bot').cancel_task(5), 'goal_id: got 5; allowed: a text'),
    (lambda fleet: fleet.robot('bot').release(5), 'reason: got 5; allowed: a text'),
    (lambda fleet: fleet.robot('bot').distance_to('x', 0.0), "x: got 'x'; allowed: a number"),
    (lambda fleet: fleet.robot('bot').set_tool('on'), "works: got 'on'; allowed: True or False")])
def test_a_call_with_a_wrong_object_is_refused_and_changes_nothing(call, text):
    fleet = Fleet(SCENARIO)
    before = [*fleet.trace]
    with pytest.raises(ConfigurationError) as error:
        call(fleet)
    assert text in str(error.value)
    assert fleet.run() == 1_000_000_000
    assert fleet.trace == before


def test_a_planner_or_a_policy_of_another_author_needs_only_its_method():
    class Corners:
        lacking, goes_straight = None, True

        def corners(self, _start, _goal):
            return ()

    class Choose:
        def choose(self, _question):
            return []
    fleet = Fleet(SCENARIO, planner=Corners())
    fleet.robot('bot').send(1.0, 0.0)
    fleet.run()
    assert fleet.robot('bot').pose.x == 1.0
    assert Dispatch(SCENARIO, policy=Choose()).run() == 1_000_000_000
