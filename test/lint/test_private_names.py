"""Names of Python's own that are private: those that a version of Python no longer has are not used."""
import pathlib
import re
import threading

ROOT = pathlib.Path(__file__).resolve().parents[2] / 'src'
#: a private function of the module threading
PRIVATE = re.compile(r'\bthreading\.(_[a-z]\w*)')
#: they are put in place here, not called
REPLACED = {'_allocate_lock', '_newname', '_time', '_shutdown'}


def test_private_functions_of_threading_are_there_or_are_only_replaced():
    used = {(path.name, name) for path in sorted(ROOT.rglob('*.py'))
            for name in PRIVATE.findall(path.read_text(encoding='utf-8')) if name not in REPLACED}
    assert used == set()
    assert all(hasattr(threading, name) for name in sorted(REPLACED))
