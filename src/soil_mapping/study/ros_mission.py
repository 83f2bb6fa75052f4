"""The mission of a trial on ROS: this process becomes the coordinator's node."""
from __future__ import annotations

from typing import Any

import rospy

from move_base_abstract_ros import lockstep
from move_base_abstract_ros.replacing import rospy_start
from soil_mapping.mission.coordinator import Coordinator
from soil_mapping.ros.coordinator_node import run_mission
from soil_mapping.ros.mission_run import MissionFailed

from .field_cache import truth_of


def carry_out(spec: Any, node: Any, names: Any, topics: Any, ros: Any, stopwatch: Any,
              before: Any = lambda: None) -> Any:
    """Run the mission of a TrialSpec to its end; return its Coordinator and its MissionRun.

    node: the name of this node. names: those of the robots. topics: names of the sampling's action and of the pose
    topic, below each robot. ros: the Loopback of the other nodes. before: called when all are there, before the
    mission.

    :raises LoopbackError, MissionFailed: if a node ends, or the mission cannot be carried out.
    """
    coordinator = Coordinator(spec.config, spec.seed, truth_of(spec.config), stopwatch)
    rospy_start.prepare()
    rospy.init_node(node, disable_signals=True)
    try:
        return coordinator, run_mission(coordinator, names, *topics, stopwatch, ros.check, before)  # type: ignore[call-arg]
    except (rospy.ROSInterruptException, MissionFailed):
        ros.check()
        raise


def leave() -> None:
    """Leave the run, if this process takes part."""
    if lockstep.participant() is not None:
        lockstep.participant().leave('the mission is over')  # type: ignore[union-attr]
