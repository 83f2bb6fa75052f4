#!/usr/bin/env python3
"""Record missions of the ranking's coordinators with real move_bases (navfn, DWA) on real Stage.

usage: python3 tools/record_reality/record_ranking.py FOLDER [JOBS | RUN]

It records five coordinators with 2 and 3 robots on two maps: all combinations once, then all a second time, and so on.
Each mission uses the unmodified ranking.launch with simulator:=false. When a mission is over, its files are written to
FOLDER/RUN: legs.csv, poses.csv and mission.csv. Missions whose files exist are not recorded again. JOBS: number of
missions at a time. RUN: record this one only. README.md says what must be built before.
"""
import itertools
import json
import math
import random
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import yaml
from legs import STEP
from record import Recording, record

_RANKING = Path(__file__).resolve().parent.parent.parent / 'examples' / 'ranking'
_MAPS = ('aisles_5', 'farm_yard')
_POLICIES = ('fixed_order', 'nearest_first', 'farthest_first', 'auction', 'batch')
_TASKS = 1  # the seed of the task set
_REPETITIONS = 8
_PHASES = 10  # steps: the coordinator starts up to this much later; the slowest timer of a costmap has 1 Hz
_PATIENCE = 120.0  # wall s for the coordinator's start, and from the end of the mission to its row
COLUMNS = ('run', 'map', 'kind', 'robots', 'seed', 'policy', 'tasks', 'repetition', 'later_s', 'mission_s', 'ended',
           'done', 'failed', 'simulated_s', 'wall_s', 'legs', 'cycles', 'missed_loops', 'moved', 'load')


def plan():
    """Yield the missions to record: {column: text}."""
    for repetition, robots, policy, name in itertools.product(range(1, _REPETITIONS + 1), (2, 3), _POLICIES, _MAPS):
        run = '{}_{}_{}_{}'.format(name, robots, policy, repetition)
        yield {'run': run, 'map': name, 'kind': 'ranking', 'robots': robots, 'seed': _TASKS, 'policy': policy,
               'tasks': _TASKS, 'repetition': repetition}


class RankingRecording(Recording):
    """One mission of a coordinator, from its programs' start to its files."""

    columns = COLUMNS

    def robot(self, number):
        """Return one of the robots."""
        from robots import WatchedRobot
        return WatchedRobot(number, self.place, self.row['run'])

    def starts(self):
        """Write the mission; return the start of each robot, (x, y, yaw in degrees)."""
        map_file = self.place.write(self.folder)
        subprocess.run([sys.executable, str(_RANKING / 'missions.py'), str(map_file), str(self.row['tasks']),
                        str(self.count), str(self.folder)], check=True)
        robots = yaml.safe_load((self.folder / 'robots.yaml').read_text())['robots']
        return [(robot['start_x'], robot['start_y'], math.degrees(robot['start_yaw'])) for robot in robots]

    def drive(self, _begin):
        """Start the coordinator, and do steps of Stage until it has written its row."""
        later = random.Random(self.row['run']).randrange(_PHASES)
        for _ in range(later):
            self.step()
        output = self.folder / 'row.jsonl'
        launch = self.programs.start(
            ['roslaunch', str(_RANKING / 'ranking.launch'), 'simulator:=false', 'mission:=' + str(self.folder),
             'policy:=' + self.row['policy'], 'output:=' + str(output)], 'ranking')
        self.pace.watch(_coordinator(launch))
        while not output.exists() and launch.poll() is None and not self._is_cut:
            if not any(robot.rows or robot.leg for robot in self.robots):
                self.pace.look_anew()  # the coordinator's connections have threads
            self.step()
        if not output.exists():
            raise RuntimeError('there is no row of the coordinator')
        self.row.update(json.loads(_text(output)), later_s='{:.1f}'.format(later * STEP))
        self.row['ended'] = int(self.row['ended'])
        launch.send_signal(signal.SIGINT)


def _coordinator(launch):
    """Wait for the coordinator; return its process number."""
    end = time.monotonic() + _PATIENCE
    while time.monotonic() < end and launch.poll() is None:
        found = subprocess.run(['pgrep', '-P', str(launch.pid), '-f', 'ranking_coordinator.py'],
                               stdout=subprocess.PIPE, check=False).stdout.split()
        if found:
            return int(found[0])
        time.sleep(STEP)
    raise RuntimeError('no coordinator')


def _text(path):
    end = time.monotonic() + _PATIENCE
    while not (path.exists() and path.read_text().endswith('\n')):
        if time.monotonic() > end:
            raise RuntimeError('{}: no row'.format(path))
        time.sleep(STEP)
    return path.read_text()


def main():
    """Record the missions that do not exist yet, each in a process of its own."""
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    results, what = Path(sys.argv[1]).resolve(), sys.argv[2] if len(sys.argv) == 3 else '1'
    rows = {row['run']: row for row in plan()}
    if what in rows:
        record(RankingRecording, rows[what], results)
        return

    def start(run):
        if not (results / run / 'mission.csv').exists():
            subprocess.run([sys.executable, __file__, str(results), run], check=False)
    with ThreadPoolExecutor(int(what)) as jobs:
        list(jobs.map(start, rows))


if __name__ == '__main__':
    main()
