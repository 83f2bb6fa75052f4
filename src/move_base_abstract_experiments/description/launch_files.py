"""The launch files of trials. The programs of their nodes are found once per warm process."""
from __future__ import annotations

import json
import os
import re
import xml.etree.ElementTree
from typing import TYPE_CHECKING, Any, List, Match, Sequence, Tuple

from move_base_abstract.common.errors import ConfigurationError

if TYPE_CHECKING:
    from .trial import Trial

NAME = 'programs.json'
_FIND = re.compile(r'\$\(find ([A-Za-z][\w-]*)\)')
_MOST_INCLUDED = 1000


def read(files: List[Tuple[str, Sequence[str]]], is_tolerant: bool = False) -> Any:
    """Return roslaunch's configuration of files, as plan.read() does. :raises ConfigurationError: if it cannot."""
    from roslaunch.core import RLException
    from rospkg import ResourceNotFound

    from move_base_abstract_ros.launching import plan
    try:
        return plan.read(files, is_tolerant)
    except ResourceNotFound as error:
        raise ConfigurationError(f'the package {error.args[0]} is not found here; is its workspace sourced?') from None
    except RLException as error:
        raise ConfigurationError(str(error)) from None


def with_options(trial: Trial) -> Tuple[Any, Any]:
    """Return roslaunch's configuration of a trial's launch file, with what its options add, and the options of its run.

    :raises ConfigurationError: if it cannot be run like this.
    """
    from move_base_abstract_ros.launching import given
    from move_base_abstract_ros.launching.plan import launch_options
    experiment, arguments = trial.experiment, trial.arguments
    path = find(trial.launch, experiment.folder)
    try:
        config = read([(path, arguments)], experiment.adopt or experiment.tolerant)
        options = launch_options(trial.run_options)
        options = adopted(config, options) if experiment.adopt else options
        given.add_to(config, options)
    except ConfigurationError as error:
        raise ConfigurationError(f"launch, with {' '.join(arguments) or 'no arguments'}: {error}") from None
    return config, options


def check_programs(config: Any, options: Any) -> None:
    """Take away the nodes of with_options() that are not started.

    :raises ConfigurationError: if programs are missing.
    """
    from move_base_abstract_ros.launching import started
    _names, lines = started.take_away(config, options)
    started.refuse_missing(config, options, lines)


def arguments_of(path: str) -> List[str]:
    """Return the names of the arguments in a launch file's text.

    :raises ConfigurationError: if the file cannot be read.
    """
    try:
        return [tag.get('name', '') for tag in xml.etree.ElementTree.parse(path).iter('arg')]
    except (OSError, xml.etree.ElementTree.ParseError) as error:
        raise ConfigurationError(f'launch: {path}: {error}') from None


def adopted(config: Any, options: Any) -> Any:
    """Return options as adoption.adopted does, with our own robots."""
    from move_base_abstract.config.settings import read_settings
    from move_base_abstract_ros.launching import adoption
    return adoption.adopted(config, options, read_settings)


def find(text: str, folder: str) -> str:
    """Return the path of a launch file. $(find PACKAGE) stands for a package; a relative path starts at the folder.

    :raises ConfigurationError: if there is no such package or file.
    """
    import rospkg

    def replaced(found: Match[str]) -> str:
        try:
            return str(rospkg.RosPack().get_path(found.group(1)))
        except rospkg.ResourceNotFound:
            raise ConfigurationError(f"launch: the package '{found.group(1)}' is not found here; is its workspace "
                                     'sourced?') from None
    path = os.path.join(folder, _FIND.sub(replaced, text))
    if not os.path.isfile(path):
        raise ConfigurationError(f'launch: there is no file {path}')
    return path


def with_includes(path: str) -> List[str]:
    """Return the paths of a launch file and of all files that it includes or loads, in the order of their discovery.

    Names that depend on arguments are left out.
    """
    found: List[str] = []
    waiting = [os.path.abspath(path)]
    while waiting and len(found) < _MOST_INCLUDED:
        here = waiting.pop(0)
        if here in found:
            continue
        found.append(here)
        try:
            nodes = list(xml.etree.ElementTree.parse(here).iter())
        except (OSError, xml.etree.ElementTree.ParseError):
            continue  # it is no launch file, or the check reports the error
        names = [node.get('file', '') for node in nodes if node.tag in ('include', 'rosparam')]
        for name in filter(None, names):
            try:
                waiting.append(find(name.replace('$(dirname)', os.path.dirname(here)), os.path.dirname(here)))
            except ConfigurationError:
                continue
    return found


def save_programs(folder: str) -> None:
    """Write the paths of programs that were found into a trial's folder, for the warm process."""
    from move_base_abstract_ros.launching.look_ups import programs
    with open(os.path.join(folder, NAME), 'w', encoding='utf-8') as stream:
        json.dump([[*key, path] for key, path in programs.items()], stream)


def load_programs(folder: str) -> None:
    """Take over the paths of programs that a trial has found."""
    try:
        with open(os.path.join(folder, NAME), encoding='utf-8') as stream:
            from move_base_abstract_ros.launching.look_ups import programs
            programs.update({(package, kind): path for package, kind, path in json.load(stream)})
    except (OSError, ValueError):
        pass  # the trial ended before it wrote them
