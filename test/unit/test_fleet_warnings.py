"""Why a goal has no plan, in plain Python: each kind of planner says it, and which goal it was."""
import numpy as np
import pytest

from move_base_abstract.common.map_images import OCCUPIED
from move_base_abstract.fleet import Fleet, FleetWarning
from move_base_abstract.maps.occupancy import OccupancyMap
from move_base_abstract.scenario import make_scenario

S = 1_000_000_000
NET = 'nodes: [{name: a, x: 0, y: 0}, {name: b, x: 5, y: 0}]\nedges: [{from: b, to: a, one_way: true}]\n'
MATRIX = 'places: [{name: a, x: 0, y: 0}, {name: b, x: 5, y: 0}]\ntimes: [{from: b, to: a, seconds: 3}]\n'


def walled():
    cells = np.zeros((10, 10), np.int8)
    cells[:, 5] = OCCUPIED
    return OccupancyMap(cells, 1.0)


def fleet_of(folder, **defaults):
    for key, text in (('lanes', NET), ('travel_matrix', MATRIX)):
        (folder / key).write_text(text)
        if defaults.get('routes') in ('lanes', 'matrix') and defaults['routes'][:3] in key:
            defaults[key] = str(folder / key)
    return Fleet(make_scenario({'defaults': defaults, 'robots': [{'name': 'r', 'robot_radius': 0.4}]}),
                 occupancy=walled())


@pytest.mark.parametrize('defaults, goal, text', [
    ({'world_bounds': [-1, -2, 6, 2]}, (7, 0), 'The goal (7, 0) lies outside of world_bounds, [-1, -2, 6, 2].'),
    ({'use_map': True}, (5.5, 1), 'The goal (5.5, 1) lies in an occupied cell of the map.'),
    ({'use_map': True, 'routes': 'grid', 'start_x': 1.5, 'start_y': 1.5}, (8.5, 1.5),
     'No way leads from (1.5, 1.5) to the goal (8.5, 1.5) on the map for a robot of 0.402066 m.'),
    ({'routes': 'lanes'}, (5, 0), 'No lanes lead from (0, 0) to the goal (5, 0).'),
    ({'routes': 'lanes', 'world_bounds': [-1, -1, 1, 1]}, (5, 0),
     'The goal (5, 0) lies outside of world_bounds, [-1, -1, 1, 1].'),
    ({'routes': 'matrix'}, (5, 0), "The travel matrix has no time from 'a' to 'b'.")])
def test_a_goal_without_a_plan_has_a_reason(tmp_path, defaults, goal, text):
    fleet = fleet_of(tmp_path, **defaults)
    goal_id = fleet.robot('r').send(*goal)
    fleet.run()
    assert fleet.trace[-1].values[1] == 'ABORTED'
    assert fleet.warnings == [FleetWarning(S, 'r', goal_id, text)]


def test_a_goal_with_a_plan_has_none_and_without_a_trace_nothing_is_kept(tmp_path):
    fleet = fleet_of(tmp_path, world_bounds=[-1, -1, 6, 1])
    fleet.robot('r').send(5.0, 0.0)
    fleet.run()
    assert fleet.warnings == []
    fleet = Fleet(fleet.scenario, trace=None)
    fleet.robot('r').send(7.0, 0.0)
    fleet.run()
    assert fleet.warnings == []
