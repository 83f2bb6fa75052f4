"""The hooks and the fixture that pytest finds. Each test with the fixture ``lockstep`` runs in its own process."""
from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING, Any, Dict, Iterator, List, Optional

import pytest

from . import forked

if TYPE_CHECKING:
    from .system_under_test import Lockstep

_MARKER = ("lockstep(scenario=None, launch=None, args={}, nodes=[], ...): the system that the fixture 'lockstep' "
           'starts; docs/testing.md of move_base_abstract')


def pytest_configure(config: Any) -> None:
    """Register the marker."""
    config.addinivalue_line('markers', _MARKER)


@pytest.hookimpl(tryfirst=True)  # type: ignore[misc]
def pytest_cmdline_main(config: Any) -> None:
    """Restart Python with a fixed order of sets and a fixed layout of memory, unless it was started like that."""
    if config.option.collectonly or config.option.help or hasattr(config, 'workerinput'):
        return
    from move_base_abstract_ros.launching import warm_nodes
    if warm_nodes.wants_start(os.environ):
        capture = config.pluginmanager.getplugin('capturemanager')
        if capture is not None:
            capture.stop_global_capturing()
        with open('/proc/self/cmdline', 'rb') as stream:
            words = stream.read().split(b'\0')[:-1]
        os.execv(sys.executable, [os.fsencode(sys.executable), *words[1:]])


def pytest_generate_tests(metafunc: Any) -> None:
    """Make one test for each chaos seed that a marker asks for."""
    given = _marked(metafunc.definition).get('chaos_seeds')
    if given is None or 'lockstep' not in metafunc.fixturenames:
        return
    from move_base_abstract.common.errors import ConfigurationError

    from .settings import chaos_seeds
    seeds: List[int] = []
    problem = ''
    try:
        seeds = chaos_seeds(given)
    except ConfigurationError as error:
        problem = '{}: {}'.format(metafunc.definition.nodeid, error)
    if problem:  # not within ``except``, where pytest would also show the first error with its traceback
        pytest.fail(problem, pytrace=False)
    metafunc.parametrize('lockstep', seeds, ids=['chaos_{}'.format(seed) for seed in seeds], indirect=True)


def pytest_runtest_protocol(item: Any, nextitem: Any) -> Optional[bool]:
    """Run a test that has the fixture in a process of its own."""
    if 'lockstep' not in getattr(item, 'fixturenames', ()):
        return None
    item.ihook.pytest_runtest_logstart(nodeid=item.nodeid, location=item.location)
    for report in forked.reports_of(item, _marked(item).get('wall_limit', forked.WALL_LIMIT_S)):
        item.ihook.pytest_runtest_logreport(report=report)
    item.ihook.pytest_runtest_logfinish(nodeid=item.nodeid, location=item.location)
    return True


def _marked(item: Any) -> Dict[str, Any]:
    """Return the keywords of all markers of an item. If two markers have the same keyword, the nearer one counts."""
    found: Dict[str, Any] = {}
    for marker in reversed(list(item.iter_markers('lockstep'))):
        found.update(marker.kwargs)
    return found


@pytest.fixture  # type: ignore[misc]
def lockstep(request: Any) -> Iterator[Lockstep]:
    """Give a system in lockstep. See move_base_abstract_testing.system_under_test.Lockstep."""
    from move_base_abstract.common.errors import SimulatorError

    from .settings import OF_TESTS
    from .system_under_test import Lockstep
    node = request.node
    given = {key: value for key, value in _marked(node).items() if key not in OF_TESTS}
    system = Lockstep(node.lockstep_folder, os.path.dirname(str(node.fspath)), getattr(request, 'param', None))
    node.lockstep_system = system  # for the test's report, by which a broken property is a failure of the test
    problem = ''
    try:
        if given:
            system.start(**given)
    except SimulatorError as error:
        problem = str(error)
    if problem:  # not within ``except``, where pytest would also show the first error with its traceback
        pytest.fail(problem, pytrace=False)
    try:
        yield system
    finally:
        system.told_broken = system.not_allowed
