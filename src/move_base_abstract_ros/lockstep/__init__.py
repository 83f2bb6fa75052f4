"""A node takes part in lockstep, the event-driven clock, by ``lockstep.join()`` after ``rospy.init_node()``.

From then on ``rospy.sleep``, ``Rate``, ``Timer``, ``spin``, topics, services, ``wait_for_message``,
``wait_for_service`` and actionlib's clients are exact in simulated time, and the node's threads run one at a time.
docs/lockstep.md says what is part of a run and what is not.
"""
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .exchange.access import is_awaited as is_awaited, is_lockstep as is_lockstep
    from .exchange.links import repetition as repetition, sender as sender
    from .participation.joining import (
        join as join,
        leave_clock as leave_clock,
        node_is_there as node_is_there,
        participant as participant,
        take_part as take_part,
    )
    from .participation.taking_part import Participant as Participant
else:
    from move_base_abstract.common.lazy_exports import lazy_exports

    __getattr__ = lazy_exports(__name__)  # rospy comes with the first name: the launcher of a binary needs neither
