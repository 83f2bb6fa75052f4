"""A temporary folder for each test, and files in it."""
import os
import shutil
import tempfile


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
