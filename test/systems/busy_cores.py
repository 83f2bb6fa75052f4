"""Keeps the machine busy, for tests whose results must not depend on that."""
import subprocess
import sys
from contextlib import contextmanager

# It ends with the process that started it, also if a test is killed.
_LOOP = 'import os\nparent = os.getppid()\nwhile os.getppid() == parent:\n    pass\n'


@contextmanager
def busy(count):
    """Keep ``count`` cores busy within a ``with`` statement."""
    processes = [subprocess.Popen([sys.executable, '-c', _LOOP]) for _ in range(count)]
    try:
        yield
    finally:
        for process in processes:
            process.kill()
            process.wait()
