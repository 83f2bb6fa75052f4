"""These tests run where only the packages for plain Python are: pytest starts again with that Python, `.ws/plain`."""
import os
import sys
from pathlib import Path

import pytest

PLAIN_PYTHON = Path(__file__).resolve().parents[2] / '.ws' / 'plain' / 'bin' / 'python'


@pytest.hookimpl(tryfirst=True)
def pytest_cmdline_main(config):
    """Start pytest again with the other Python, unless it is that one."""
    if Path(sys.prefix) == PLAIN_PYTHON.parents[1]:
        return
    if not PLAIN_PYTHON.exists():
        raise pytest.UsageError(f'{PLAIN_PYTHON} is not there; to make it: make deps-test')
    capture = config.pluginmanager.getplugin('capturemanager')
    if capture is not None:
        capture.stop_global_capturing()
    os.execv(PLAIN_PYTHON, [str(PLAIN_PYTHON), '-m', 'pytest', *config.invocation_params.args])
