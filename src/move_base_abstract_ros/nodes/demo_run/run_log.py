"""The event log of a demo, and the replay page that is made of it when the demo is over."""
import json
import os
import tempfile

import rospkg
import rospy

from move_base_abstract.common.errors import SimulatorError
from move_base_abstract.msg import RobotEvent
from move_base_abstract.runs import event_log
from move_base_abstract.runs.event_log_file import End, write_event_log

PAGE = 'demo_replay.html'
_FOLDER = 'move_base_abstract'  # below ROS_HOME
_LOG = 'demo.jsonl'


class RunLog:
    """A folder for the log of one demo, as a context; ``output``: the page, None: one in ROS_HOME.

    ``kept``: where the event log is to stay, None: it goes with the folder.

    In lockstep the time master writes the log (:attr:`path`). On the scaled clock it is made of the events that robots
    tell: call :meth:`listen` then.
    """

    def __init__(self, output=None, kept=None):
        self._kept = kept and os.path.abspath(kept)
        self._output = output or os.path.join(rospkg.get_ros_home(), _FOLDER, PAGE)
        self._rows = []
        self._start_ns = 0
        self._listens = False

    def __enter__(self):
        self._folder = tempfile.TemporaryDirectory(prefix='move_base_abstract_demo_')
        self.path = self._kept or os.path.join(self._folder.name, _LOG)
        #: for files that the demo makes
        self.folder = os.path.join(self._folder.name, 'world')
        return self

    def __exit__(self, *_):
        self._folder.cleanup()

    def listen(self, *topics):
        """Take down what is told on ``topics`` (RobotEvent)."""
        self._listens = True
        self._start_ns = rospy.Time.now().to_nsec()
        for topic in topics:
            rospy.Subscriber(topic, RobotEvent, self._take, queue_size=1000, tcp_nodelay=True)

    def _take(self, message):
        self._rows.append((message.stamp.to_nsec(), message.robot, message.kind, _values(message)))

    def close(self):
        """The run is over: have the log complete."""
        if self._listens:
            self._rows.sort(key=lambda row: row[0])
            end_ns = max([self._start_ns, *(row[0] for row in self._rows)])
            write_event_log(self.path, self._rows, self._start_ns, End(end_ns, False, []))
        elif not os.path.exists(self.path):
            self.path += '.part'

    def rows(self):
        """Return when it began [ns], and its rows, [(ns, robot, kind, values), ...], when it is complete."""
        with event_log.open_text(self.path) as stream:
            log = event_log.EventLog(stream, self.path)
            return log.start_ns, [(one.time_ns, one.robot, one.kind, json.loads(one.values)) for one in log]

    def make_page(self, map_path, scenario=None):
        """Make the page, with the world of a scenario (a path); return a line that says where it is, or why not."""
        try:
            from move_base_abstract_replay.page import write_page
            os.makedirs(os.path.dirname(os.path.abspath(self._output)), exist_ok=True)
            write_page([self.path], self._output, map_path, scenario)
        except (SimulatorError, OSError) as error:
            return 'no replay: {}'.format(error)
        return 'replay: {}'.format(os.path.abspath(self._output))


def _values(message):
    """Return the values of a RobotEvent in the order of the event log's row."""
    texts, numbers = message.texts, message.numbers
    if message.kind == 'battery':
        return (*numbers, *texts)
    if message.kind == 'order_arrived':  # behind the first three places, actions and points go stop by stop
        stops = [(texts[2 * k + 1], *numbers[2 * k + 2:2 * k + 4], texts[2 * k + 2])
                 for k in range((len(texts) - 1) // 2)]
        return (texts[0], *map(int, numbers[:2]), *(value for stop in stops for value in stop))
    return (*texts, *numbers)
