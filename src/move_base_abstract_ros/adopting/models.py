"""Read what a model for Gazebo says of its drive and its laser: its URDF, or the text of its xacro files as it is.

xacro itself may not be here. So values that are more than numbers or names of properties (`${2*r}`, `$(arg ...)`) are
not known.
"""
import os
import re

from . import poses, reading

_COMMENT = re.compile(r'<!--.*?-->', re.DOTALL)
_INCLUDE = re.compile(r'<xacro:include\s[^>]*filename\s*=\s*"([^"]+)"')
_MACRO = re.compile(r'<xacro:macro\s[^>]*name\s*=\s*"([\w.-]+)".*?</xacro:macro>', re.DOTALL)
_FIND = re.compile(r'\$\(find\s+([\w.-]+)\s*\)')
_PLUGIN = re.compile(r'<plugin\s[^>]*filename\s*=\s*"(?:lib)?([\w.-]+?)(?:\.so)?"[^>]*>(.*?)</plugin>', re.DOTALL)
_RAYS = re.compile(r'<sensor\s[^>]*type\s*=\s*"(?:gpu_)?(?:ray|lidar)"[^>]*>(.*?)</sensor>', re.DOTALL)
_PROPERTY = re.compile(r'<xacro:property\s+name\s*=\s*"(\w+)"\s+value\s*=\s*"([^"$]*)"')
_LINK = re.compile(r'<link\s+name\s*=\s*"([^"]*)"\s*>(.*?)</link>', re.DOTALL)
_OUTLINE = re.compile(r'<cylinder\s[^>]*radius\s*=\s*"([^"]*)"|<box\s+size\s*=\s*"([^"]*)"')
_BASES = ('base_footprint', 'base_link', 'chassis', 'base')
_JOINT = re.compile(r'<joint\s.*?</joint>', re.DOTALL)
_DRIVES = ('gazebo_ros_diff_drive', 'gazebo_ros_skid_steer_drive', 'gazebo_ros_planar_move')
_LARGEST = 1 << 20  # characters of a file
_MOST_FILES = 50
#: the TurtleBot3s, by their public descriptions: radius [m] or outline, and (x, z) of the laser in base_footprint [m]
_TURTLEBOTS = {'burger': ({'robot_radius': 0.105}, (-0.032, 0.182)),
               'waffle': ({'footprint': [[-0.205, -0.155], [-0.205, 0.155], [0.077, 0.155], [0.077, -0.155]]},
                          (-0.064, 0.132))}
_OF_TURTLEBOT = re.compile(r'turtlebot3_(burger|waffle)')
_TURTLEBOT = """<plugin filename="gazebo_ros_diff_drive"><updateRate>30</updateRate>
  <robotBaseFrame>base_footprint</robotBaseFrame></plugin>
<sensor type="ray"><update_rate>5</update_rate><samples>360</samples><min_angle>0.0</min_angle>
  <max_angle>6.28319</max_angle><min>0.120</min><max>3.5</max><stddev>0.01</stddev>
  <topicName>scan</topicName><frameName>base_scan</frameName></sensor>
<joint type="fixed"><child link="base_scan"/><origin xyz="{} 0 {}"/></joint>"""


def text_of(config, node):
    """Return (the text of the model that a spawner puts into Gazebo, what is known of its size as parameters).

    The text is '' if it is not here. ``node``: the spawner, a roslaunch Node.
    """
    words = poses.words_of(node.args)
    named = {word: after for word, after in zip(words, words[1:]) if word in ('-param', '-file')}
    value = config.params.get(poses.ns_join(node.namespace, named.get('-param', 'robot_description')))
    command = '' if value is not None and value.value else _command_of(config, node, named.get('-param', ''))
    if value is not None and value.value:
        text = str(value.value)
    else:
        paths = [word for word in [*poses.words_of(command), named.get('-file', '')] if os.path.isfile(word)]
        text = _read(paths, [])
    known = _OF_TURTLEBOT.search('{} {}'.format(command, text[:_LARGEST]))
    size, laser = _TURTLEBOTS[known.group(1)] if known else (_size_of(text), ())
    return text or (_TURTLEBOT.format(*laser) if known else ''), size


def _command_of(config, node, name):
    """Return the command that would have made the parameter ``name`` of a spawner, and that is not here, or ''."""
    path, _, line = node.filename.partition(',')[0].rpartition(':')
    found = [(one.place.partition(',')[0].rpartition(':'), one.name.partition(': ')[2])
             for one in getattr(config, 'missing', ())
             if one.kind == 'parameter' and name and one.name.partition(': ')[0].endswith(name.rpartition('/')[2])]
    before = [command for (file, _, at), command in found if file == path and int(at) <= int(line or 0)]
    return before[-1] if before else found[0][1] if found else ''


def _read(paths, known):
    """Return the text of xacro files and of those that they include, without comments and without unused macros."""
    parts = []
    while paths and len(known) < _MOST_FILES:
        path = paths.pop(0)
        if path in known or not os.path.isfile(path):
            continue
        known.append(path)
        with open(path, encoding='utf-8', errors='replace') as stream:
            parts.append(_COMMENT.sub('', stream.read(_LARGEST)))
        named = [_FIND.sub(lambda found: reading.folder_of(found.group(1)), one) for one in _INCLUDE.findall(parts[-1])]
        paths += [os.path.join(os.path.dirname(path), one) for one in named]
    text = '\n'.join(parts)
    known_values = dict(_PROPERTY.findall(text))
    text = re.sub(r'\$\{\s*(\w+)\s*\}', lambda found: known_values.get(found.group(1), found.group()), text)
    return _MACRO.sub(lambda found: found.group() if re.search(
        '<xacro:{}[ />]'.format(re.escape(found.group(1))), text) else '', text)


def _size_of(text):
    """Return the outline of a model's base as parameters of a robot: that of the first body that collides, or {}."""
    for name, body in _LINK.findall(text):
        found = _OUTLINE.search(body.partition('<collision')[2]) if name.rpartition('/')[2] in _BASES else None
        numbers = [poses.number_of(word) for word in (found.group(1) or found.group(2)).split()] if found else []
        if None not in numbers and len(numbers) == 1:
            return {'robot_radius': numbers[0]}
        if None not in numbers and len(numbers) == 3:
            x, y = numbers[0] / 2, numbers[1] / 2
            return {'footprint': [[-x, -y], [-x, y], [x, y], [x, -y]]}
    return {}


def drive_of(text):
    """Return {tag: its text} of the plugin that drives a model, with 'plugin', its name; {} if the text has none."""
    for name, body in _PLUGIN.findall(text):
        if name in _DRIVES:
            return {'plugin': name, **_tags(body)}
    return {}


def truth_topic(text):
    """Return the topic on which a plugin tells a model's true pose, or ''."""
    return next((_tags(body).get('topicName', '') for name, body in _PLUGIN.findall(text)
                 if name == 'gazebo_ros_p3d'), '')


def laser_of(text):
    """Return the parameters of a model's first laser; {} if the text has none, or if numbers of it are not known."""
    for body in _RAYS.findall(text):
        tags, horizontal = _tags(body), _tags(body.partition('<vertical>')[0])
        numbers = [_number(tags if key in ('update_rate', 'stddev') else horizontal, key, default) for key, default in (
            ('samples', None), ('min_angle', None), ('max_angle', None), ('update_rate', 10.0), ('stddev', 0.0))]
        span = _tags(body.partition('<range>')[2] or body)
        numbers += [_number(span, 'min', None), _number(span, 'max', None)]
        if None in numbers:
            continue
        beams, first, last, rate, noise, nearest, farthest = numbers
        frame = tags.get('frameName', 'base_laser_link').lstrip('/')
        x, y, z, yaw = _place_of(text, frame)
        return {'scan_rate': rate, 'scan_beams': int(beams), 'scan_angle_min': first, 'scan_angle_max': last,
                'scan_range_min': nearest, 'scan_range_max': farthest, 'scan_noise': noise, 'scan_frame': frame,
                'scan_topic': tags.get('topicName', 'scan'), 'scan_x': x, 'scan_y': y, 'scan_z': z,
                'scan_yaw': yaw}
    return {}


def _place_of(text, frame):
    """Return (x, y, z [m], yaw [rad]) of a fixed link on its parent, as far as it is written in numbers."""
    for joint in _JOINT.findall(text):
        if re.search(r'<child\s+link\s*=\s*"{}"'.format(re.escape(frame)), joint):
            found = [re.search(r'{}\s*=\s*"([^"]*)"'.format(key), joint) for key in ('xyz', 'rpy')]
            xyz, rpy = (one.group(1).split() if one else [] for one in found)
            x, y, z = [*map(poses.number_of, xyz), 0.0, 0.0, 0.0][:3]
            return x or 0.0, y or 0.0, z or 0.0, ([*map(poses.number_of, rpy), 0.0, 0.0, 0.0][2] or 0.0)
    return 0.0, 0.0, 0.0, 0.0


def _tags(body):
    return {key: value.strip() for key, value in re.findall(r'<(\w+)>\s*([^<]*?)\s*</\1>', body)
            if value.strip() and '$' not in value}


def _number(tags, key, default):
    found = poses.number_of(tags.get(key, ''))
    return default if found is None else found
