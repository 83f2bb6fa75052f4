#!/usr/bin/env python3
"""Record missions of real move_bases (navfn, DWA) on real Stage, one after the other.

usage: python3 tools/record_reality/record.py PLAN.csv FOLDER [JOB/JOBS]

PLAN.csv has one mission per line: run,map,kind,robots,seed,simulated_s. When a mission is over, its files are written
to FOLDER/RUN: legs.csv, poses.csv and mission.csv. Missions whose files exist are not recorded again. JOB/JOBS: record
every JOBS-th mission, from the JOB-th on, for several processes at once. README.md says what must be built before.
"""
import csv
import itertools
import math
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from legs import COLUMNS, STEP
from machinery import Programs, Stage, parameters, write_world
from missions import mission, starts
from pace import Pace
from places import place

MISSION = ('run', 'map', 'kind', 'robots', 'seed', 'simulated_s', 'wall_s', 'legs', 'cycles', 'missed_loops', 'moved',
           'load')
POSES = ('run', 'robot', 't', 'x', 'y', 'yaw', 'v', 'w', 'goal')
_LIMIT = 180.0  # simulated s for a goal
_READY = 3.0  # simulated s after all robots are ready
_PATIENCE = 300.0  # wall s for the start


class Recording:
    """One mission, from its programs' start to its files."""

    columns = MISSION

    def __init__(self, row, folder):
        self.row, self.folder = row, folder
        self.place, self.count = place(row['map']), int(row['robots'])
        self.programs = Programs(folder)
        self._now, self._poses = 0.0, []
        self._is_cut = False
        self._stage = self.pace = self.robots = None

    def run(self):
        """Record the mission; return (legs, poses, mission)."""
        try:
            self._start()
            begin, wall, load = self._now, time.monotonic(), os.getloadavg()[0]
            self.drive(begin)
            for robot in self.robots:
                robot.cut(self._now)
            return self._result(self._now - begin, time.monotonic() - wall, (load + os.getloadavg()[0]) / 2.0)
        finally:
            self.programs.stop()

    def cut(self, *_):
        """End the mission at the next step, as if its time were over."""
        self._is_cut = True

    def _start(self):
        programs = self.programs
        map_file = self.place.write(self.folder)
        world = write_world(self.folder, self.place, self.starts())
        programs.start_master()
        os.environ.update(programs.environment)
        import rospy  # it reads the environment
        from robots import watch_log
        _wait_for(lambda: _master_answers(rospy))
        for name, value in parameters(self.count).items():
            rospy.set_param(name, value)
        rospy.init_node('recorder', disable_signals=True)
        self._stage = Stage(programs.start, world)
        others = programs.start_robots(map_file, self.count)
        self.robots = [self.robot(number) for number in range(self.count)]
        self._log = watch_log(self.robots)
        self._wait_until_ready(rospy)
        self.pace = Pace([self._stage.process.pid] + [process.pid for process in others])
        for _ in range(round(_READY / STEP)):
            self.step()

    def _wait_until_ready(self, rospy):
        """Let Stage do steps at real time until each move_base has its costmaps and has subscribed to goals."""
        def ready():
            self._stage.step()
            self._now = round(self._now + STEP, 1)
            return all(robot.is_heard() for robot in self.robots) and all(
                rospy.has_param('/{}/move_base/aggressive_reset/reset_distance'.format(robot.name))
                for robot in self.robots)
        _wait_for(ready)
        self._now = round(rospy.get_time(), 1)

    def step(self):
        """Do a step of Stage, and take the robots' messages about it."""
        self._stage.step()
        self._now = round(self._now + STEP, 1)
        if not self.pace.wait():
            raise RuntimeError('the programs did not come to rest')
        for robot in self.robots:
            robot.take(self._now)
        self._look_around()

    def _look_around(self):
        for one, other in itertools.permutations(self.robots, 2):
            if one.leg is not None:
                one.leg.near(math.dist(one.pose[:2], other.pose[:2]), other.number, self._now)
        if round(self._now / STEP) % 5 == 0:
            for robot in self.robots:
                self._poses.append((
                    self.row['run'], robot.number, '{:.1f}'.format(self._now), *('{:.2f}'.format(value) for value in (
                        *robot.pose, robot.v, robot.w)), robot.leg.number if robot.leg else 0))

    def starts(self):
        """Return the start of each robot, (x, y, yaw in degrees)."""
        return starts(self.place, self.count, self.row['seed'])

    def robot(self, number):
        """Return one of the robots."""
        from robots import Robot
        return Robot(number, self.place, self.row['run'])

    def drive(self, begin):
        """Send goals until the time is over; ``begin``: simulated s."""
        end = begin + float(self.row['simulated_s'])
        goals = mission(self.row['kind'], self.place, self.count, self.row['seed'])
        while self._now < end and not self._is_cut:
            self.step()
            for robot in self.robots:
                if robot.put_elsewhere_if_stuck():
                    self.pace.wait()
                    self.step()
                    robot.clear_costmaps()
                if robot.leg is not None and self._now - robot.leg.sent >= _LIMIT:
                    robot.cancel(1)
            idle = [robot.number for robot in self.robots if robot.leg is None]
            for number, kind, goal in goals.goals(idle, [robot.pose for robot in self.robots], self._now):
                self.robots[number].send(kind, goal, self._now)
                self.pace.wait()  # the goal arrives before the next step, as on a machine with time to spare
                self.robots[number].take(self._now)
    def _result(self, simulated, wall, load):
        rows = sorted((row for robot in self.robots for row in robot.rows),
                      key=lambda row: (float(row['result_s']), row['robot']))
        missed = sum(int(row['missed_loops']) for row in rows)
        cycles = round(sum(float(row['duration_s']) for row in rows) / STEP)
        values = dict(self.row, simulated_s='{:.1f}'.format(simulated), wall_s='{:.0f}'.format(wall), legs=len(rows),
                      cycles=cycles, missed_loops=missed, moved=sum(robot.moved for robot in self.robots),
                      load='{:.1f}'.format(load))
        return rows, sorted(self._poses, key=lambda pose: pose[1]), values


def _master_answers(rospy):
    try:
        rospy.get_master().getPid()
    except OSError:
        return False
    return True


def _wait_for(happens):
    end = time.monotonic() + _PATIENCE
    while not happens():
        if time.monotonic() > end:
            raise RuntimeError('not ready within {:g} s'.format(_PATIENCE))
        time.sleep(STEP)


def _write(folder, result, columns):
    """Write the files of a mission; mission.csv comes last, when all others are complete."""
    legs, poses, values = result
    for name, head, rows in (('legs', COLUMNS, [[row[column] for column in COLUMNS] for row in legs]),
                             ('poses', POSES, poses), ('mission', columns, [[values[name] for name in columns]])):
        path = folder / (name + '.csv')
        with open(str(path) + '.part', 'w', newline='') as stream:
            csv.writer(stream, lineterminator='\n').writerows([head, *rows])
        os.replace(str(path) + '.part', str(path))


def record(kind, row, results):
    """Record one mission in this process. SIGTERM cuts it, and its legs so far count."""
    folder = Path(tempfile.mkdtemp(prefix='recording_'))
    try:
        recording = kind(row, folder)
        signal.signal(signal.SIGTERM, recording.cut)
        result = recording.run()
        target = results / row['run']
        target.mkdir(parents=True, exist_ok=True)
        _write(target, result, kind.columns)
        print('{run}: {legs} legs, {simulated_s} s in {wall_s} s, {missed_loops} of {cycles} cycles missed'.format(
            **result[2]), flush=True)
    except BaseException:
        shutil.copytree(str(folder), str(results / 'failed' / '{}_{}'.format(row['run'], os.getpid())))
        raise
    finally:
        shutil.rmtree(str(folder), ignore_errors=True)


def main():
    """Record the missions of the command line, each in a process of its own."""
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    job, jobs = map(int, sys.argv[3].split('/')) if len(sys.argv) == 4 else (1, 1)
    results = Path(sys.argv[2]).resolve()
    with open(sys.argv[1], newline='') as stream:
        rows = list(csv.DictReader(stream))
    if len(rows) == 1:
        record(Recording, rows[0], results)
        return
    for row in rows[job - 1::jobs]:
        if not (results / row['run'] / 'mission.csv').exists():
            with tempfile.NamedTemporaryFile('w', suffix='.csv') as plan:
                plan.write(','.join(row) + '\n' + ','.join(row.values()) + '\n')
                plan.flush()
                subprocess.run([sys.executable, __file__, plan.name, str(results)], check=False)


if __name__ == '__main__':
    main()
