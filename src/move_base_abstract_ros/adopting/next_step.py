"""Tell the user what to type next, after an error of a launch file."""
import re
from xml.etree import ElementTree

from move_base_abstract.common.errors import ConfigurationError

#: parts of errors of launch files that were written for something that is not here
_OF_OTHERS = ('publishes /clock', 'does not exist', 'unknown machine', 'environment variable')
_OF_ROSLAUNCH = 'No such file'  # in an error of ours, the file is one that the user names


def with_next(error, path, adopts):
    """Return an error's text, with what the user can type next.

    ``path``: that of the launch file; ``adopts``: whether --adopt was given.
    """
    from rospkg import ResourceNotFound
    text = str(error)
    asked = re.search("requires the '(\\w+)' arg to be set|arg '(\\w+)' is not defined", text)
    if asked:
        names = dict.fromkeys([asked.group(1) or asked.group(2), *_wanted(path)])
        return '{}. Behind the file: {}'.format(text, ' '.join(name + ':=VALUE' for name in names))
    if path.endswith('.py'):
        return '{}. It is a launch file of ROS 2; this is ROS 1, whose launch files are XML'.format(text)
    if isinstance(error, ResourceNotFound):
        name = text.partition('\nROS path')[0].rpartition(': ')[2]
        text = 'the package {} is not found here; is its workspace sourced?'.format(name)
    elif not any(words in text for words in _OF_OTHERS) and (
            _OF_ROSLAUNCH not in text or isinstance(error, ConfigurationError)):
        return text
    stop = '' if text.endswith(('.', '?')) else '.'
    return text if adopts else (text + stop + ' If the file was written for Gazebo, Stage or real robots, --adopt '
                                'leaves out what is not here, and says what it does')


def _wanted(path):
    """Return the names of the arguments that a launch file needs, and for which it has no value."""
    root = ElementTree.parse(path).getroot()
    given = {tag.get('name') for tag in root.findall('arg') if {'value', 'default'} & set(tag.attrib)}
    asked = [tag.get('name') for tag in root.findall('arg')]
    asked += [name for tag in root.iter() for text in tag.attrib.values()
              for name in re.findall(r'\$\(arg (\w+)\)', text)]
    return [name for name in dict.fromkeys(asked) if name not in given]
