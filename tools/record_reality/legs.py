"""A leg as a row of the table: its goal, navfn's first plan, and its way by the odometry at 10 Hz."""
import math

COLUMNS = (
    'run', 'robot', 'goal', 'class', 'start_x', 'start_y', 'start_yaw', 'goal_x', 'goal_y', 'goal_yaw', 'straight_m',
    'plan_m', 'plan_turn_rad', 'plan_corners', 'plan_clearance_m', 'start_turn_rad', 'end_turn_rad', 'send_s',
    'first_plan_s', 'first_motion_s', 'in_xy_tolerance_s', 'result_s', 'duration_s', 'state', 'state_name', 'text',
    'driven_m', 'turned_rad', 'max_v', 'end_x', 'end_y', 'end_yaw', 'err_xy_m', 'err_yaw_rad', 'plans', 'recoveries',
    'min_robot_dist_m', 'cancelled', 'missed_loops', 'dwa_failures', 'reverse_s', 'rescued', 'stuck_start', 'spin_s',
    'still_s', 'nearest_robot', 'nearest_s')
STATES = {2: 'PREEMPTED', 3: 'SUCCEEDED', 4: 'ABORTED', 5: 'REJECTED', 8: 'RECALLED', 9: 'LOST'}
ABORTED = 4
STEP = 0.1  # s, of the odometry
STUCK_M = 0.05  # m: a robot that has driven less on an aborted leg may be stuck
_TOLERANCE = 0.1  # m
_REVERSE, _SPIN_V, _SPIN_W, _STILL = -0.15, 0.05, 0.15, 0.01  # m/s, m/s, rad/s, both
_SPACING, _CHORD, _SHORT, _CORNER = 0.25, 1.0, 0.8, math.radians(30.0)  # m, m, m, rad


def angle(value):
    """Return an angle in -pi..pi [rad]."""
    return math.atan2(math.sin(value), math.cos(value))


class Leg:
    """One goal under way. ``start`` and ``goal``: (x, y, yaw) [m, rad]; ``sent``: simulated s."""

    def __init__(self, number, kind, start, goal, sent):
        self.number, self.kind, self.start, self.goal, self.sent = number, kind, start, goal, sent
        self.plan, self.plans, self.recoveries, self.missed, self.failures = (), 0, 0, 0, 0
        self.first_plan = self.first_motion = self.in_tolerance = None
        self.driven = self.turned = self.max_v = self.reverse = self.spin = self.still = 0.0
        self.cancelled = 0
        self.nearest = (math.inf, None, None)  # m, robot, s
        self.pose = start

    def planned(self, points, now):
        """Note a plan of navfn, a list of (x, y) [m]."""
        self.plans += 1
        if self.first_plan is None and len(points) > 1:
            self.plan, self.first_plan = points, now

    def moved(self, pose, v, w, now):
        """Note the odometry of a step: pose (x, y, yaw), speeds v [m/s] and w [rad/s]."""
        self.driven += math.hypot(pose[0] - self.pose[0], pose[1] - self.pose[1])
        self.turned += abs(angle(pose[2] - self.pose[2]))
        self.pose = pose
        self.max_v = max(self.max_v, abs(v))
        if self.first_motion is None and max(abs(v), abs(w)) > _STILL:
            self.first_motion = now
        if self.in_tolerance is None and math.hypot(pose[0] - self.goal[0], pose[1] - self.goal[1]) <= _TOLERANCE:
            self.in_tolerance = now
        self.reverse += STEP * (v < _REVERSE)
        self.spin += STEP * (abs(v) < _SPIN_V and abs(w) > _SPIN_W)
        self.still += STEP * (self.first_motion is not None and abs(v) < _STILL and abs(w) < _STILL)

    def near(self, distance, robot, now):
        """Note the distance to another robot [m]."""
        if distance < self.nearest[0]:
            self.nearest = (distance, robot, now)

    def row(self, run, robot, result, clearance, stuck_start):
        """Return {column: text}. ``result``: (state, text, s); ``clearance(x, y)``: distance to the next wall [m]."""
        state, text, now = result
        error = math.hypot(self.pose[0] - self.goal[0], self.pose[1] - self.goal[1])
        values = {
            'run': run, 'robot': robot, 'goal': self.number, 'class': self.kind,
            'straight_m': math.hypot(self.goal[0] - self.start[0], self.goal[1] - self.start[1]), 'send_s': self.sent,
            'first_plan_s': self.first_plan, 'first_motion_s': self.first_motion,
            'in_xy_tolerance_s': self.in_tolerance, 'result_s': now, 'duration_s': now - self.sent, 'state': state,
            'state_name': STATES.get(state, str(state)), 'text': text, 'driven_m': self.driven,
            'turned_rad': self.turned, 'max_v': self.max_v, 'err_xy_m': error,
            'err_yaw_rad': abs(angle(self.pose[2] - self.goal[2])), 'plans': self.plans, 'recoveries': self.recoveries,
            'min_robot_dist_m': self.nearest[0] if self.nearest[1] is not None else None, 'cancelled': self.cancelled,
            'missed_loops': self.missed, 'dwa_failures': self.failures, 'reverse_s': self.reverse, 'rescued': 0,
            'stuck_start': int(stuck_start), 'spin_s': self.spin, 'still_s': self.still,
            'nearest_robot': self.nearest[1], 'nearest_s': self.nearest[2]}
        for name, pose in (('start', self.start), ('goal', self.goal), ('end', self.pose)):
            values.update(zip((name + '_x', name + '_y', name + '_yaw'), pose))
        values.update(describe(self.plan, self.start[2], self.goal[2], clearance))
        return {name: _text(name, values[name]) for name in COLUMNS}


def _text(name, value):
    if value is None:
        return ''
    if not isinstance(value, float):
        return str(value)
    return '{:.{}f}'.format(value, 1 if name.endswith('_s') else 2 if name in ('max_v', 'plan_clearance_m') else 3)


def describe(plan, start_yaw, goal_yaw, clearance):
    """Return {column: value} of a plan, a list of (x, y) [m]; values that are not known are None."""
    names = ('plan_m', 'plan_turn_rad', 'plan_corners', 'plan_clearance_m', 'start_turn_rad', 'end_turn_rad')
    if len(plan) < 2:
        return dict.fromkeys(names)
    length = sum(math.dist(a, b) for a, b in zip(plan, plan[1:]))
    points = _resampled(plan, _SPACING)
    changes = _changes(points, max(1, min(round(_CHORD / _SPACING), (len(points) - 1) // 2)))
    turns = (None, None)
    if length >= _SHORT:
        first, last = _point_at(plan, min(1.0, length)), _point_at(plan, max(0.0, length - 1.0))
        turns = (abs(angle(math.atan2(first[1] - plan[0][1], first[0] - plan[0][0]) - start_yaw)),
                 abs(angle(goal_yaw - math.atan2(plan[-1][1] - last[1], plan[-1][0] - last[0]))))
    return dict(zip(names, (length, sum(map(abs, changes)), _corners(changes),
                            min(clearance(x, y) for x, y in plan)) + turns))


def _point_at(plan, distance):
    for a, b in zip(plan, plan[1:]):
        piece = math.dist(a, b)
        if piece >= distance and piece > 0.0:
            return tuple(p + (q - p) * distance / piece for p, q in zip(a, b))
        distance -= piece
    return plan[-1]


def _resampled(plan, spacing):
    length = sum(math.dist(a, b) for a, b in zip(plan, plan[1:]))
    return [_point_at(plan, number * spacing) for number in range(int(length / spacing) + 1)] + [plan[-1]]


def _changes(points, reach):
    """Return the changes of direction from chord to chord, each ``reach`` points long [rad]."""
    ways = [math.atan2(b[1] - a[1], b[0] - a[0]) for a, b in zip(points[::reach], points[reach::reach]) if a != b]
    return [angle(b - a) for a, b in zip(ways, ways[1:])]


def _corners(changes):
    count, bend = 0, 0.0
    for change in changes + [0.0]:
        if change * bend > 0.0:
            bend += change
        else:
            count, bend = count + (abs(bend) >= _CORNER), change
    return count
