"""A rosbag of one trial. The recorder takes no part in lockstep, so it must be connected before the mission begins."""
from __future__ import annotations

import signal
import subprocess
import sys
import time
import xmlrpc.client
from typing import Any

import rosgraph

from move_base_abstract_ros.loopback import LoopbackError

NODE = '/bag'
TIMEOUT_S = 20.0  # wall
POLL_S = 0.05  # wall
LAST_WORDS_S = 0.3  # wall; time for rospy's queued messages to reach the recorder
ACTION = ('goal', 'cancel', 'status', 'feedback', 'result')
COMMON = ('/clock', '/tf', '/tf_static', '/rosout', '/move_base_abstract/markers', '/time_master/state')
VIEWS = ('prediction', 'variance', 'truth', 'markers', 'legend', 'rmse', 'mean_variance')


class BagRecorder:
    """rosbag on the master of a Loopback, writing to path.

    names: those of the robots. actions: names of the actions below each. poses: the pose topic below each. coordinator:
    the name of its node.
    """

    def __init__(self, ros: Any, path: str, names: Any, actions: Any, poses: Any, coordinator: Any) -> None:
        self._ros = ros
        topics = [*COMMON, *(f'/{coordinator}/{view}' for view in VIEWS)]
        for name in names:
            topics += [f'/{name}/{poses}', *(f'/{name}/{action}/{topic}' for action in actions for topic in ACTION)]
        self._topics = topics
        self._path: Any = path
        command = ['rosbag', 'record', '--lz4', '-O', str(path), *topics, f'__name:={NODE[1:]}']
        self._child = ros.spawn(NODE, command)

    def wait_until_connected(self) -> None:
        """Wait until all topics that have a publisher reach the recorder. :raises LoopbackError: after 20 s."""
        deadline = time.monotonic() + TIMEOUT_S
        while True:
            self._ros.check()
            missing = self._missing()
            if not missing:
                return
            if time.monotonic() > deadline:
                raise LoopbackError(f'after {TIMEOUT_S:g} s rosbag does not receive {", ".join(sorted(missing)[:5])}; '
                                    f'its last lines:\n{self._child.last_lines()}')
            time.sleep(POLL_S)

    def _missing(self) -> Any:
        """Return the topics with a publisher that does not send to the recorder yet.

        This asks the publishers, because the recorder reports a link as connected when it has only begun to connect.
        """
        master = rosgraph.Master('/study', master_uri=self._ros.uri)
        missing, links = set(), {}
        for topic, nodes in master.getSystemState()[0]:
            for node in nodes if topic in self._topics else ():
                if node not in links and node != NODE:
                    links[node] = self._links(master, node)
                if node != NODE and topic not in links[node]:
                    missing.add(topic)
        return missing if links else {NODE}

    @staticmethod
    def _links(master: Any, node: Any) -> Any:
        """Return the topics that a node sends to the recorder."""
        try:
            rows: Any = xmlrpc.client.ServerProxy(master.lookupNode(node)).getBusInfo('/study')[2]
        except (rosgraph.MasterError, OSError):
            return set()
        return {row[4] for row in rows if row[1] == NODE and row[2] == 'o'}

    def close(self) -> None:
        """Let the recorder write what it has and close its file; print an error if the bag is not complete."""
        time.sleep(LAST_WORDS_S)
        self._child.signal(signal.SIGINT)
        try:
            self._child.process.wait(TIMEOUT_S)
        except subprocess.TimeoutExpired:
            self._child.signal(signal.SIGKILL)  # the trial's own files are more important than its bag
        said = self._child.last_lines()
        if not self._path.is_file() or 'Disabling recording' in said:  # rosbag stops with less than 1 GB left
            print(f'study: {self._path.name} is not complete; the last lines of rosbag:\n{said}', file=sys.stderr)
