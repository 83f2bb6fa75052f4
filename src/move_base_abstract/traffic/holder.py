"""A robot as one that holds places in areas, or waits for them."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Dict, Optional, Sequence, Tuple

from ..goals.events import Warned, new
from ..goals.traffic_events import Entered, Left, Places

if TYPE_CHECKING:
    from ..engine.stream import Stream
    from ..goals.navigator import Navigator
    from ..maps.lane_map import LaneMap
    from ..motion.geometry import Pose2D
    from .area import Area, Request
    from .control import Traffic
    from .spots import Standing


class Holder:
    """What a :class:`.traveller.Traveller` holds and waits for.

    ``held``: {Area: True} of the areas in which it holds a place, in the order in which it came there.
    """

    def __init__(self, traffic: Traffic, navigator: Navigator, lanes: Optional[LaneMap], stream: Stream) -> None:
        self.name = navigator.robot.name
        self.navigator: Navigator = navigator
        #: the net on which it drives, if that has capacities
        self.lanes: Optional[LaneMap] = lanes if lanes is not None and lanes.has_capacities else None
        self.held: Dict[Area, bool] = {}
        self.request: Optional[Request] = None
        self._traffic = traffic
        self.tell = stream.tell
        self._reason: Optional[str] = None  # the reason for which traffic holds it
        self._standing: Optional[Standing] = None  # None: there are no spots

    def _end_hold(self, now_ns: int) -> None:
        reason, self._reason = self._reason, None
        if reason is not None:
            self.navigator.travel.release(reason, now_ns)

    def _take_what_holds_it(self, now_ns: int, pose: Pose2D) -> None:
        """Hold a place in each zone in which the robot stands, and at its node, even if none is free."""
        zones = self._traffic.zones.at(pose.x, pose.y)
        nodes = [] if self.lanes is None else self._traffic.nodes(self.lanes.source).at(pose.x, pose.y)
        for area in (*zones, *(zone.group for zone in zones if zone.group is not None), *nodes):
            if area not in self.held:
                if not area.has_room():
                    self.tell(Warned(now_ns, self.name, '{} stands in {}, which has no free place: {} robots of {} '
                                      'are there{}'.format(self.name, area.name, len(area.holders) + 1, area.capacity,
                                                           ', and it is closed' if area.is_closed else '')))
                self._take((area,), now_ns)
            elif self._standing:
                self._standing.takes(area, now_ns)

    @property
    def waits_only(self) -> bool:
        """Whether it is held only because it waits for a place."""
        held_for: Tuple[str, ...] = self.navigator.travel.held_for
        return held_for == (self._reason,)

    def _take(self, areas: Tuple[Area, ...], now_ns: int) -> None:
        holder: Any = self
        for area in areas:
            self.held[area] = area.holders[holder] = True
            self._traffic.taken(area)
            if self._standing:
                self._standing.takes(area, now_ns)
            if area.capacity is not None and not area.is_told:
                area.is_told = True
                self.tell(Places(now_ns, self.name, area.name, area.capacity))
            self.tell(new(Entered, (now_ns, self.name, 'entered', area.name)))
        self._traffic.ways_out.entered(holder, areas)

    def _give_back(self, areas: Sequence[Area], now_ns: int) -> None:
        holder: Any = self
        for area in areas:
            if area in self.held:
                del self.held[area], area.holders[holder]
                self._traffic.changed(area)
                self.tell(new(Left, (now_ns, self.name, 'left', area.name)))
                self._traffic.freed(area)
