"""A run of which a test reads the event log."""

import json


class Logged:
    """What a whole event log says: its ``text``, ``head``, ``events`` [(ns, robot, kind, values), ...], and ``end``."""

    def read_log(self, path):
        """Read it."""
        with open(path, encoding='utf-8') as log:
            self.text = log.read()
        self.head, *records, end = map(json.loads, self.text.splitlines())
        self.end = end['end']
        self.events = [(record['time_ns'], record['robot'], record['kind'], record['values']) for record in records]


class ComparedRun(Logged):
    """A run of programs beside a fleet: what they ``said``, and their messages."""

    def assert_same(self, test, plain):
        """Assert that this run is the ``plain`` one."""
        test.assertEqual(self.said, plain.said)
        test.assertEqual(len(self.events), len(plain.events))
        for event, its in zip(plain.events, self.events):
            test.assertEqual(event, its)
