"""Participants in C++ report through memory that they share with the time master; it changes no event.

Programs run with and without it, with messages of all sizes. What is offered instead of such memory is not used.
"""

import array
import os
import re
import socket
import tempfile
import unittest

from lockstep_raw_client import RawClient, address_at
from lockstep_roscpp_run import Program, Runs, own
from own_sockets import pid_of
from warm import Loopback

RELAY = '/usr/lib/topic_tools/relay'


def memories(ros):
    """Return how many memories of participants the time master uses."""
    with open('/proc/{}/maps'.format(pid_of('/time_master', ros.uri)), encoding='ascii') as maps:
        return len(re.findall('memfd:move_base_abstract', maps.read()))


class MemoryRuns(Runs):
    def ask_why(self):
        return memories(self.ros)


RUNS = MemoryRuns()


def rate(**parameters):
    return Program('rate', own('shim_rate'), ticks=60, **parameters)


def relay():
    return Program('relay', RELAY, '/ticks', '/relayed')


def recorder(name='recorder'):
    return Program(name, own('shim_recorder'), topics=['/ticks', '/relayed'])


class MemoryTest(unittest.TestCase):
    def same(self, *programs):
        """Check that the programs leave the same events with and without shared memory, which is used."""
        shared, plain = (RUNS.run(list(programs), ask_why=True, shared_memory=is_shared) for is_shared in (True, False))
        for run in (shared, plain):
            self.assertEqual((run.code, run.labels), (0, []), run.outputs)
        self.assertGreater(len(plain.events), 60)
        self.assertEqual(shared.events, plain.events)
        self.assertEqual([shared.printed(k) for k in range(1, len(programs))],
                         [plain.printed(k) for k in range(1, len(programs))])
        self.assertEqual(plain.why, 0)
        return shared

    def test_small_messages(self):
        run = self.same(rate(), relay(), recorder())
        self.assertEqual(run.why, 2)  # the first program has ended

    def test_messages_that_are_too_large_for_it_and_others_keep_their_order(self):
        # 32 KiB is what fits; 100 kB goes over the socket, and so do several of 20 kB at once.
        for padding in (20_000, 100_000):
            with self.subTest(padding=padding):
                self.same(rate(padding=padding), relay(), recorder(), recorder('other'))

    def test_goals_and_their_feedback(self):
        self.same(Program('goals', own('shim_goals')), Program('worker', own('shim_worker')))


class Offering(socket.socket):
    """A connection on this computer that offers a file with the first bytes."""

    def __init__(self, address, file):
        super().__init__(socket.AF_UNIX)
        self.files = [array.array('i', [file])]
        self.connect('\0move_base_abstract/' + address)

    def sendall(self, data):
        while self.files:
            data = data[self.sendmsg([data], [(socket.SOL_SOCKET, socket.SCM_RIGHTS, self.files.pop())]):]
        super().sendall(data)


def client_with(file, address):
    """Return a participant without a library that offers a file."""
    client = RawClient(address)
    client.close()
    client.socket = Offering(address, file)
    return client


class OfferTest(unittest.TestCase):
    def test_what_is_not_such_memory_is_not_used_and_not_kept(self):
        with Loopback() as ros, tempfile.TemporaryFile() as empty:
            ros.run('time_master', 'time_master', parameters={'mode': 'lockstep', 'participants': ['/a']})
            address = address_at(ros.uri)
            folder = '/proc/{}/fd'.format(pid_of('/time_master', ros.uri))
            reader, writer = os.pipe()
            with open('/dev/zero', 'rb') as zero:
                for file in (empty.fileno(), reader, writer, zero.fileno()):
                    client = client_with(file, address)
                    client.hello('/a')
                    grant = client.grant()
                    client.report(grant, next_ns=grant.time_ns + 10 ** 9)
                    self.assertEqual(client.grant().time_ns, grant.time_ns + 10 ** 9)
                    self.assertEqual(memories(ros), 0)
                    kept = [os.path.realpath(os.path.join(folder, name))  # one may be closed meanwhile
                            for name in os.listdir(folder)]
                    self.assertFalse([path for path in kept if 'zero' in path or 'deleted' in path], kept)
                    client.close()
            os.close(reader)
            os.close(writer)
