"""Say what a velocity robot needs to take the place of what drove a robot: Stage, Gazebo, a controller, or a driver."""
from typing import NamedTuple

from . import kinds, models, poses, served

NODE = 'velocity_robot'
#: {type of a controller: whether it drives sideways}
_CONTROLLERS = {'diff_drive_controller/DiffDriveController': False,
                'mecanum_drive_controller/MecanumDriveController': True}
#: parameters of such controllers that are those of the velocity robot, too
_OF_CONTROLLER = ('cmd_vel_timeout', 'linear', 'angular')
_JERK = ('has_jerk_limits', 'min_jerk', 'max_jerk')


class Drive(NamedTuple):
    """What a velocity robot gets: ``params``, {name: value}; ``topics``, {its name: the file's}; ``remarks``: texts."""

    params: dict
    topics: dict
    remarks: list


def drive_of(config, hint, stages):
    """Return the Drive of the robot that a poses.Hint is about. ``stages``: the Stages of the file."""
    if hint.source == poses.STAGE:
        return _of_stage(config, hint.body, stages)
    if hint.source == poses.SPAWNED and hint.node is not None:
        return _of_gazebo(config, hint)
    topics = kinds.DRIVERS.get((hint.node.package, hint.node.type), {}) if hint.node is not None else {}
    return Drive({'robot_base_frame': 'base_footprint', 'publish_rate': 30.0}, _remapped(hint.node, dict(topics)), [])


def _of_stage(config, body, stages):
    stage = stages[0]
    timeout = config.params.get(poses.name_of(stage.node) + '/base_watchdog_timeout')
    params = {'base_watchdog_timeout': 0.2 if timeout is None else timeout.value,
              'holonomic': body.is_omni, 'footprint': _outline(body), 'publish_rate': 1.0 / stage.interval}
    for group, axis, (least, most) in zip(('linear', 'linear', 'angular'), 'xyz', body.bounds):
        params.setdefault(group, {})[axis] = {
            'has_velocity_limits': True, 'min_velocity': least, 'max_velocity': most}
    if body.origin is not None:
        params['odom_origin'] = list(body.origin)
    if body.odom_error is not None:
        params['odom_error'] = list(body.odom_error)
    remarks = []
    if body.lasers:
        laser = body.lasers[0]
        params.update(zip(('scan_x', 'scan_y', 'scan_yaw'), laser.pose), scan_z=laser.height)
        params.update(
            scan_rate=1.0 / stage.interval, scan_beams=laser.beams, scan_angle_min=laser.first,
            scan_angle_max=laser.last, scan_range_min=laser.nearest, scan_range_max=laser.farthest,
            scan_frame='base_laser_link', scan_topic='base_scan')
    if len(body.lasers) > 1:
        params.update(scan_frame='base_laser_link_0', scan_topic='base_scan_0')
        remarks.append('it has {} lasers in the world, and one here'.format(len(body.lasers)))
    return Drive(params, {}, remarks)


def _outline(body):
    (length, width), (x, y) = body.size, body.centre
    return [[round(x + dx * length / 2, 9), round(y + dy * width / 2, 9)]
            for dx, dy in ((-1, -1), (-1, 1), (1, 1), (1, -1))]


def _of_gazebo(config, hint):
    model, size = models.model_of(config, hint.node)
    laser, truth = models.laser_of(model), models.truth_topic(model)
    drive, controller = models.drive_of(model), _controller_of(config, hint.namespace)
    params = {**size, **laser}
    topics = {'base_pose_ground_truth': truth} if truth else {}
    remarks = [] if laser else ['no laser is seen in its model' if len(model) else (
        'its model is not here, or is no XML: its size, its laser and the topics of its plugins are not known')]
    if controller:
        name, values, is_holonomic = controller
        topics.update(cmd_vel=name + '/cmd_vel', odom=name + '/odom')
        params.update({key: _without_jerk(values[key]) for key in _OF_CONTROLLER if key in values})
        params.update(robot_base_frame=str(values.get('base_frame_id', 'base_link')).strip('/'), holonomic=is_holonomic,
                      publish_rate=_positive(values.get('publish_rate'), 50.0))
        return Drive(params, topics, remarks)
    params.update(robot_base_frame=drive.get('robotBaseFrame', 'base_footprint').strip('/'), cmd_vel_timeout=0.0,
                  holonomic=drive.get('plugin') == 'gazebo_ros_planar_move',
                  publish_rate=_positive(drive.get('updateRate') or drive.get('odometryRate'), 30.0))
    if drive.get('odometrySource', 'world') not in ('encoder', '0'):
        params['odom_origin'] = [0.0, 0.0, 0.0]  # the plugin tells the model's pose in Gazebo's world
    topics.update((ours, drive[tag]) for ours, tag in (('cmd_vel', 'commandTopic'), ('odom', 'odometryTopic'))
                  if drive.get(tag, ours) != ours)
    return Drive(params, topics, remarks)


def _controller_of(config, namespace):
    """Return (name, its parameters as nested mappings, whether it drives sideways) of a robot's controller, or None."""
    for key, param in config.params.items():
        if key.startswith(namespace) and key.endswith('/type') and param.value in _CONTROLLERS:
            name = key[len(namespace):-len('/type')]
            values = served.below(namespace + name, {full: one.value for full, one in config.params.items()})
            return name, values, _CONTROLLERS[param.value]
    return None


def _without_jerk(value):
    return {key: _without_jerk(one) for key, one in value.items() if key not in _JERK} if isinstance(
        value, dict) else value


def _positive(value, default):
    found = poses.number_of(value)
    return found if found is not None and found > 0.0 else default


def _remapped(node, topics):
    """Return the topics with the remaps of a node, which name them as the node does."""
    remaps = {old.strip('/'): new for old, new in node.remap_args} if node is not None else {}
    return {ours: found for ours in ('cmd_vel', 'odom', 'base_pose_ground_truth')
            for found in [remaps.get(topics.get(ours, ours), topics.get(ours, ours))] if found != ours}
