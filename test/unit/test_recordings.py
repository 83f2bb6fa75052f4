"""Recordings of several robots: what ships is whole and says what its README promises; what is wrong is named."""
import collections
import gzip
import math
from pathlib import Path

import numpy as np
import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract_calibration.csv_files import read_legs
from move_base_abstract_calibration.recordings import encounters, read_recordings

SHIPPED = Path(__file__).resolve().parents[2] / 'examples' / 'reality'
MISSION = 'run,map,kind,robots,seed,simulated_s,wall_s,legs,cycles,missed_loops,moved,load'
POSES = 'run,robot,t,x,y,yaw,v,w,goal'


@pytest.fixture(scope='module')
def shipped():
    return read_recordings(SHIPPED)


def write(folder, missions='m,yard,random,2,1,10.0,3,1,100,0,0,1.0', poses='m,0,0.5,1.0,2.0,0.0,0.1,0.0,1'):
    """Write a recording of one mission."""
    (folder / 'missions.csv').write_text('{}\n{}\n'.format(MISSION, missions))
    for name, text in (('legs', 'run,robot,goal,min_robot_dist_m\nm,0,1,2.5\nm,0,2,\n'),
                       ('poses', '{}\n{}\n'.format(POSES, poses))):
        (folder / (name + '.csv.gz')).write_bytes(gzip.compress(text.encode()))


def test_a_recording_is_read(tmp_path):
    write(tmp_path)
    missions, legs, poses = read_recordings(tmp_path)
    assert [(mission.run, mission.robots, mission.simulated_s) for mission in missions] == [('m', 2, 10.0)]
    assert poses['m', 0].tolist() == [[0.5, 1.0, 2.0, 0.0, 0.1, 0.0, 1.0]]
    assert [leg['goal'] for leg in encounters(legs, 3.0)] == ['1']
    assert encounters(legs, 2.5) == []


@pytest.mark.parametrize('changed, message', [
    ({'missions': 'm,yard,random,two,1,10.0,3,1,100,0,0,1.0'}, 'robots: got'),
    ({'missions': 'other,yard,random,2,1,10.0,3,1,100,0,0,1.0'}, 'legs.csv.gz: run: got'),
    ({'poses': 'm,0,0.5,1.0,2.0,0.0,0.1,0.0'}, 'line 2: got'),
    ({'poses': 'm,0,0.5,nan,2.0,0.0,0.1,0.0,1'}, 'line 2: got'),
])
def test_what_is_wrong_is_named(tmp_path, changed, message):
    write(tmp_path, **changed)
    with pytest.raises(ConfigurationError, match=message):
        read_recordings(tmp_path)


@pytest.mark.parametrize('data', [b'no gzip', gzip.compress(b'run,robot\n' * 9)[:-6]])
def test_a_file_that_is_not_packed_or_cut_is_named(tmp_path, data):
    write(tmp_path)
    (tmp_path / 'legs.csv.gz').write_bytes(data)
    with pytest.raises(ConfigurationError, match='legs.csv.gz: cannot be read as CSV'):
        read_recordings(tmp_path)


def test_every_mission_has_its_legs_and_the_poses_of_all_robots(shipped):
    legs = collections.Counter(leg['run'] for leg in shipped.legs)
    for mission in shipped.missions:
        assert legs[mission.run] == mission.legs
        assert mission.missed_loops <= 0.02 * mission.cycles
        for robot in range(mission.robots):
            times = shipped.poses[mission.run, robot][:, 0]
            assert np.allclose(np.diff(times), 0.5)
            assert times[-1] - times[0] >= mission.simulated_s - 1.0
    assert len(shipped.poses) == sum(mission.robots for mission in shipped.missions)


def test_the_nearest_robot_of_a_leg_is_the_one_of_the_poses(shipped):
    for leg in encounters(shipped.legs, math.inf):  # all but those that were over within a step
        own = shipped.poses[leg['run'], int(leg['robot'])]
        during = (own[:, 0] > float(leg['send_s'])) & (own[:, 0] <= float(leg['result_s']))
        others = [poses for (run, robot), poses in shipped.poses.items()
                  if run == leg['run'] and robot != int(leg['robot'])]
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
