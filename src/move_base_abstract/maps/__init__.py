"""Where robots can go: cells of a map, nets of lanes, tables of times; and the planners that find ways on them."""
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .grid_planner import GridPlanner as GridPlanner
    from .lane_map import LaneMap as LaneMap, make_lane_map as make_lane_map, read_lane_map as read_lane_map
    from .lane_planner import LanePlanner as LanePlanner
    from .map_check import MapCheck as MapCheck
    from .map_files import load_map as load_map, read_description as read_description
    from .occupancy import OccupancyMap as OccupancyMap
    from .planning import StraightLinePlanner as StraightLinePlanner, WorldBounds as WorldBounds
    from .travel_matrix import (
        MatrixPlanner as MatrixPlanner,
        TravelMatrix as TravelMatrix,
        make_travel_matrix as make_travel_matrix,
        read_travel_matrix as read_travel_matrix,
    )
else:
    from ..common.lazy_exports import lazy_exports

    __getattr__ = lazy_exports(__name__)
