"""A temporary folder for each test, and files in it; or a package of others that nobody has built."""
import os
import shutil
import tempfile

_MANIFEST = """<package format="2"><name>study_of_others</name><version>1.0.0</version><description>x</description>
<maintainer email="a@example.org">a</maintainer><license>x</license></package>"""


class OwnFolder:
    """A mix-in for a TestCase: ``folder`` exists from ``setUp`` to the end of the test."""

    def setUp(self):
        """Make the folder."""
        self.folder = tempfile.mkdtemp(prefix='own_folder_')
        self.addCleanup(shutil.rmtree, self.folder)

    def path(self, name):
        """Return the path of a file in the folder."""
        return os.path.join(self.folder, name)

    def write(self, name, text, mode=0o644):
        """Write a file in the folder; return its path."""
        with open(self.path(name), 'w') as stream:
            stream.write(text)
        os.chmod(self.path(name), mode)
        return self.path(name)


class OwnPackage(OwnFolder):
    """A mix-in for a TestCase: ``folder`` is the package study_of_others, which is found with ``environment``."""

    FILES = {}  # {name: text}, programs of the package
    COPIES = ()  # programs of unmodified/ that it has, too

    def setUp(self):
        """Make the package."""
        super().setUp()
        self.write('package.xml', _MANIFEST)
        for name in self.COPIES:
            shutil.copy(os.path.join(os.path.dirname(os.path.abspath(__file__)), 'unmodified', name), self.folder)
            os.chmod(self.path(name), 0o755)
        for name, text in self.FILES.items():
            self.write(name, text, 0o755)
        self.environment = dict(os.environ, ROS_PACKAGE_PATH=os.pathsep.join(
            [self.folder, os.environ['ROS_PACKAGE_PATH']]))
