"""Write files for tools that read ROS messages: MCAP with the profile ros1, and rosbag. Equal logs give equal bytes."""
from __future__ import annotations

import contextlib
import os
from typing import Any, Iterator

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.own_files import PART, OutputError

from .mcap_file import McapWriter
from .motions import Motions
from .recording import read_recording
from .ros_messages import messages_of

RATE = 10.0  # Hz, simulated
FRAME = 'map'
_LIBRARY = 'move_base_abstract replay'


def write_mcap(log: Any, output: str, rate: float = RATE, frame: str = FRAME) -> None:
    """Write the run of an event log (path) as the MCAP file ``output``, which must not exist.

    ``rate`` [Hz, simulated] and ``frame``: see messages_of(). :raises EventLogError: if the log cannot be read.
    :raises ConfigurationError: if ``output`` exists. :raises OutputError: if it cannot be written.
    """
    with _new_file(output) as part, open(part, 'xb') as stream:
        writer = McapWriter(stream, _LIBRARY)
        for told in _messages(log, rate, frame):
            writer.write(told.topic, type(told.message), told.data, told.time_ns)
        writer.finish()


def write_bag(log: Any, output: str, rate: float = RATE, frame: str = FRAME) -> None:
    """Write the run of an event log (path) as the bag ``output``; see :func:`write_mcap`."""
    import rosbag  # takes a while
    with _new_file(output) as part:
        with rosbag.Bag(part, 'w') as bag:
            for told in _messages(log, rate, frame):
                message = told.message
                stamp = message.header.stamp if message._has_header else None
                bag.write(told.topic, message, stamp or _time(told.time_ns))


def _messages(log: Any, rate: float, frame: str) -> Any:
    recording = read_recording(log, most=float('inf'))
    return messages_of(recording, Motions(recording), rate, frame)


def _time(time_ns: int) -> Any:
    from genpy import Time
    return Time(*divmod(time_ns, 10 ** 9))


@contextlib.contextmanager
def _new_file(path: str) -> Iterator[Any]:
    """Give the path of a temporary file to write; at the end it gets the name ``path``. No file is replaced."""
    path = os.fspath(path)
    _check_free(path)
    _check_free(path + PART)
    try:
        try:
            yield path + PART
            with open(path + PART, 'rb') as stream:
                os.fsync(stream.fileno())
            _check_free(path)
            os.rename(path + PART, path)
        finally:
            with contextlib.suppress(FileNotFoundError):
                os.unlink(path + PART)
    except OSError as error:
        raise OutputError('{}: cannot be written: {}'.format(path, error.strerror or error)) from error


def _check_free(path: str) -> None:
    if os.path.lexists(path):
        raise ConfigurationError('{}: is there already; name another file, or move it away'.format(path))
