"""The borders of the C++ folders: what make lint says of an #include that crosses one."""
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / 'tools'))

import check_includes  # noqa: E402


@pytest.fixture
def crossings(tmp_path):
    """Return a function that says what is wrong with one file's text."""
    def of(name, text):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        (path.parent / 'own.h').write_text('')
        path.write_text(text)
        return check_includes.crossings(tmp_path, str(path.parent.relative_to(tmp_path)))
    return of


@pytest.mark.parametrize('room', ['src/clock', 'src/lockstep', 'src/lockstep/rounds'])
@pytest.mark.parametrize('name', ['ros/ros.h', 'ros/time.h', 'thread', 'chrono', 'fstream', 'sys/socket.h', 'unistd.h',
                                  'random', 'move_base_abstract/TimeState.h', 'XmlRpc.h'])
def test_pure_folders_include_neither_ros_nor_threads_clocks_and_files(crossings, room, name):
    found = crossings(f'{room}/rules.cpp', f'#include "own.h"\n\n#include <string>\n#  include <{name}>\n')
    assert found == [f'{room}/rules.cpp: must not include {name}']


@pytest.mark.parametrize(('room', 'name'), [
    ('src/clock', 'lockstep/wire/wire.h'), ('src/clock', 'lockstep/wire/wire_format.h'),
    ('src/lockstep/wire', 'lockstep/rounds/order.h'), ('src/lockstep/rounds', 'lockstep/routing/router.h'),
    ('src/lockstep/routing', 'lockstep/session.h'),
    ('src/lockstep', 'common/shared_channel.h'), ('src/lockstep', '../time_master/node.h'),
    ('src/common', 'lockstep/session.h'), ('src/roscpp_shim/membership', 'time_master/time_mode.h'),
    ('src/roscpp_shim', 'roscpp_shim/membership/link.h'), ('src/roscpp_shim', 'roscpp_shim/libc/chance.h'),
    ('src/roscpp_shim', 'roscpp_shim/tf2/buffer.h'), ('src/roscpp_shim/tf2', 'roscpp_shim/turn.h'),
    ('src/roscpp_shim/machine', 'roscpp_shim/turn.h'), ('src/roscpp_shim/roscpp', 'roscpp_shim/libc/chance.h'),
    ('src/time_master', 'roscpp_shim/membership/link.h'),
    ('include/move_base_abstract', 'clock/scaled_clock.h'), ('src/clock', 'none.h')])
def test_folders_include_of_each_other_what_is_agreed_only(crossings, room, name):
    assert crossings(f'{room}/file.h', f'#include "{name}"\n') == [f'{room}/file.h: must not include {name}']


def test_a_file_that_says_no_ros_has_none(crossings):
    text = '// Sockets,\n// and one thread. No ROS.\n#include <thread>\n#include <ros/time.h>\n'
    assert crossings('src/time_master/server.h', text) == ['src/time_master/server.h: must not include ros/time.h']
    assert crossings('src/time_master/server.h', text.replace(' No ROS.', '')) == []


def test_what_is_agreed_is_allowed(crossings):
    text = '#include "own.h"\n#include <map>\n#include "clock/scaled_clock.h"\n#include "lockstep/wire/wire_format.h"\n'
    assert crossings('src/lockstep/wire/a.cpp', text) == []
