"""The backend for Gazebo: it sets the robots' models to the poses that the core computes."""
from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING, Any, Callable, Dict, List, NamedTuple, Tuple, Type

import rospy

from move_base_abstract.common.errors import ConfigurationError

from ..clocks.throttle import WallThrottle
from ..messages import conversions
from . import clock_check
from .builtin import BuiltinBackend

if TYPE_CHECKING:
    from move_base_abstract.common.geometry import Pose2D
    from move_base_abstract.config.settings import RobotSettings

    from ..robot.names import RobotNames

SERVICE = '/gazebo/set_model_state'
_RETRY_SECONDS = 1.0
_WARNINGS_RATE = 0.2  # Hz, wall


class GazeboBackend(BuiltinBackend):
    """Calls ``/gazebo/set_model_state``, and publishes tf and the pose topics as the built-in backend does.

    :raises ConfigurationError: if the package gazebo_msgs is not installed.
    """

    def __init__(self, names: RobotNames, settings: RobotSettings) -> None:
        self._types = _import_types(names.private)
        self._model = settings.values['gazebo_model'] or names.robot
        self._reference_frame = settings.values['gazebo_reference_frame']
        self._z = settings.values['gazebo_z']
        super().__init__(names, settings)
        clock_check.warn_of_machine_clock('Gazebo')

    def place(self, pose: Pose2D, velocity: Tuple[float, float, float], stamp_ns: int) -> None:
        """Publish the pose, and make the worker send it to Gazebo."""
        super().place(pose, velocity, stamp_ns)
        message = conversions.to_pose(pose)
        message.position.z = self._z
        state = self._types.ModelState(model_name=self._model, pose=message, reference_frame=self._reference_frame)
        _worker(self._types.SetModelState).put(self._model, state)

    def close(self) -> None:
        """Unregister the topics. The model stays where it is."""
        super().close()
        _worker(self._types.SetModelState).forget(self._model)


class ModelWorker:
    """One thread that calls ``set_state(state)`` with the latest state of each model.

    ``set_state`` returns '' or what went wrong. After a fault the thread tries again in a second, and serves the other
    models meanwhile. ``warn(text)`` gets the fault.
    """

    def __init__(self, set_state: _Caller, warn: Callable[[str], object]) -> None:
        self._set_state = set_state
        self._warn = warn
        self._condition = threading.Condition()
        self._waiting: Dict[str, Any] = {}
        threading.Thread(target=self._run, name='gazebo', daemon=True).start()

    def put(self, model: str, state: Any) -> None:
        """Make the thread set ``model`` to ``state``; returns at once."""
        with self._condition:
            self._waiting[model] = (0.0, state)
            self._condition.notify()

    def forget(self, model: str) -> None:
        """Do not set ``model`` any more."""
        with self._condition:
            self._waiting.pop(model, None)

    def _run(self) -> None:
        while True:
            model, state = self._next()
            fault = self._set_state(state)
            if fault:
                self._warn("model '{}' could not be placed: {}".format(model, fault))
                with self._condition:
                    self._waiting.setdefault(model, (time.monotonic() + _RETRY_SECONDS, state))

    def _next(self) -> Tuple[str, Any]:
        with self._condition:
            while True:
                wall = time.monotonic()
                for model, (not_before, state) in self._waiting.items():
                    if not_before <= wall:
                        del self._waiting[model]
                        return model, state
                first = min((not_before for not_before, _ in self._waiting.values()), default=None)
                self._condition.wait(None if first is None else first - wall)


class _Caller:
    """Calls the service over one connection. After a failure the next call makes a new connection."""

    def __init__(self, service_type: Type[Any]) -> None:
        self._service_type = service_type
        self._proxy: Any = None

    def __call__(self, state: Any) -> str:
        try:
            if self._proxy is None:
                self._proxy = rospy.ServiceProxy(SERVICE, self._service_type, persistent=True)
            answer = self._proxy(model_state=state)
        except (rospy.ROSException, rospy.ServiceException, OSError) as error:
            self._proxy = None
            return '{}: {}'.format(SERVICE, error)
        clock_check.warn_if_shared('Gazebo')
        return '' if answer.success else 'Gazebo says: {}'.format(answer.status_message)


class _Types(NamedTuple):
    """The two types of gazebo_msgs that this module uses."""

    ModelState: Any
    SetModelState: Any


def _import_types(where: str) -> _Types:
    try:
        from gazebo_msgs.msg import ModelState
        from gazebo_msgs.srv import SetModelState
    except ImportError as error:
        raise ConfigurationError(
            "parameter {}/backend: got 'gazebo', which needs the ROS package gazebo_msgs ({}); install it (ROS Noetic: "
            'apt install ros-noetic-gazebo-msgs; Debian has none, build it from gazebo_ros_pkgs 2.9) or choose '
            'another backend'.format(where, error)) from None
    return _Types(ModelState, SetModelState)


_lock = threading.Lock()
_shared: List[Any] = []


def _worker(service_type: Type[Any]) -> ModelWorker:
    """Return the only ModelWorker of the process. The first call makes it."""
    with _lock:
        if not _shared:
            throttle = WallThrottle(_WARNINGS_RATE)
            _shared.append(ModelWorker(_Caller(service_type), lambda text: throttle.ready() and rospy.logwarn(
                '%s: %s', rospy.get_name(), text)))
        return _shared[0]
