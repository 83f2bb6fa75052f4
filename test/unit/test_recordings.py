"""Recordings of several robots that ship: they are whole, and say what their README promises."""
import collections
import csv
import gzip
import math
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from move_base_abstract_calibration.csv_files import read_legs

SHIPPED = Path(__file__).resolve().parents[2] / 'examples' / 'reality'


@pytest.fixture(scope='module')
def shipped():
    """Return missions and legs as {column: text}, and poses: {(run, robot): array of rows t, x, y, yaw, v, w, goal}."""
    with open(SHIPPED / 'missions.csv') as missions, gzip.open(SHIPPED / 'legs.csv.gz', 'rt') as legs, \
            gzip.open(SHIPPED / 'poses.csv.gz', 'rt') as lines:
        rows = list(csv.reader(lines))
        assert rows[0] == ['run', 'robot', 't', 'x', 'y', 'yaw', 'v', 'w', 'goal']
        poses = collections.defaultdict(list)
        for run, robot, *values in rows[1:]:
            poses[run, robot].append(values)
        return SimpleNamespace(missions=list(csv.DictReader(missions)), legs=list(csv.DictReader(legs)),
                               poses={key: np.array(values, float) for key, values in poses.items()})


def encounters(legs, distance):
    """Return the rows of ``legs`` in which another robot came nearer than ``distance`` [m]."""
    return [leg for leg in legs if leg['min_robot_dist_m'] and float(leg['min_robot_dist_m']) < distance]


def test_every_mission_has_its_legs_and_the_poses_of_all_robots(shipped):
    legs = collections.Counter(leg['run'] for leg in shipped.legs)
    for mission in shipped.missions:
        assert legs[mission['run']] == int(mission['legs'])
        assert int(mission['missed_loops']) <= 0.02 * int(mission['cycles'])
        for robot in range(int(mission['robots'])):
            times = shipped.poses[mission['run'], str(robot)][:, 0]
            assert np.allclose(np.diff(times), 0.5)
            assert times[-1] - times[0] >= float(mission['simulated_s']) - 1.0
    assert len(shipped.poses) == sum(int(mission['robots']) for mission in shipped.missions)


def test_the_nearest_robot_of_a_leg_is_the_one_of_the_poses(shipped):
    for leg in encounters(shipped.legs, math.inf):  # all but those that were over within a step
        own = shipped.poses[leg['run'], leg['robot']]
        during = (own[:, 0] > float(leg['send_s'])) & (own[:, 0] <= float(leg['result_s']))
        others = [poses for (run, robot), poses in shipped.poses.items()
                  if run == leg['run'] and robot != leg['robot']]
        nearest = min((np.hypot(*(own[during, 1:3] - poses[during, 1:3]).T).min() for poses in others if during.any()),
                      default=math.inf)
        # Poses are every 0.5 s, two robots near each other at 2 m/s at most; the column is of 10 Hz.
        assert -0.02 <= nearest - float(leg['min_robot_dist_m']) <= 1.0 or not during.any()


def test_there_are_as_many_encounters_turns_and_narrow_passages_as_the_readme_says(shipped):
    assert len(encounters(shipped.legs, 3.0)) >= 177
    assert len(encounters(shipped.legs, 1.5)) >= 129
    assert sum(float(leg['start_turn_rad'] or 0.0) > math.radians(120.0) for leg in shipped.legs) >= 122
    assert sum(float(leg['plan_clearance_m'] or 1.0) < 0.3 for leg in shipped.legs) >= 32


def test_calibrate_reads_the_legs(shipped):
    assert len(read_legs(SHIPPED / 'legs.csv.gz')) == len(shipped.legs)
