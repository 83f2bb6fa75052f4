"""Rows of the event log that a dispatcher writes, see :data:`.trace.ROW_KINDS`: their owner, and words in them."""
from __future__ import annotations

from typing import Any, Tuple

#: the owner of rows that belong to no robot; no name of a robot begins with a slash
DISPATCHER = '/dispatcher'
DRIVES, WORKS, DONE, LATE, FAILED = 'drives', 'works', 'done', 'late', 'failed'
LOW, IDLE = 'low', 'idle'
#: the reasons for which an order came back
ROBOT_FAILED, ROBOT_EMPTY, TAKEN = 'robot failed', 'battery empty', 'robot taken'


Row = Tuple[Any, ...]
