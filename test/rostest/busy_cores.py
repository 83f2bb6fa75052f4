"""Other work on the machine, for tests of what must not depend on it."""
import subprocess
import sys
from contextlib import contextmanager

# Ends with who started it, also where a test is killed.
_LOOP = 'import os\nparent = os.getppid()\nwhile os.getppid() == parent:\n    pass\n'


@contextmanager
def busy(count):
    """Keep ``count`` cores busy meanwhile."""
    processes = [subprocess.Popen([sys.executable, '-c', _LOOP]) for _ in range(count)]
    try:
        yield
    finally:
        for process in processes:
            process.kill()
            process.wait()
