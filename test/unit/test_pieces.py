"""Pieces of motion: the table of cases that holds the evaluators in Python, C++ and JavaScript to one another.

A case is a motion: its pieces in order, and rows of [instant (ns), x, y, yaw, forward speed, turn rate] that hold then.
Where ``exp`` takes no part, each bit counts. Its last bit may differ between machines.
"""
import json
import math
from bisect import bisect_right
from pathlib import Path

import pytest

from move_base_abstract.motion.pieces import Piece, pose_of, velocity_of

TABLE = Path(__file__).parents[1] / 'data' / 'pieces.json'
CASES = json.loads(TABLE.read_text())['cases']


def answers(pieces, now_ns):
    """Return [now_ns, x, y, yaw, forward, turning] of the motion of ``pieces`` (Piece, ...) at ``now_ns`` [ns]."""
    piece = pieces[bisect_right([one.begin_ns for one in pieces], now_ns) - 1]
    pose = pose_of(piece, now_ns)
    return [now_ns, pose.x, pose.y, pose.yaw, *velocity_of(piece, now_ns)]


@pytest.mark.parametrize('case', CASES, ids=[case['motion'] for case in CASES])
def test_the_evaluator_answers_as_the_table_says(case):
    pieces = [Piece(*numbers) for numbers in case['pieces']]
    found = [answers(pieces, row[0]) for row in case['asked']]
    if any(piece.k for piece in pieces):
        assert found == [pytest.approx(row, rel=1e-13, abs=1e-13) for row in case['asked']]
    else:
        assert found == case['asked']


def test_the_table_by_hand():
    up, down = Piece(5, 1.0, 2.0, 0.0, 0.6, 0.8, a=0.5), Piece(4_000_000_005, 3.4, 5.2, 0.0, 0.6, 0.8, v=2.0, a=-0.5)
    assert answers([up, down], 2_000_000_005)[1:] == pytest.approx([1.6, 2.8, 0.0, 1.0, 0.0])
    assert answers([up, down], 6_000_000_005)[1:] == pytest.approx([5.2, 7.6, 0.0, 1.0, 0.0])
    turn = Piece(0, 0.0, 0.0, 3.0, 1.0, 0.0, w=0.25)
    assert answers([turn], 2_000_000_000)[1:] == pytest.approx([0.0, 0.0, 3.5 - 2.0 * math.pi, 0.0, 0.25])
    brake = Piece(0, 0.0, 0.0, 0.0, 0.0, -1.0, v=-3.0, w=1.0, k=2.0)
    assert answers([brake], 10 ** 18)[1:] == pytest.approx([0.0, 1.5, 0.5, 0.0, 0.0])
