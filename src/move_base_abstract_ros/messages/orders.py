"""Orders and tasks as messages. The core's times are integer nanoseconds."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Mapping

from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.msg import Order, OrderStop, Task
from move_base_abstract.orders.order import WORK, Order as OrderValue, Stop

from . import conversions

if TYPE_CHECKING:
    from move_base_abstract.tasks.places import Place


def to_task(task: Task, frame: str, stamp_ns: int) -> Any:
    """Return the message of a Task that arrives at ``stamp_ns`` [ns]; its pose is in the frame ``frame``."""
    return Task(conversions.to_header(frame, stamp_ns), task.task_id, task.place, conversions.to_pose(task.pose),
                conversions.to_duration(task.duration_ns), task.power, task.energy, task.priority)


def to_order(order: OrderValue, frame: str, stamp_ns: int) -> Any:
    """Return the message of an Order that arrives at ``stamp_ns`` [ns]; its poses are in the frame ``frame``."""
    deadline = conversions.to_time(0 if order.deadline_ns is None else stamp_ns + order.deadline_ns)
    return Order(conversions.to_header(frame, stamp_ns), order.order_id,
                 [OrderStop(stop.place, conversions.to_pose(stop.pose), stop.action,
                            conversions.to_duration(stop.duration_ns), stop.power, stop.energy)
                  for stop in order.stops], order.priority, deadline)


def from_order(message: Any, frame: str, places: Mapping[str, Place], now_ns: int) -> OrderValue:
    """Return the Order in a message that comes at ``now_ns`` [ns]; ``places`` is {name: Place}.

    :raises ValueError: if a pose is not a pose in the plane, or is in another frame than ``frame``.
    """
    given = message.header.frame_id.lstrip('/')
    deadline_ns = message.deadline.to_nsec()
    stops = []
    for index, stop in enumerate(message.stops):
        pose = Pose2D()
        if stop.place in places:
            pose = conversions.from_pose(conversions.to_pose(places[stop.place].pose))
        elif not stop.place:
            if given not in ('', frame):
                raise ValueError('frame: got {}; allowed: {}'.format(given, frame))
            try:
                pose = conversions.from_pose(stop.pose)
            except ValueError as error:
                raise ValueError('stops[{}]: pose: {}'.format(index, error)) from None
        stops.append(Stop(pose, stop.place, stop.action or WORK, stop.duration.to_nsec(), stop.power, stop.energy))
    return OrderValue(message.id, 0, tuple(stops), deadline_ns - now_ns if deadline_ns else None, message.priority)
