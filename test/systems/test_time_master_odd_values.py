"""An oracle: each parameter of the time master with odd values is refused with words, or the time master starts."""
import sys
import xmlrpc.client
from pathlib import Path

from lockstep_run import LockstepCase, wait_for
from night import times

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / 'tools'), str(ROOT / 'test' / 'unit')]

import write_node_pages  # noqa: E402

from test_odd_values import DAY  # noqa: E402

LAUNCH_FILE = '<launch><param name="/use_sim_time" value="true"/></launch>'
NAMES = [row[0] for row in write_node_pages.cpp_rows()]
#: of wrong shapes, which no parameter may have
WRONG = [{'a': 1}, [[]], {'a': {'b': [1]}}]


class OddValuesTest(LockstepCase):
    """A time master for each value."""

    def verdict_of(self, name, value):
        """Start it; return its words if it refuses the value, none if it starts, None if ROS has no such value."""
        try:
            self.launch(**{'mode': 'lockstep', 'chaos_seed': 1, name: value})  # delays are for seeds only
        except (OverflowError, TypeError, ValueError, xmlrpc.client.Error, UnicodeError):
            return None
        wait_for('a verdict', lambda: self.process.poll() is not None or self.is_there())
        if self.process.poll() is None:
            self.end()
            return ''
        return self.output()

    def is_there(self):
        return self.master.hasParam('/time_master/lockstep_address')

    def test_each_is_taken_or_refused_with_its_name(self):
        for name in times(NAMES[::12], NAMES):
            for value in [*WRONG, *times(DAY[:4], DAY)]:
                said = self.verdict_of(name, value)
                with self.subTest(name=name, value=value):
                    if value in WRONG:
                        self.assertIsNotNone(said)
                        self.assertTrue(said)
                    if said:
                        self.assertRegex(said, 'FATAL.*parameter /time_master/{} must '.format(name))
