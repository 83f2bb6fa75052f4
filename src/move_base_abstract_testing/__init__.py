"""A pytest plugin for tests that run robots and your nodes in lockstep (docs/testing.md).

    python3 -m pytest -p move_base_abstract_testing

or ``pytest_plugins = ['move_base_abstract_testing']`` in the conftest.py of the top folder.
"""
from .plugin import (  # noqa: F401 - pytest finds its hooks and fixtures here
    lockstep,
    pytest_cmdline_main,
    pytest_configure,
    pytest_generate_tests,
    pytest_runtest_protocol,
)
