#!/usr/bin/env python3
"""Writes simulated missions whose robots get stuck by a law that has not seen the mission.

    .ws/bin/python3 examples/ranking/held_out.py SEEDS SIMULATED.csv [FOLDER...]

FOLDERs have the recordings (default: examples/reality and examples/reality/ranking). For each mission of the last one,
how robots get stuck is fitted to all other missions, and the mission runs with the seeds 0 to SEEDS - 1.
compare_rankings.py compares the table with the real missions, as the level stuck_held_out.
"""
import csv
import os
import sys
import tempfile

import plain
import yaml
from missions import make_mission

from move_base_abstract.motion.calibration import calibration_file, read_calibration
from move_base_abstract_calibration.stuck_cases import find_cases, mission_of
from move_base_abstract_calibration.stuck_fit import fit_stuck

NAME, RADIUS = 'move_base_dwa_stage', 0.46  # m; the distance of ways from occupied cells, as calibrate has it
LEVEL = 'stuck_held_out'
FOLDERS = [os.path.join(plain.PACKAGE, 'examples', 'reality', name) for name in ('', 'ranking')]


def missions_in(folder):
    """Return {mission: the row of its first recording}."""
    with open(os.path.join(folder, 'missions.csv'), newline='') as stream:
        return {mission_of(row): row for row in reversed(list(csv.DictReader(stream)))}


def main(seeds, output, *folders):
    """Fit, simulate, and write the table."""
    folders = folders or FOLDERS
    calibration = read_calibration(NAME, 'held_out')
    with open(calibration_file(NAME, 'held_out')) as stream:
        values = yaml.safe_load(stream)
    cases = find_cases(folders, calibration, calibration.encounters.radius, RADIUS)
    with open(output, 'w', newline='') as stream, tempfile.TemporaryDirectory() as folder:
        table = csv.writer(stream)
        table.writerow(['level', 'map', 'robots', 'policy', 'tasks', 'seed', 'mission_s', 'ended', 'failed'])
        for number, (mission, row) in enumerate(missions_in(folders[-1]).items()):
            path = os.path.join(folder, f'{number}.yaml')
            values['stuck'] = {'source': f'all but {mission}',
                               **fit_stuck(cases.without(mission), calibration.encounters.radius).values}
            with open(path, 'w') as file:
                yaml.safe_dump(values, file)
            plain.LEVELS[LEVEL] = {**plain.LEVELS['stuck'], 'calibration': path}
            occupancy, places = plain.map_of(row['map'])
            tasks, robots = int(row['tasks']), int(row['robots'])
            for seed in range(int(seeds)):
                result = plain.run_mission(LEVEL, row['policy'], robots, make_mission(places, tasks), occupancy, seed)
                table.writerow([LEVEL, row['map'], robots, row['policy'], tasks, seed, *result.values()])


if __name__ == '__main__':
    main(*sys.argv[1:])
