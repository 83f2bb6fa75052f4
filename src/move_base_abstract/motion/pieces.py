"""Motion as pieces: the one formula for the pose and the velocity of a robot at an instant.

C++ (``src/motion/piece.h``) and the replay's JavaScript have the same formula. One table of cases holds all three
(``test/data/pieces.json``). So Python and C++ agree to the last bit, the operations stand in the same order there.
"""
from __future__ import annotations

import math
from typing import NamedTuple, Tuple

from .geometry import Pose2D

_NS_PER_S = 1e9  # a float: the difference of instants becomes one before it is divided, as in C++


class Piece(NamedTuple):
    """A span of a motion that one formula describes; it holds until the next piece begins.

    At ``begin_ns`` [ns] the robot is at ``x``, ``y`` [m] with the heading ``yaw`` [rad], in the global frame. It drives
    along the unit vector (``ux``, ``uy``) with the speed ``v`` [m/s] and the constant acceleration ``a`` [m/s^2], and
    turns at the rate ``w`` [rad/s]. A robot that drives backwards has a negative ``v``, and the vector points against
    its way. With ``k`` [1/s] > 0 speed and turn rate fall exponentially at that rate; 0: they do not.
    """

    begin_ns: int
    x: float
    y: float
    yaw: float
    ux: float
    uy: float
    v: float = 0.0
    a: float = 0.0
    w: float = 0.0
    k: float = 0.0


def pose_of(piece: Piece, now_ns: int) -> Pose2D:
    """Return the pose at ``now_ns`` [ns] of a robot that moves as ``piece`` says."""
    begin_ns, x, y, yaw, ux, uy, v, a, w, k = piece
    elapsed = (now_ns - begin_ns) / _NS_PER_S
    g = elapsed if k == 0.0 else (1.0 - math.exp(-k * elapsed)) / k
    s = v * g + 0.5 * a * elapsed * elapsed
    return Pose2D(x + s * ux, y + s * uy, yaw + w * g)


def velocity_of(piece: Piece, now_ns: int) -> Tuple[float, float]:
    """Return (forward [m/s], turning [rad/s]) in base_link at ``now_ns`` [ns], as :func:`pose_of` does."""
    elapsed = (now_ns - piece.begin_ns) / _NS_PER_S
    h = 1.0 if piece.k == 0.0 else math.exp(-piece.k * elapsed)
    return piece.v * h + piece.a * elapsed, piece.w * h
