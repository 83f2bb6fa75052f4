"""Pieces of motion: the table of cases that holds the evaluators in Python, C++ and JavaScript to one another.

A case is a motion: its pieces in order, and rows of [instant (ns), x, y, yaw, forward and lateral speed, turn rate]
that hold then. Where ``exp`` takes no part, each bit counts. Its last bit may differ between machines. ``python3
THIS_FILE`` writes the cases of the laws of motion anew, if a law changes on purpose; the others were made by hand and
by chance.
"""
import json
import math
from bisect import bisect_right
from pathlib import Path

import pytest

from move_base_abstract.motion.approach import MotionPhases
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.motion.leg import Leg, MotionLimits, Tolerances
from move_base_abstract.motion.original import MAIN, RASBERRY, OriginalLaw
from move_base_abstract.motion.pace import Pace, PacedLeg, TimedLeg
from move_base_abstract.motion.phased_route import PhasedRoute
from move_base_abstract.motion.pieces import Piece, pose_of, velocity_of
from move_base_abstract.motion.planned_way import PieceLimit, PlannedWay
from move_base_abstract.motion.route import CornerLaw, Route
from move_base_abstract.motion.told import told

TABLE = Path(__file__).parents[1] / 'data' / 'pieces.json'
CASES = json.loads(TABLE.read_text())['cases']
TRIP = Pose2D(1.0, -2.0, 2.5), Pose2D(9.0, 3.0, -2.0)
CORNERS = (4.0, -1.0), (6.0, 4.5)
LIMITS, TOLERANCES = MotionLimits(1.3, 0.7, 0.9), Tolerances(0.1, 0.1)
PHASES = MotionPhases((0.1, 0.2), 0.5, 0.08, 1.2, 1.1, 0.3, 1.7)
SLOW = PlannedWay(CORNERS, (PieceLimit(2.0), PieceLimit(0.4, goes_on=True), PieceLimit(1.0, 0.5, True)))
PHASED = PhasedRoute(*TRIP, CORNERS, LIMITS, PHASES, TOLERANCES, 3)
LAWS = {
    'leg': Leg(*TRIP, LIMITS, TOLERANCES, 3),
    'leg at constant speed': Leg(*TRIP, MotionLimits(0.5), depart_ns=10 ** 12),
    'route, keep': Route(*TRIP, CORNERS, LIMITS, TOLERANCES, 3),
    'route, stop': Route(*TRIP, CORNERS, LIMITS, TOLERANCES, 3, CornerLaw.STOP),
    'limits of pieces': Route(*TRIP, SLOW, LIMITS, TOLERANCES, 3, CornerLaw.STOP),
    'phases': PHASED,
    'backwards': PHASED.going_backwards(20.0, 0.2),
    'spinning': PHASED.spinning(12.0, 0.25),
    'paced': PacedLeg(Route(*TRIP, CORNERS, LIMITS, depart_ns=3), Pace(5_000_000_007, 1.37)),
    'timed': TimedLeg(Leg(*TRIP, LIMITS, depart_ns=3), 7_000_000_001, 2),
    'original, main': OriginalLaw(MAIN).leg(*TRIP, LIMITS, 3),
    'original, rasberry': OriginalLaw(RASBERRY).leg(*TRIP, LIMITS, 3)}


def answers(pieces, now_ns):
    """Return [now_ns, x, y, yaw, forward, lateral, turning] of ``pieces`` (Piece, ...) at ``now_ns`` [ns]."""
    piece = pieces[bisect_right([one.begin_ns for one in pieces], now_ns) - 1]
    pose = pose_of(piece, now_ns)
    return [now_ns, pose.x, pose.y, pose.yaw, *velocity_of(piece, now_ns)]


@pytest.mark.parametrize('case', CASES, ids=[case['motion'] for case in CASES])
def test_the_evaluator_answers_as_the_table_says(case):
    pieces = [Piece(*numbers) for numbers in case['pieces']]
    found = [answers(pieces, row[0]) for row in case['asked']]
    if any(piece.k > 0.0 for piece in pieces):
        assert found == [pytest.approx(row, rel=1e-13, abs=1e-13) for row in case['asked']]
    else:
        assert found == case['asked']


@pytest.mark.parametrize('law', LAWS)
def test_each_law_gives_the_pieces_of_the_table_and_answers_by_them(law):
    leg, [case] = LAWS[law], [case for case in CASES if case['motion'] == law]
    pieces = told(leg)
    assert [list(piece) for piece in pieces] == [pytest.approx(piece, rel=1e-12, abs=1e-12) for piece in case['pieces']]
    begins = [piece.begin_ns for piece in pieces]
    assert begins == sorted(set(begins)) and (begins[0], begins[-1]) == (leg.depart_ns, leg.arrive_ns)
    for now_ns, x, y, yaw, *velocity in case['asked']:
        pose = leg.pose_at(now_ns)
        assert (pose.x, pose.y) == pytest.approx((x, y), abs=1e-9)
        assert math.remainder(pose.yaw - yaw, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-9)
        assert leg.velocity_at(now_ns) == pytest.approx(velocity, abs=1e-9)


def test_the_table_by_hand():
    up, down = Piece(5, 1.0, 2.0, 0.0, 0.6, 0.8, a=0.5), Piece(4_000_000_005, 3.4, 5.2, 0.0, 0.6, 0.8, v=2.0, a=-0.5)
    assert answers([up, down], 2_000_000_005)[1:] == pytest.approx([1.6, 2.8, 0.0, 1.0, 0.0, 0.0])
    assert answers([up, down], 6_000_000_005)[1:] == pytest.approx([5.2, 7.6, 0.0, 1.0, 0.0, 0.0])
    turn = Piece(0, 0.0, 0.0, 3.0, 1.0, 0.0, w=0.25)
    assert answers([turn], 2_000_000_000)[1:] == pytest.approx([0.0, 0.0, 3.5 - 2.0 * math.pi, 0.0, 0.0, 0.25])
    brake = Piece(0, 0.0, 0.0, 0.0, 0.0, -1.0, v=-3.0, w=1.0, k=2.0)
    assert answers([brake], 10 ** 18)[1:] == pytest.approx([0.0, 1.5, 0.5, 0.0, 0.0, 0.0])
    left = Piece(0, 1.0, 2.0, 0.0, 1.0, 0.0, v=2.0, w=0.5 * math.pi, k=-1.0)  # a quarter of a circle of 4 / pi m
    assert answers([left], 1_000_000_000)[1:] == pytest.approx(
        [1.0 + 4.0 / math.pi, 2.0 + 4.0 / math.pi, 0.5 * math.pi, 2.0, 0.0, 0.5 * math.pi])
    aside = Piece(0, 0.0, 0.0, 0.5 * math.pi, -0.8, 0.6, v=0.5, w=math.pi, k=-1.0)  # forward 0.3, to the left 0.4 m/s
    assert answers([aside], 2_000_000_000)[1:] == pytest.approx([0.0, 0.0, 0.5 * math.pi, 0.3, 0.4, math.pi])


def a_case(law, leg):
    """Return the case of a leg: instants around the begin of each piece, within it, and after the arrival."""
    pieces = told(leg)
    begins = [piece.begin_ns for piece in pieces]
    middles = [(one + other) // 2 for one, other in zip(begins, begins[1:])]
    instants = sorted({*begins, *middles, *(begin - 1 for begin in begins[1:]), leg.arrive_ns + 10 ** 10})
    return {'motion': law, 'pieces': pieces, 'asked': [answers(pieces, instant) for instant in instants]}


if __name__ == '__main__':
    kept = [case for case in CASES if case['motion'] not in LAWS] + [a_case(*item) for item in LAWS.items()]
    about = json.loads(TABLE.read_text())['about']
    lines = ',\n'.join(map(json.dumps, kept))
    TABLE.write_text('{"about": ' + json.dumps(about) + ',\n "cases": [\n' + lines + '\n]}\n')
