"""A ROS master and nodes of a trial, as Loopback starts them, but forked from this process where possible.

This process must have one thread until all nodes are started, so start them before rospy.init_node. When it ends, the
kernel ends the processes that it has forked.
"""
from __future__ import annotations

import os
from typing import Any, Dict, List, Mapping, Optional, Sequence

from rosgraph.names import ns_join

from move_base_abstract.common import processes
from move_base_abstract_ros import loopback
from move_base_abstract_ros.launching import ros_master, warm_nodes
from move_base_abstract_ros.loopback import Loopback, LoopbackError

from . import warm_ros

#: the nodes that had ended before their Loopback was closed, as fields of runs.ends.Process
ended: List[Dict[str, Any]] = []


class WarmLoopback(Loopback):
    """A Loopback whose master and Python nodes of this package are forks of this process."""

    def close(self, keep_logs: bool = False) -> None:
        """Take note of nodes that have ended, then close as Loopback.close does."""
        for child in self._children[1:]:  # the first is the ROS master
            code = child.process.poll()
            if code is not None:
                ended.append({'node': child.name, 'takes_part': True, 'code': code, 'was_early': True,
                              'printed': child.last_lines().splitlines()})
        super().close(keep_logs)

    @property
    def environment(self) -> Dict[str, str]:
        """The environment variables of nodes: those of Loopback.environment, and the settings of logs."""
        environment: Dict[str, str] = warm_nodes.with_log_settings(super().environment)
        return environment

    def run(self, executable: str, name: str, namespace: str = '/', parameters: Optional[Mapping[str, Any]] = None,
            arguments: Sequence[str] = ()) -> Any:
        """Run a node as Loopback.run does, as a fork of this process if it is a Python node of this package."""
        full_name = ns_join(namespace, name)
        ros_master.set_parameters(self.uri, [(ns_join(full_name, key), value)
                                             for key, value in (parameters or {}).items()])
        launcher = warm_ros.launcher()
        words = [os.path.join(os.path.dirname(launcher), executable), *arguments, f'__ns:={namespace}',
                 f'__name:={name}']
        if not os.access(words[0], os.X_OK):
            words[0] = loopback.find_executable(executable)
        if not warm_nodes.is_fit(words, self.environment, launcher):
            return self.spawn(full_name, words)
        log_path = self._log_path(full_name)
        return self._child(full_name, processes.Forked(warm_nodes.start(
            words, self.environment, lambda: processes.redirect(log_path), os.getcwd(), launcher)), log_path)

    def _start_master(self) -> None:
        log_path = self._log_path('rosmaster')
        try:
            pid, self.uri = ros_master.start(log_path)
        except ros_master.MasterError as error:
            raise LoopbackError(str(error)) from None
        self._child('rosmaster', processes.Forked(pid), log_path)
        self.set_param('/use_sim_time', self._use_sim_time)
