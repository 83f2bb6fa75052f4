"""What tests wait for: a condition, words in the output of a process, its end. Each wait fails after a guard."""

import time

from move_base_abstract_ros.loopback import find_executable

GUARD = 300.0  # s, wall; only ends a test that would never end; a busy machine is not to reach it


def wait_for(what, condition, guard=GUARD):
    """Return the first true value of condition(); fail after ``guard`` [s, wall], naming ``what``.

    ``what``: words, or a function that returns them then.
    """
    deadline = time.monotonic() + guard
    while True:
        value = condition()
        if value:
            return value
        if time.monotonic() > deadline:
            raise AssertionError(f'not within {guard} s: {what() if callable(what) else what}')
        time.sleep(0.01)


def children_of(pid):
    """Return the ids of the children of a process that has one thread, in the order in which they were started."""
    with open('/proc/{0}/task/{0}/children'.format(pid)) as stream:
        return [int(word) for word in stream.read().split()]


def read(child):
    """Return the output of a process so far."""
    with open(child.log_path, errors='replace') as log:
        return log.read()


def wait_for_words(child, words):
    """Wait until a process has printed ``words``."""
    wait_for(lambda: f"'{words}' in: {read(child)}", lambda: words in read(child))


def wait_for_end(child, others=(), guard=GUARD):
    """Wait until a process has ended, and return its exit code; otherwise fail with the output of {name: process}."""
    wait_for(lambda: f'the end of {child.name}. What was printed:\n' + '\n'.join(
        f'{name}:\n{read(other)}' for name, other in (dict(others) or {child.name: child}).items()),
        lambda: child.process.poll() is not None, guard)
    return child.process.returncode


def ask_why(ros):
    """Return what `why` says of the time master of a Loopback."""
    asked = ros.spawn('/why', [find_executable('why')])
    asked.process.wait(GUARD)
    ros.end(asked)
    return read(asked)
