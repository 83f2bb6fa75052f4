"""Other work on the machine, for tests of what must not depend on it."""
import subprocess
import sys
from contextlib import contextmanager


@contextmanager
def busy(count):
    """Keep ``count`` cores busy meanwhile."""
    processes = [subprocess.Popen([sys.executable, '-c', 'while True: pass']) for _ in range(count)]
    try:
        yield
    finally:
        for process in processes:
            process.kill()
            process.wait()
