"""The folder of the tests of systems is there until all that Python calls at the end of a process has been called."""
import os
import shutil
import subprocess
import sys
from pathlib import Path

TEST = """
import atexit, os, tempfile
def test_it_leaves_a_folder_as_genpy_does():
    atexit.register(os.rmdir, tempfile.mkdtemp())
"""


def test_what_removes_its_own_folder_at_the_end_finds_it(tmp_path):
    shutil.copy(str(Path(__file__).resolve().parents[1] / 'systems' / 'conftest.py'), str(tmp_path))
    (tmp_path / 'test_one.py').write_text(TEST)
    (tmp_path / 'tmp').mkdir()
    done = subprocess.run([sys.executable, '-m', 'pytest', '-q', '-p', 'no:cacheprovider', '-c', os.devnull,
                           '--rootdir', str(tmp_path), str(tmp_path)],
                          env=dict(os.environ, TMPDIR=str(tmp_path / 'tmp')), stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, timeout=100, check=False)
    assert done.returncode == 0 and 'FileNotFoundError' not in done.stdout, done.stdout
    assert [one for one in os.listdir(str(tmp_path / 'tmp')) if one.startswith('systems_')] == []
