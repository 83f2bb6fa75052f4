"""Sockets between our processes wait as long as it takes, whatever limit the process has set for all its sockets."""
import os
import socket
import subprocess
import sys

import pytest

from move_base_abstract_experiments.carrying import sockets


@pytest.fixture
def hasty():
    """Have all new sockets of this process give up soon, as a program can have it, and rospy does after 60 s."""
    socket.setdefaulttimeout(0.001)
    yield
    socket.setdefaulttimeout(None)


def test_both_ends_wait_in_python_and_in_a_process_that_inherits_them(hasty):
    for one in sockets.pair():
        with one:
            assert one.gettimeout() is None
            assert os.get_blocking(one.fileno())


def test_a_signal_ends_a_node_however_late_it_comes():
    code = ('import os, signal, socket, time; socket.setdefaulttimeout(0.001); '
            'from move_base_abstract_ros.process import process_end; '
            'process_end.ProcessEnd("node", lambda name: os._exit(7)); '
            'time.sleep(0.1); os.kill(os.getpid(), signal.SIGTERM); time.sleep(60)')
    assert subprocess.run([sys.executable, '-c', code], timeout=60, check=False).returncode == 7
