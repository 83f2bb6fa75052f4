"""A loader of launch files, which leaves out what a file names and is not here, and notes the place in the file."""
import glob
import os
import re
import shlex
import shutil
from typing import NamedTuple
from xml.dom import expatbuilder

import rospkg
import yaml
from rosgraph.names import ns_join
from roslaunch import substitution_args
from roslaunch.core import RLException
from roslaunch.loader import LoadException
from roslaunch.xmlloader import XmlLoader, XmlParseException, ifunless_test

from move_base_abstract.common import bounded_yaml

from . import kinds, neighbours

NOT_INSTALLED = '/not_installed/'  # stands for the folder of packages that are not here; it does not exist
#: values of environment variables that launch files ask for, if they are not set
ENVIRONMENT = {'TURTLEBOT3_MODEL': 'burger'}
_FIND = re.compile(r'\$\(find\s+([\w.-]+)\s*\)')
_ENV = re.compile(r'\$\(env\s+(\w+)\s*\)')
_ENV_IN_EVAL = re.compile(r'\benv\(\s*[\'"](\w+)[\'"]\s*\)')
_DEEPEST = 100
_MOST_INCLUDED = 1000
_LARGEST = 2 ** 31 - 1  # the largest integer of XML-RPC
_FIND_IN_HOOK = re.compile(r'(?:`|\$\()\s*rospack\s+find\s+([\w.-]+)\s*(?:`|\))|@\(CMAKE_CURRENT_SOURCE_DIR\)')
_LARGEST_HOOK = 1 << 16  # bytes of a file


class Missing(NamedTuple):
    """Something that a launch file names and that is not here.

    ``kind``: 'include', 'parameters' (a file of them), 'parameter', 'variable' (of the environment); 'argument': it is
    given to an include that does not read it; 'relative': an include that is found only beside its file; 'value': a
    parameter whose value no parameter server accepts. ``arguments``: those of an include, ((name, text), ...).
    ``namespace``: the one in which it is named. ``place``: 'FILE:LINE'.
    """

    kind: str
    name: str
    place: str
    namespace: str = '/'
    arguments: tuple = ()


def told(kind, name):
    """Return a text: something that a launch file names is not here, and what happens instead."""
    if kind == 'variable':
        return "the environment has no {0}, and '{1}' is taken: export {0}=VALUE sets another".format(
            name, ENVIRONMENT.get(name, ''))
    if kind == 'argument':
        return '{}: roslaunch would refuse these arguments; here they are left out'.format(name)
    if kind == 'relative':
        return '{} is taken from beside the file that includes it: roslaunch would not look there'.format(name)
    if kind == 'value':
        return ('{0} is not set: it has no value, or an integer beyond 32 bits, which roslaunch would refuse; '
                '--param {0}=VALUE sets one').format(name)
    place = name.replace(NOT_INSTALLED, '')
    if kind == 'include':
        return '{} is not here, and is left out: {}'.format(place, (
            'a robot takes its place' if kinds.stands_for_a_robot(name) else 'the nodes in it are not started'))
    what = 'parameters are' if kind == 'parameters' else 'parameter is'
    return '{} is not here, so that its {} not set, and defaults apply'.format(place, what)


class _PlacedError(XmlParseException):
    """An error of roslaunch's loader whose text names the file and the line of its tag."""


class PlacingLoader(XmlLoader):
    """roslaunch's loader, whose errors name file and line."""

    def _parse_launch(self, filename, verbose):
        try:
            with open(filename, 'rb') as stream:
                root = _Builder().parseFile(stream).getElementsByTagName('launch')
        except Exception as error:
            raise XmlParseException('{}: Invalid roslaunch XML syntax: {}'.format(filename, error)) from None
        if len(root) != 1:
            raise XmlParseException('{}: Invalid roslaunch XML syntax: no root <launch> tag'.format(filename))
        root[0].ownerDocument.path = filename
        return root[0]

    def _place_of(self, tag):
        path = getattr(tag.ownerDocument, 'path', '')
        return '{}, line {}: '.format(path, tag.line) if path else ''

    def _recurse_load(self, ros_config, tags, context, default_machine, is_core, verbose):
        for tag in tags:
            try:
                default_machine = super()._recurse_load(ros_config, [tag], context, default_machine, is_core, verbose)
            except (_PlacedError, substitution_args.ArgException, rospkg.ResourceNotFound, OSError):
                raise  # the loader catches an ArgException, and names the file that lacks the argument
            except Exception as error:  # $(eval ...) may raise any
                if isinstance(error, RLException) and not isinstance(error, XmlParseException):
                    raise
                is_clear = isinstance(error, (XmlParseException, substitution_args.SubstitutionException))
                text = str(error) if is_clear else 'invalid <{}> tag: {}: {}'.format(
                    tag.tagName, type(error).__name__, error)
                raise _PlacedError(self._place_of(tag) + text) from None
        return default_machine


class Tolerant:
    """Makes a loader of roslaunch tolerant. In a class it must come before that loader among the bases.

    ``missing``: [Missing] that were left out. The configuration gets this list, too, and ``taken``: {package: folder}
    of packages that lie beside the file. The ``filename`` of a node becomes its place, 'FILE:LINE'.
    """

    def __init__(self, *arguments, **others):
        """Take the arguments of roslaunch's loader."""
        super().__init__(*arguments, **others)
        self.missing = []
        self._packages = _Packages()
        self._first = None
        self._chain = []
        self._included = 0
        self._place = ''

    def load(self, filename, ros_config, core=False, argv=None, verbose=True):
        """Load a launch file into a configuration, as roslaunch's loader does. Errors get the place in the file."""
        self._first = self._packages.first = None if core else filename
        substitution_args._rospack = self._packages  # roslaunch asks this object for the folders of packages
        try:
            super().load(filename, ros_config, core=core, argv=argv, verbose=verbose)
        except RLException as error:
            raise self._with_place(error) from None
        finally:
            substitution_args._rospack = None
        if not core:
            self._without_refused(ros_config, filename)
            ros_config.missing, ros_config.taken = self.missing, self._packages.taken

    def _with_place(self, error):
        """Return an error of roslaunch with the place in the file, because errors of a tag do not have it."""
        if not self._place or self._place in str(error) or 'Invalid roslaunch XML syntax' in str(error):
            return error
        return type(error)('{} ({})'.format(error, self._with_chain(self._place)))

    def resolve_args(self, args, context):
        """Resolve as roslaunch's loader does. A package that is not here gets a folder that does not exist."""
        if args and '$' in args and self._first is not None:
            in_eval = args.startswith('$(eval')
            args = args if in_eval else _FIND.sub(self._package, args)
            args = (_ENV_IN_EVAL if in_eval else _ENV).sub(lambda found: self._variable(found, in_eval), args)
        return super().resolve_args(args, context)

    def opt_attrs(self, tag, context, attrs):
        """Note the place of the tag, and return its attributes as roslaunch's loader does."""
        self._note(tag, context)
        return super().opt_attrs(tag, context, attrs)

    def reqd_attrs(self, tag, context, attrs):
        """Note the place of the tag, and return its attributes as roslaunch's loader does."""
        self._note(tag, context)
        return super().reqd_attrs(tag, context, attrs)

    def load_rosparam(self, context, ros_config, cmd, param, file_, text, verbose=True, subst_function=None):
        """Load parameters as roslaunch's loader does. A file that is not here is noted in ``missing``."""
        if cmd == 'load' and file_ is not None and not os.path.isfile(file_):
            self._miss('parameters', file_, context.ns)
            return
        if cmd == 'load':
            _check_size(_start_of(file_) if file_ is not None else text or '')
        super().load_rosparam(context, ros_config, cmd, param, file_, text, verbose, subst_function)
        self._without_refused(ros_config, self._with_chain(self._place))

    def _without_refused(self, ros_config, place):
        for key in [key for key, found in ros_config.params.items() if _is_refused(found.value)]:
            del ros_config.params[key]
            self._missed('value', key, place)

    def param_value(self, verbose, name, ptype, value, textfile, binfile, command):
        """Return the value of a parameter as roslaunch's loader does; '' if its file or its program is not here."""
        path = textfile or binfile
        if path and not os.path.isfile(path) or command and not _is_there(command):
            return self._miss('parameter', '{}: {}'.format(name, path or command))
        try:
            return super().param_value(verbose, name, ptype, value, textfile, binfile, command)
        except (ValueError, OSError):
            if not command:
                raise
            return self._miss('parameter', '{}: {}'.format(name, command))

    def _place_of(self, _tag):
        """Return '': load() adds the place to errors."""
        return ''

    def _include_tag(self, tag, context, ros_config, default_machine, is_core, verbose):
        if is_core or not ifunless_test(self, tag, context):
            return None
        self._note(tag, context)
        path = self._path_of(tag, context)
        if not os.path.isfile(path):
            self._miss('include', path, *self._asked(tag, context))
            return None
        self._included += 1
        if len(self._chain) > _DEEPEST or self._included > _MOST_INCLUDED:
            raise XmlParseException('{}: files include one another without an end'.format(self._place))
        self._chain.append(self._place)
        made = None
        try:
            made = super()._include_tag(tag, context, ros_config, default_machine, is_core, verbose)
        except LoadException as error:
            if not str(error).startswith('unused args'):
                raise
            self._missed('argument', str(error), self._chain[-1])  # roslaunch has read the file before this error
        self._chain.pop()  # after another error it stays, because it is a part of the place
        return made

    def _path_of(self, tag, context):
        """Return the path of an include. A relative path that does not exist may lie beside the including file."""
        if 'file' not in tag.attributes:
            raise XmlParseException("<include> tag is missing required attribute: 'file'")
        path = self.resolve_args(tag.attributes['file'].value, context)
        beside = os.path.join(os.path.dirname(os.path.abspath(context.filename)), path)
        if os.path.isabs(path) or os.path.isfile(path) or not os.path.isfile(beside):
            return path
        self._miss('relative', path)
        tag.setAttribute('file', beside)
        return beside

    def _asked(self, tag, context):
        """Return (namespace, arguments) of an include; the arguments are ((name, text), ...)."""
        namespace, passed = self.opt_attrs(tag, context, ('ns', 'pass_all_args'))
        found = dict(context.resolve_dict.get('arg', {})) if (passed or '').lower() in ('true', '1') else {}
        for one in tag.getElementsByTagName('arg'):
            if ifunless_test(self, one, context):
                name, value, default = self.opt_attrs(one, context, ('name', 'value', 'default'))
                found[name] = value if value is not None else default
        return ns_join(context.ns, namespace) if namespace else context.ns, tuple(
            (name, text) for name, text in found.items() if isinstance(text, str))

    def _machine_tag(self, tag, context, ros_config, verbose=True):
        return None  # all nodes run on this computer

    def _node_tag(self, tag, context, ros_config, default_machine, is_test=False, verbose=True):
        self._note(tag, context)
        place = self._place
        node = super()._node_tag(tag, context, ros_config, default_machine, is_test=is_test, verbose=verbose)
        if node is not None and self._first is not None:
            self._packages.has(node.package)
            node.filename, node.machine_name = self._with_chain(place), None  # roslaunch only prints the filename
        return node

    def _note(self, tag, context):
        self._place = '{}:{}'.format(getattr(context, 'filename', self._first), getattr(tag, 'line', '?'))

    def _with_chain(self, place):
        return place + ''.join(', included at {}'.format(os.path.basename(one)) for one in reversed(self._chain))

    def _miss(self, kind, name, namespace='/', arguments=()):
        self._missed(kind, name, self._with_chain(self._place), namespace, arguments)
        return ''

    def _missed(self, kind, name, place, namespace='/', arguments=()):
        one = Missing(kind, name, place, namespace, arguments)
        if one not in self.missing:
            self.missing.append(one)

    def _package(self, found):
        return found.group() if self._packages.has(found.group(1)) else NOT_INSTALLED + found.group(1)

    def _variable(self, found, in_eval):
        name = found.group(1)
        if name in os.environ:
            return found.group()
        value = _value_of_hooks(name, self._first)
        if value is None:
            value = ENVIRONMENT.get(name, '')
            self._miss('variable', name)
        return repr(value) if in_eval else value


class _Packages(rospkg.RosPack):
    """Takes the place of rospkg's RosPack in roslaunch. ``first``: the file that is read; ``taken``: see Tolerant."""

    def __init__(self):
        super().__init__()
        self.first = None
        self.taken = {}
        self._known, self._folders = {}, {}

    def get_path(self, name):
        """Return the folder of a package. If the package is not here, the folder does not exist."""
        if name not in self._folders:
            self._folders[name] = rospkg.RosPack().get_path(name) if self.has(name) else NOT_INSTALLED + name
        return self._folders[name]

    def has(self, name):
        """Return whether a package is here. If it lies beside the file, it is taken from there."""
        if name not in self._known:
            self._known[name] = is_package(name) or self._take(name)
        return self._known[name]

    def _take(self, name):
        """Use a package beside the file, if there is one, in this process and those that it starts."""
        folder = neighbours.find(name, self.first)
        if folder is not None:
            self.taken[name] = folder
            use(folder)
        return folder is not None


class _Builder(expatbuilder.ExpatBuilderNS):
    """Python's builder of XML documents. It gives each element the attribute ``line``."""

    def start_element_handler(self, name, attributes):
        """Handle the start of an element as Python's builder does, and note its line."""
        super().start_element_handler(name, attributes)
        self.curNode.line = self._parser.CurrentLineNumber


def is_package(name):
    """Return whether rospkg finds the package ``name``."""
    try:
        rospkg.RosPack().get_path(name)
        return True
    except rospkg.ResourceNotFound:
        return False


def folder_of(name):
    """Return the folder of a package; it does not exist if the package is not here."""
    return rospkg.RosPack().get_path(name) if is_package(name) else NOT_INSTALLED + name


def use(folder):
    """Make this process and those that it starts find the package in ``folder``, and the modules in its ``src``."""
    _append('ROS_PACKAGE_PATH', folder)
    source = os.path.join(folder, 'src')
    if os.path.isfile(os.path.join(folder, 'setup.py')) and os.path.isdir(source):
        _append('PYTHONPATH', source)


def _append(variable, folder):
    folders = [one for one in os.environ.get(variable, '').split(os.pathsep) if one]
    if folder not in folders:
        os.environ[variable] = os.pathsep.join([*folders, folder])


def _start_of(path):
    try:
        with open(path, encoding='utf-8', errors='replace') as stream:
            return stream.read(bounded_yaml.FILE.size + 1)
    except OSError:
        return ''  # roslaunch reports the error


def _check_size(text):
    """Refuse YAML that stands for too many values. roslaunch sets no limit to aliases of aliases."""
    try:
        root = yaml.compose(text, Loader=yaml.SafeLoader) if '*' in text else None
    except (yaml.YAMLError, RecursionError):
        return  # roslaunch reports the error
    if len(text) > bounded_yaml.FILE.size or root is not None and _values(root, {}) > bounded_yaml.FILE.values:
        raise XmlParseException('parameters of more than {} characters, or with aliases {} values'.format(
            bounded_yaml.FILE.size, bounded_yaml.FILE.values))


def _values(node, known):
    """Return the number of values for which a YAML node stands. A node that contains itself has more than the limit."""
    if id(node) not in known:
        known[id(node)] = 2 * bounded_yaml.FILE.values  # during the count: only a node that contains itself sees this
        parts = node.value if isinstance(node, yaml.CollectionNode) else ()
        parts = [one for pair in parts for one in pair] if isinstance(node, yaml.MappingNode) else parts
        known[id(node)] = 1 + sum(_values(one, known) for one in parts)
    return known[id(node)]


def _is_refused(value):
    """Return whether a parameter server refuses a value or a part of it: None, or an integer beyond 32 bits."""
    if isinstance(value, (dict, list)):
        return any(map(_is_refused, value.values() if isinstance(value, dict) else value))
    return value is None or isinstance(value, int) and abs(value) > _LARGEST


def _is_there(command):
    words = shlex.split(command)
    return bool(words) and shutil.which(words[0]) is not None


def _value_of_hooks(name, path):
    """Return what the package of the launch file ``path`` would set ``name`` to if it were sourced, or None."""
    folder = neighbours.own_package(path)
    for hook in sorted(glob.glob(os.path.join(glob.escape(folder), 'env-hooks', '*.sh*'))) if folder else ():
        with open(hook, encoding='utf-8', errors='replace') as stream:
            text = stream.read(_LARGEST_HOOK)
        found = re.search(r'\$\{%s:=([^}\n]*)\}|^\s*export\s+%s=(\S+)' % (name, name), text, re.MULTILINE)
        if found:
            value = _FIND_IN_HOOK.sub(lambda one: folder if one.group(1) is None else neighbours.find(
                one.group(1), path) or one.group(), found.group(1) or found.group(2)).strip('\'"')
            return None if '$' in value or '@' in value or '`' in value else value
    return None
