"""Emulates two computers on one: network namespaces, and a cable with a delay between them. It needs root.

The cable is a process that passes packets from one TUN device to the other, each after a fixed delay.
"""

import contextlib
import ctypes
import fcntl
import heapq
import os
import select
import signal
import struct
import subprocess
import sys
import time

from move_base_abstract_ros.loopback import Loopback

HOME, AWAY = '10.213.8.1', '10.213.8.2'
MARK = 'MOVE_BASE_ABSTRACT_BENCH_AWAY'  # environment: the namespace of the other computer
_TUNSETIFF, _IFF_TUN, _IFF_NO_PI = 0x400454CA, 0x0001, 0x1000
_MOST_BYTES = 65536  # size of a packet, at most


def _ip(*words):
    subprocess.run(['ip', *words], check=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)


class TwoComputers:
    """Two namespaces and the cable between them, for as long as the context lasts.

    :param delay_s: wall time that a packet takes each way [s].
    :raises OSError, subprocess.CalledProcessError: if they cannot be made.
    """

    def __init__(self, delay_s):
        self._delay_s = delay_s
        self.home, self.away = (f'mba_{side}_{os.getpid()}' for side in ('home', 'away'))
        self._cable = None

    def __enter__(self):
        try:
            for name in (self.home, self.away):
                _ip('netns', 'add', name)
            self._cable = subprocess.Popen([sys.executable, __file__, self.home, self.away, str(self._delay_s)],
                                           stdout=subprocess.PIPE)
            if self._cable.stdout.readline() != b'ready\n':
                raise OSError('the cable could not be made; see above')
            for name, own, other in ((self.home, HOME, AWAY), (self.away, AWAY, HOME)):
                _ip('-n', name, 'link', 'set', 'lo', 'up')
                _ip('-n', name, 'address', 'add', own, 'peer', other, 'dev', 'cable')
                _ip('-n', name, 'link', 'set', 'cable', 'up')
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        if self._cable is not None:
            self._cable.kill()
            self._cable.wait()
            self._cable.stdout.close()
        for name in (self.home, self.away):
            subprocess.run(['ip', 'netns', 'delete', name], check=False, stderr=subprocess.DEVNULL)

    def command(self, command):
        """Return ``command`` wrapped so that it runs at home and knows the namespace of the other computer."""
        return ['env', f'{MARK}={self.away}', 'ip', 'netns', 'exec', self.home, *command]


class Home(Loopback):
    """A ROS master at home, which nodes on the other computer can reach. Use it in a process that runs at home."""

    @property
    def environment(self):
        """The environment of a node at home."""
        return dict(super().environment, ROS_IP=HOME, ROS_MASTER_URI=self.uri.replace('127.0.0.1', HOME))

    def spawn_away(self, name, command):
        """Start a process on the other computer."""
        return self.spawn(name, ['ip', 'netns', 'exec', os.environ[MARK], 'env', f'ROS_IP={AWAY}', *command])


def _tun_in(namespace, libc):
    """Enter the namespace, and return a descriptor of its device ``cable``."""
    with open(f'/run/netns/{namespace}', encoding='ascii') as handle:
        if libc.setns(handle.fileno(), 0):
            raise OSError(ctypes.get_errno(), f'cannot enter {namespace}')
    device = os.open('/dev/net/tun', os.O_RDWR | os.O_NONBLOCK)
    fcntl.ioctl(device, _TUNSETIFF, struct.pack('16sH', b'cable', _IFF_TUN | _IFF_NO_PI))
    return device


def _carry(ends, delay_s):
    """Pass each packet to the other end after ``delay_s`` [s], for ever."""
    under_way, count = [], 0
    while True:
        wait = max(0.0, under_way[0][0] - time.monotonic()) if under_way else None
        for end in select.select(ends, [], [], wait)[0]:
            packet = os.read(end, _MOST_BYTES)
            count += 1
            heapq.heappush(under_way, (time.monotonic() + delay_s, count, ends[end == ends[0]], packet))
        while under_way and under_way[0][0] <= time.monotonic():
            _, _, end, packet = heapq.heappop(under_way)
            with contextlib.suppress(OSError):  # the device is not up; the packet is lost, as on any cable
                os.write(end, packet)


def main():
    """Run as the cable. Arguments: both namespaces, and the delay each way [wall s]."""
    home, away, delay_s = sys.argv[1:]
    libc = ctypes.CDLL(None, use_errno=True)
    libc.prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG: the cable ends with its parent process
    ends = [_tun_in(name, libc) for name in (home, away)]
    print('ready', flush=True)
    _carry(ends, float(delay_s))


if __name__ == '__main__':
    main()
