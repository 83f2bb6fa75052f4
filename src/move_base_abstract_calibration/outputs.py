"""Write the files of a calibration: the YAML that a scenario names, and the page that shows how well it predicts."""
from __future__ import annotations

import base64
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, Iterator, Mapping, Optional, Sequence, Tuple

import jinja2

from move_base_abstract.common import own_files
from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.shown import printable
from move_base_abstract.motion.calibration import ENCOUNTERS, FORMAT, STUCK, TABLE, make_calibration
from move_base_abstract.motion.encounter_law import TABLE as OF_ENCOUNTERS
from move_base_abstract.motion.stuck_law import TABLE as OF_STUCK

if TYPE_CHECKING:
    from move_base_abstract.common.parameter_table import Parameter

    from .check import ClassErrors, Score
    from .intervals import Interval
    from .law import Values

_FIRST_YAML = '# move_base_abstract calibration'
_FIRST_PAGE = '<!doctype html><!-- move_base_abstract calibration -->'
_DIGITS = 5
MOST = 'tail_most'
_UNITS = {parameter.name: parameter.allowed.rpartition('[')[2][:-1] for parameter in (*TABLE, *OF_ENCOUNTERS, *OF_STUCK)
          if parameter.allowed.endswith(']')}


def check(*paths: str) -> None:
    """Check that files can be written at the paths: their folders exist, and no other file is there.

    :raises ConfigurationError: naming the path, if there is no folder or the file is not of this program.
    """
    for path in paths:
        if not os.path.isdir(os.path.dirname(path) or '.'):
            raise ConfigurationError('{}: there is no folder {}'.format(path, os.path.dirname(path)))
        own_files.check_file(str(path), lambda line: line.startswith((_FIRST_YAML.encode(), _FIRST_PAGE.encode())))


def yaml_text(values: Values, source: str, recorded: Optional[Mapping[str, Tuple[float, float]]] = None,
              intervals: Optional[Mapping[str, Interval]] = None, how: str = '',
              motion: Optional[Mapping[str, float]] = None) -> str:
    """Return the YAML of a calibration, with its numbers rounded to 5 digits and its content checked.

    ``values`` may have the mappings ``encounters`` of an EncounterLaw and ``stuck`` of a StuckLaw. The file has these
    sections: ``recorded`` {name: (low, high)}, ``intervals`` {name: (low, high) or HELD}, with the words ``how`` they
    were found, and ``motion``, the tail_motion (None: unknown).

    :raises ConfigurationError: if it is no valid calibration.
    """
    rounded = _rounded({'source': source, **values})
    sections = {name: _rounded(section) for name, section in (
        ('recorded', recorded), ('tail_motion', motion), ('intervals', intervals)) if section}
    make_calibration({'format': FORMAT, **rounded, **sections}, 'calibrate')
    lines = ['{}: what each value means stands in docs/calibrate.md'.format(_FIRST_YAML), 'format: {}'.format(FORMAT),
             *_rows(TABLE, rounded, '')]
    lines += ['{0}: {1}  # s per m of the way'.format(MOST, rounded[MOST])] if MOST in rounded else []
    for name, comment in (('recorded', 'of the legs that were fitted'), ('tail_motion', 'm/s and rad/s'),
                          ('intervals', how)):
        if name in sections:
            lines.append('{}:  # {}'.format(name, comment))
            lines += ['  {}: {}'.format(key, one) for key, one in sections[name].items()]
    for name, table in ((ENCOUNTERS, OF_ENCOUNTERS), (STUCK, OF_STUCK)):
        if name in rounded:
            known = [parameter for parameter in table if parameter.name in rounded[name]]
            lines += [name + ':', *_rows(known, rounded[name], '  ')]
    return '\n'.join(lines) + '\n'


def _rows(table: Sequence[Parameter], values: Values, indent: str) -> Iterator[str]:
    for parameter in table:
        value = values[parameter.name]
        unit = _UNITS.get(parameter.name)
        yield '{}{}: {}{}'.format(indent, parameter.name, _quoted(value) if isinstance(value, str) else value,
                                  '  # ' + unit if unit else '')


def write(path: str, text: str) -> None:
    """Write a text file as a whole. It replaces only a file of this program.

    :raises ConfigurationError, OutputError: if another file is there, or it cannot be written.
    """
    check(path)
    with own_files.whole_file(path, 'w', encoding='utf-8') as stream:
        stream.write(text)


def page_text(calibration: str, source: str, rows: Sequence[Score], picture: bytes, nominal_speed: float,
              notes: Sequence[str], classes: Sequence[ClassErrors] = (),
              intervals: Optional[Mapping[str, Interval]] = None, how: str = '') -> str:
    """Return the page as text. ``calibration``: the YAML; ``rows``: [check.Score]; ``picture``: the bytes of a PNG.

    ``classes``: [check.ClassErrors]; ``intervals``, ``how``: as for :func:`yaml_text`.
    """
    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(str(Path(__file__).with_name('templates'))),
                                     autoescape=True, undefined=jinja2.StrictUndefined)
    return '{}\n{}\n'.format(_FIRST_PAGE, environment.get_template('page.html.j2').render(
        calibration=calibration, source=source, rows=rows, nominal_speed=nominal_speed, notes=notes,
        classes=classes, intervals=intervals or {}, how=how, units=_UNITS,
        picture=base64.b64encode(picture).decode('ascii')))


def _quoted(text: str) -> str:
    return "'{}'".format(printable(' '.join(text.split())).replace("'", "''"))


def _rounded(value: Any) -> Any:
    """Return ``value`` with all numbers in it rounded to 5 digits; lists instead of tuples."""
    if isinstance(value, (list, tuple)):
        return [_rounded(each) for each in value]
    if isinstance(value, dict):
        return {name: _rounded(each) for name, each in value.items()}
    return value if isinstance(value, str) else float('{:.{}g}'.format(value, _DIGITS))
