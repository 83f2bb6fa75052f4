"""The event log of a demo, and the replay page that is made from it when the demo is over."""
import json
import os
import time

import rospkg
import rospy

from move_base_abstract.common import temporary
from move_base_abstract.common.errors import SimulatorError
from move_base_abstract.msg import RobotEvent
from move_base_abstract.runs import event_log
from move_base_abstract.runs.event_log_file import End, write_event_log

PAGE = 'demo_replay.html'
_FOLDER = 'move_base_abstract'  # below ROS_HOME
_LOG = 'demo.jsonl'
_LONGEST_S = 5.0  # wall, for connections, and for rows that come after their goal's result


class RunLog:
    """A context with a temporary folder for the log of one demo.

    ``output``: the path of the replay page; None: demo_replay.html in ROS_HOME. ``kept``: a path at which the event log
    stays; None: it is removed with the folder.

    In lockstep the time master writes the log, to :attr:`path`, and its last :attr:`note`. On the scaled clock
    :meth:`listen` collects the events that robots publish, and :meth:`close` writes the log.
    """

    def __init__(self, output=None, kept=None):
        self._kept = kept and os.path.abspath(kept)
        self._output = output or os.path.join(rospkg.get_ros_home(), _FOLDER, PAGE)
        self._rows = []
        self._start_ns = 0
        self._listens = False

    def __enter__(self):
        self._folder = temporary.make('demo_')
        self.path = self._kept or os.path.join(self._folder, _LOG)
        self.note = os.path.join(self._folder, 'end')
        #: for files that the demo makes
        self.folder = os.path.join(self._folder, 'world')
        return self

    def __exit__(self, *_):
        temporary.remove(self._folder)

    def listen(self, *topics):
        """Collect all messages on ``topics`` (RobotEvent) from now on."""
        self._listens = True
        self._start_ns = rospy.Time.now().to_nsec()
        heard = [rospy.Subscriber(topic, RobotEvent, self._take, queue_size=1000, tcp_nodelay=True) for topic in topics]
        _wait_for(lambda: all(one.get_num_connections() for one in heard))

    def _take(self, message):
        self._rows.append((message.stamp.to_nsec(), message.robot, message.kind, _values(message)))

    def await_rows(self, kind, count):
        """On the scaled clock, wait until there are ``count`` rows of a kind."""
        _wait_for(lambda: not self._listens or sum(row[2] == kind for row in self._rows) >= count)

    def close(self):
        """Complete the log, when the run is over. If it did not end properly, :attr:`path` is the unfinished log."""
        if self._listens:
            self._rows.sort(key=lambda row: row[0])
            end_ns = max([self._start_ns, *(row[0] for row in self._rows)])
            write_event_log(self.path, self._rows, self._start_ns, End(end_ns, False, []))
        elif not os.path.exists(self.path):
            self.path += '.part'

    def rows(self):
        """Return (start [ns], rows) of the complete log; a row is (time [ns], robot, kind, values)."""
        with event_log.opened(self.path) as log:
            return log.start_ns, list(log.rows())

    def messages(self):
        """Return how many messages the time master has delivered, when the run is over; None on the scaled clock."""
        if self._listens:
            return None
        with open(self.note, encoding='utf-8') as stream:
            return json.load(stream)['messages']

    def make_page(self, map_path, scenario=None):
        """Make the replay page; return a line for the user that says where it is, or why there is none.

        ``map_path`` and ``scenario``: paths of the map and of the scenario whose world is shown; None: none.
        """
        try:
            from move_base_abstract_replay.page import write_page
            os.makedirs(os.path.dirname(os.path.abspath(self._output)), exist_ok=True)
            write_page([self.path], self._output, map_path, scenario)
        except (SimulatorError, OSError) as error:
            return 'no replay: {}'.format(error)
        return 'replay: {}'.format(os.path.abspath(self._output))


def _wait_for(condition):
    deadline = time.monotonic() + _LONGEST_S
    while not condition() and time.monotonic() < deadline:
        time.sleep(0.02)


def _values(message):
    """Return the values of a RobotEvent in the order in which a row of the event log has them."""
    texts, numbers = message.texts, message.numbers
    if message.kind == 'battery':
        return (*numbers, *texts)
    if message.kind == 'order_arrived':  # after the first three values: place, point and action of each stop
        stops = [(texts[2 * k + 1], *numbers[2 * k + 2:2 * k + 4], texts[2 * k + 2])
                 for k in range((len(texts) - 1) // 2)]
        return (texts[0], *map(int, numbers[:2]), *(value for stop in stops for value in stop))
    return (*texts, *numbers)
