"""A temporary folder for each test, files in it or a package of others that nobody built, and programs run there."""
import os
import shutil
import tempfile

import warm
from waiting import GUARD

from move_base_abstract.runs.event_log import EventLog
from move_base_abstract_ros.loopback import find_executable

MANIFEST = """<package format="2"><name>study_of_others</name><version>1.0.0</version><description>x</description>
<maintainer email="a@example.org">a</maintainer><license>x</license></package>"""


class OwnFolder:
    """A mix-in for a TestCase: ``folder`` exists from ``setUp`` to the end of the test."""

    def setUp(self):
        """Make the folder."""
        self.environment = dict(os.environ)  # of the programs that the test runs
        self.folder = tempfile.mkdtemp(prefix='own_folder_')
        self.addCleanup(shutil.rmtree, self.folder)

    def path(self, name):
        """Return the path of a file in the folder."""
        return os.path.join(self.folder, name)

    def write(self, name, text, mode=0o644):
        """Write a file in the folder, and the folders that it lies in; return its path."""
        os.makedirs(os.path.dirname(self.path(name)), exist_ok=True)
        with open(self.path(name), 'w') as stream:
            stream.write(text)
        os.chmod(self.path(name), mode)
        return self.path(name)

    def run_it(self, program, *words, cwd=None):
        """Run a program of this package to its end, in the folder or in ``cwd``; return (exit code, output)."""
        done = warm.run([find_executable(program), *words], self.environment, cwd or self.folder, GUARD)
        return done.returncode, done.stdout

    def launch(self, log, *words, code=0):
        """Run a launch file with an event log of this name in the folder; return (output, EventLog, events)."""
        ended, said = self.run_it('lockstep_launch', '--event-log', self.path(log), *words)
        self.assertEqual(ended, code, said)
        return (said, *events_of(self.path(log)))


class OwnPackage(OwnFolder):
    """A mix-in for a TestCase: ``folder`` is the package study_of_others, which is found with ``environment``."""

    FILES = {}  # {name: text}, programs of the package
    COPIES = ()  # programs of unmodified/ that it has, too

    def setUp(self):
        """Make the package."""
        super().setUp()
        self.write('package.xml', MANIFEST)
        for name in self.COPIES:
            shutil.copy(os.path.join(os.path.dirname(os.path.abspath(__file__)), 'unmodified', name), self.folder)
            os.chmod(self.path(name), 0o755)
        for name, text in self.FILES.items():
            self.write(name, text, 0o755)
        self.environment['ROS_PACKAGE_PATH'] = os.pathsep.join([self.folder, os.environ['ROS_PACKAGE_PATH']])


def events_of(path):
    """Return (EventLog, [event.compared, ...]) of an event log that is whole."""
    with open(path, encoding='utf-8') as stream:
        log = EventLog(stream.readlines(), path)
    return log, [event.compared for event in log]
