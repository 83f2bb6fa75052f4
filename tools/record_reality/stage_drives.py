"""Record how robots drive in real Stage by random velocities, walls and other robots included.

    python3 tools/record_reality/stage_drives.py PATH_OF_stage_drives test/data/stage_drives.json

Each drive is a world of 8 m x 6 m with random boxes, or a small room, and takes 60 s. It is recorded with
``interval_sim 1`` [ms] and a raster of 0.5 mm, and with Stage's defaults (100 ms, 2 cm), of which only the differences
are printed. The README says how the program stage_drives is built.
"""
import json
import math
import random
import subprocess
import sys
import tempfile
from pathlib import Path

DRIVES, SECONDS, ROW_MS = 22, 60, 500
ARENA = 20  # the first seed with three robots in a small room
COLUMNS, ROWS, SIDE = 160, 120, 0.05
# Boxes are [first column, first row, columns, rows]; Stage stretches what is drawn over the whole world.
BORDER = [[0, 0, COLUMNS, 2], [0, ROWS - 2, COLUMNS, 2], [0, 0, 2, ROWS], [COLUMNS - 2, 0, 2, ROWS]]
ROOM = [[54, 34, 52, 2], [54, 84, 52, 2], [54, 34, 2, 52], [104, 34, 2, 52]]  # of 2.4 m x 2.4 m
SHAPES = {  # the middle of each bounding box is the origin: Stage moves others there
    'box': [(0.2, 0.15), (-0.2, 0.15), (-0.2, -0.15), (0.2, -0.15)],
    'octagon': [(0.2 * math.cos(math.pi * (2 * corner + 1) / 8) / math.cos(math.pi / 8),
                 0.2 * math.sin(math.pi * (2 * corner + 1) / 8) / math.cos(math.pi / 8)) for corner in range(8)],
    'wedge': [(0.25, 0.0), (-0.25, 0.2), (-0.25, -0.2)],
}
WORLD = """resolution {resolution}
interval_sim {step}
define floor model (bitmap "walls.pgm" size [{width} {height} 1] pose [{x} {y} 0 0] boundary 0 obstacle_return 1)
floor ()
"""
ROBOT = """position (name "{name}" drive "{drive}" pose [{x:.6f} {y:.6f} 0 {degrees:.6f}]
  size [{length:.6f} {width:.6f} 0.5]
  update_interval {step} localization "odom" localization_origin [0 0 0 0] odom_error [{odom}] obstacle_return 1
  velocity_bounds [-10 10 -10 10 -10 10 -1000 1000]
  block (points {points} {corners} z [0 1]))
"""
ODOM_ERROR = (0.04, 0.0, 0.0, 1.5)  # the very shares by which Stage multiplies; the last one in degrees


def boxes_of(draw):
    """Return the boxes [first column, first row, columns, rows] of the walls: a border, boxes, and single cells."""
    boxes = [[draw.randrange(5, COLUMNS - 25), draw.randrange(5, ROWS - 25), draw.randint(2, 20), draw.randint(2, 20)]
             for _ in range(7)]
    return BORDER + boxes + [[draw.randrange(COLUMNS), draw.randrange(ROWS), 1, 1] for _ in range(6)]


def start_of(draw, boxes, taken, within):
    """Return a pose [m, m, rad] ``within`` (x, y, x, y), 0.4 m from walls and 0.8 m from the starts of others."""
    while True:
        x, y = draw.uniform(within[0], within[2]), draw.uniform(within[1], within[3])
        yaw = draw.uniform(-3.1, 3.1)
        if all(math.hypot(max(left * SIDE - x, 0.0, x - (left + columns) * SIDE),
                          max(low * SIDE - y, 0.0, y - (low + rows) * SIDE)) > 0.4 for left, low, columns, rows in boxes
               ) and all(math.hypot(x - a, y - b) > 0.8 for a, b, _ in taken):
            return [round(x, 6), round(y, 6), round(yaw, 6)]


def commands_of(draw, is_omni):
    """Return [[ms, forward, lateral, turning], ...]: arcs, straight ways, turns on the spot and stops."""
    found, now = [], 0
    while now < SECONDS * 1000:
        forward, turning = round(draw.uniform(-0.4, 0.8), 3), round(draw.uniform(-1.2, 1.2), 3)
        kind = draw.choice(['arc', 'arc', 'arc', 'straight', 'spin', 'stop'])
        lateral = round(draw.uniform(-0.4, 0.4), 3) if is_omni and kind != 'stop' else 0.0
        found.append([now, 0.0 if kind in ('spin', 'stop') else forward, lateral,
                      0.0 if kind in ('straight', 'stop') else turning])
        now += draw.randint(300, 1500)
    return found


def drive_of(seed):
    """Return one drive: its boxes, and its robots with their shapes, starts and commands."""
    draw = random.Random(seed)
    boxes, robots = boxes_of(draw) if seed < ARENA else BORDER + ROOM, []
    for number in range(3 if seed >= 17 else 1):
        is_omni = seed in (14, 15, 16, 19)
        start = start_of(draw, boxes, [robot['start'] for robot in robots],
                         (0.5, 0.5, 7.5, 5.5) if seed < ARENA else (2.8, 1.8, 5.2, 4.2))
        robots.append({'name': 'r{}'.format(number), 'shape': sorted(SHAPES)[(seed + number) % 3], 'start': start,
                       'holonomic': is_omni, 'commands': commands_of(draw, is_omni)})
    return {'seed': seed, 'boxes': boxes, 'robots': robots}


def record(program, drive, step_ms, resolution):
    """Drive in Stage; return {robot: (rows [ms, x, y, yaw, x, y, yaw of its odometry], the same of its stalls)}."""
    with tempfile.TemporaryDirectory() as folder:
        pixels = [bytearray(b'\xff' * COLUMNS) for _ in range(ROWS)]  # from the north
        for left, low, columns, rows in drive['boxes']:
            for row in range(low, low + rows):
                pixels[ROWS - 1 - row][left:left + columns] = bytes(columns)
        Path(folder, 'walls.pgm').write_bytes(b'P5 %d %d 255\n' % (COLUMNS, ROWS) + b''.join(pixels))
        width, height = COLUMNS * SIDE, ROWS * SIDE
        text = WORLD.format(resolution=resolution, step=step_ms, width=width, height=height, x=width / 2, y=height / 2)
        for robot in drive['robots']:
            points = SHAPES[robot['shape']]
            (x, y, yaw), (xs, ys) = robot['start'], zip(*points)
            text += ROBOT.format(
                name=robot['name'], drive='omni' if robot['holonomic'] else 'diff', x=x, y=y, degrees=math.degrees(yaw),
                length=max(xs) - min(xs), width=max(ys) - min(ys), step=step_ms, points=len(points),
                odom=' '.join(map(str, ODOM_ERROR)),
                corners=' '.join('point[{}] [{:.9f} {:.9f}]'.format(*(number, *point))
                                 for number, point in enumerate(points)))
        Path(folder, 'drive.world').write_text(text)
        lines = sorted((command[0], robot['name'], *command[1:])
                       for robot in drive['robots'] for command in robot['commands'])
        asked = ''.join('{} {} {} {} {}\n'.format(*line) for line in lines) + '{} end\n'.format(SECONDS * 1000)
        answer = subprocess.run([program, str(Path(folder, 'drive.world')), str(step_ms), str(ROW_MS)], input=asked,
                                stdout=subprocess.PIPE, universal_newlines=True, check=True).stdout
    found = {robot['name']: {'pose': [], 'stall': []} for robot in drive['robots']}
    for line in answer.splitlines():
        if line.startswith('@ '):
            _, ms, name, kind, *numbers = line.split()
            found[name][kind].append([int(ms), *(round(float(number), 4) for number in numbers)])
    return found


def packed(drive, fine, default):
    """Return ``drive`` with what was recorded, and print how far Stage's default is from its fine steps."""
    for robot in drive['robots']:
        rows = fine[robot['name']]
        robot['poses'] = [row[:4] for row in rows['pose']]
        robot['stalls'] = [row[:4] for row in rows['stall']]
        if not rows['stall']:  # while a robot stalls, Stage's odometry goes on
            robot['odometry'] = [[row[0], *row[4:]] for row in rows['pose']]
        gaps = [(math.dist(one[1:3], other[1:3]), abs(math.remainder(one[3] - other[3], 2.0 * math.pi)), one[0] / 1000)
                for one, other in zip(rows['pose'], default[robot['name']]['pose'])]
        print('{} {}: {} stalls; by default {} stalls, more than 1 cm or 1 deg from {} s on, at most {:.3f} m'.format(
            drive['seed'], robot['name'], len(rows['stall']), len(default[robot['name']]['stall']), next(
                (at for far, turned, at in gaps if far > 0.01 or turned > math.radians(1.0)), 'never'),
            max(gaps)[0]), flush=True)
    return drive


def main(program, path):
    """Record all drives with the program at ``program``, and write them to ``path``."""
    drives = []
    for seed in range(DRIVES):
        drive = drive_of(seed)
        drives.append(packed(drive, record(program, drive, 1, 0.0005), record(program, drive, 100, 0.02)))
    head = json.dumps({'side': SIDE, 'columns': COLUMNS, 'rows': ROWS, 'shapes': SHAPES, 'odom_error': ODOM_ERROR})
    lines = ',\n'.join(json.dumps(drive, separators=(',', ':')) for drive in drives)
    Path(path).write_text('{},\n"drives": [\n{}\n]}}\n'.format(head[:-1], lines))


if __name__ == '__main__':
    main(*sys.argv[1:])
