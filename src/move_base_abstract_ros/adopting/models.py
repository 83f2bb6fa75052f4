"""Read what a model for Gazebo says of its drive and its laser: its URDF, or its xacro files as they are.

xacro itself may not be here. So values that are more than numbers or names of properties (`${2*r}`, `$(arg ...)`) are
not known.
"""
import os
import re
from itertools import islice
from xml.etree import ElementTree

from . import poses, reading

_FIND = re.compile(r'\$\(find\s+([\w.-]+)\s*\)')
_VALUE = re.compile(r'\$\{\s*(\w+)\s*\}')
_PREFIX = re.compile(r'(</?)(\w+):')
_PLACE = re.compile(r'(.*?):(\d+)(?:, included at .*)?')
_RAYS = ('ray', 'gpu_ray', 'lidar', 'gpu_lidar')
_BASES = ('base_footprint', 'base_link', 'chassis', 'base')
_DRIVES = ('gazebo_ros_diff_drive', 'gazebo_ros_skid_steer_drive', 'gazebo_ros_planar_move')
_LARGEST = 1 << 20  # characters of a file
_MOST_FILES = 50
_MOST_PARTS = 1000  # of one kind
#: the TurtleBot3s, by their public descriptions: radius [m] or outline, and (x, z) of the laser in base_footprint [m]
_TURTLEBOTS = {'burger': ({'robot_radius': 0.105}, (-0.032, 0.182)),
               'waffle': ({'footprint': [[-0.205, -0.155], [-0.205, 0.155], [0.077, 0.155], [0.077, -0.155]]},
                          (-0.064, 0.132))}
_OF_TURTLEBOT = re.compile(r'turtlebot3_(burger|waffle)')
_TURTLEBOT = """<robot><plugin filename="gazebo_ros_diff_drive"><updateRate>30</updateRate>
  <robotBaseFrame>base_footprint</robotBaseFrame></plugin>
<sensor type="ray"><update_rate>5</update_rate><samples>360</samples><min_angle>0.0</min_angle>
  <max_angle>6.28319</max_angle><min>0.120</min><max>3.5</max><stddev>0.01</stddev>
  <topicName>scan</topicName><frameName>base_scan</frameName></sensor>
<joint type="fixed"><child link="base_scan"/><origin xyz="{} 0 {}"/></joint></robot>"""


def model_of(config, node):
    """Return (the model that a spawner puts into Gazebo, what is known of its size as parameters).

    The model is an Element with the XML of its files, which is empty if it is not here. ``node``: the spawner, a
    roslaunch Node.
    """
    words = poses.words_of(node.args)
    named = {word: after for word, after in zip(words, words[1:]) if word in ('-param', '-file')}
    value = config.params.get(poses.ns_join(node.namespace, named.get('-param', 'robot_description')))
    text = str(value.value) if value is not None and value.value else ''
    command = '' if text else _command_of(config, node, named.get('-param', ''))
    model = ElementTree.Element('all')
    if text:
        model.extend(_parsed(text))
    else:
        _read(model, [word for word in [*poses.words_of(command), named.get('-file', '')] if os.path.isfile(word)])
    known = _OF_TURTLEBOT.search('{} {}'.format(command, ' '.join(one.get('name', '') for one in model)))
    if known:
        size, laser = _TURTLEBOTS[known.group(1)]
        model.extend(() if len(model) else _parsed(_TURTLEBOT.format(*laser)))
        return model, size
    return model, _size_of(model)


def _command_of(config, node, name):
    """Return the command that would have made the parameter ``name`` of a spawner, and that is not here, or ''."""
    path, line = _placed(node.filename)
    found = [(_placed(one.place), one.name.partition(': ')[2]) for one in getattr(config, 'missing', ())
             if one.kind == 'parameter' and name and one.name.partition(': ')[0].endswith(name.rpartition('/')[2])]
    before = [command for (file, at), command in found if file == path and at <= line]
    return before[-1] if before else found[0][1] if found else ''


def _placed(place):
    """Return (file, line) of a place in a launch file, as reading.Tolerant notes it."""
    found = _PLACE.fullmatch(place or '')
    return (found.group(1), int(found.group(2))) if found else ('', 0)


def _parsed(text):
    """Return [the root of an XML text], whose prefixes are parts of the names; [] if the text is none."""
    first, *others = text.strip().split('<!--')
    text = ''.join([first, *(one.partition('-->')[2] for one in others)])  # Gazebo reads comments with -- in them, too
    try:
        return [] if '<!ENTITY' in text else [ElementTree.fromstring(_PREFIX.sub(r'\1\2_', text))]
    except (ElementTree.ParseError, ValueError):
        return []


def _read(model, paths):
    """Add to a model what xacro files and those that they include have, without unused macros."""
    known = []
    while paths and len(known) < _MOST_FILES:
        path = paths.pop(0)
        if path in known or not os.path.isfile(path):
            continue
        known.append(path)
        with open(path, 'rb') as stream:
            found = _parsed(stream.read(_LARGEST).decode('utf-8', 'replace'))
        model.extend(found)
        paths += [os.path.join(os.path.dirname(path), _FIND.sub(
            lambda found: reading.folder_of(found.group(1)), one.get('filename', '')))
            for root in found for one in root.iter('xacro_include')]
    values = {one.get('name'): one.get('value', '') for one in model.iter('xacro_property')
              if '$' not in one.get('value', '')}
    used = {one.tag for one in model.iter()}
    for one in list(model.iter()):
        one[:] = [part for part in one if part.tag != 'xacro_macro' or 'xacro_' + part.get('name', '') in used]
        one.text = _filled(one.text or '', values)
        one.attrib.update((key, _filled(text, values)) for key, text in one.items())


def _filled(text, values):
    return _VALUE.sub(lambda found: values.get(found.group(1), found.group()), text)


def _parts(model, kind):
    return islice(model.iter(kind), _MOST_PARTS)


def _size_of(model):
    """Return the outline of a model's base as parameters of a robot: that of the first body that collides, or {}."""
    for link in _parts(model, 'link'):
        bodies = link.iterfind('collision//*') if link.get('name', '').rpartition('/')[2] in _BASES else ()
        words = next((one.get('radius') or one.get('size', '') for one in bodies if one.tag in ('cylinder', 'box')), '')
        numbers = [poses.number_of(word) for word in words.split()]
        if None not in numbers and len(numbers) == 1:
            return {'robot_radius': numbers[0]}
        if None not in numbers and len(numbers) == 3:
            x, y = numbers[0] / 2, numbers[1] / 2
            return {'footprint': [[-x, -y], [-x, y], [x, y], [x, -y]]}
    return {}


def _plugins(model):
    """Yield (name, {tag: its text}) of each plugin of a model."""
    for one in _parts(model, 'plugin'):
        yield re.sub(r'^lib|\.so$', '', one.get('filename', '')), _tags(one)


def drive_of(model):
    """Return {tag: its text} of the plugin that drives a model, with 'plugin', its name; {} if the model has none."""
    return next(({'plugin': name, **tags} for name, tags in _plugins(model) if name in _DRIVES), {})


def truth_topic(model):
    """Return the topic on which a plugin tells a model's true pose, or ''."""
    return next((tags.get('topicName', '') for name, tags in _plugins(model) if name == 'gazebo_ros_p3d'), '')


def laser_of(model):
    """Return the parameters of a model's first laser; {} if the model has none, or if numbers of it are not known."""
    for rays in (one for one in _parts(model, 'sensor') if one.get('type') in _RAYS):
        tags, horizontal, span = _tags(rays), _tags(rays, 'horizontal'), _tags(rays, 'range')
        numbers = [_number(*one) for one in (
            (horizontal, 'samples', None), (horizontal, 'min_angle', None), (horizontal, 'max_angle', None),
            (tags, 'update_rate', 10.0), (tags, 'stddev', 0.0), (span, 'min', None), (span, 'max', None))]
        if None in numbers:
            continue
        beams, first, last, rate, noise, nearest, farthest = numbers
        frame = tags.get('frameName', 'base_laser_link').lstrip('/')
        x, y, z, yaw = _place_of(model, frame)
        return {'scan_rate': rate, 'scan_beams': int(beams), 'scan_angle_min': first, 'scan_angle_max': last,
                'scan_range_min': nearest, 'scan_range_max': farthest, 'scan_noise': noise, 'scan_frame': frame,
                'scan_topic': tags.get('topicName', 'scan'), 'scan_x': x, 'scan_y': y, 'scan_z': z,
                'scan_yaw': yaw}
    return {}


def _place_of(model, frame):
    """Return (x, y, z [m], yaw [rad]) of a fixed link on its parent, as far as it is written in numbers."""
    for joint in model.iter('joint'):
        child, origin = joint.find('child'), joint.find('origin')
        if child is not None and child.get('link') == frame:
            xyz, rpy = (('' if origin is None else origin.get(key, '')).split() for key in ('xyz', 'rpy'))
            x, y, z = [*map(poses.number_of, xyz), 0.0, 0.0, 0.0][:3]
            return x or 0.0, y or 0.0, z or 0.0, ([*map(poses.number_of, rpy), 0.0, 0.0, 0.0][2] or 0.0)
    return 0.0, 0.0, 0.0, 0.0


def _tags(element, part=None):
    """Return {tag: its text} of what is in an element, or in the first ``part`` of it if it has one."""
    inner = None if part is None else next(element.iter(part), None)
    return {one.tag: one.text.strip() for one in (element if inner is None else inner).iter()
            if one.text and one.text.strip() and '$' not in one.text}


def _number(tags, key, default):
    found = poses.number_of(tags.get(key, ''))
    return default if found is None else found
