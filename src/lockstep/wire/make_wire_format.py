"""Make the C++ header of the wire format from its table (src/move_base_abstract/lockstep/wire_format.py).

usage: make_wire_format.py TABLE HEADER

The header is not touched if it is up to date.
"""
import os
import runpy
import sys

_NUMBERS = {'u32': 'std::uint32_t', 'u64': 'std::uint64_t', 'i32': 'std::int32_t'}
_TYPES = {**_NUMBERS, 'instant': 'Nanoseconds', 'flag': 'bool', 'text': 'std::string_view', 'bytes': 'std::string_view',
          'texts': 'std::vector<std::string_view>'}
_ITEMS = {'ReportItem': 'REPORT_ITEMS', 'GrantItem': 'GRANT_ITEMS'}
_FRAMES = {'ParticipantFrame': 'PARTICIPANT_FRAMES', 'MasterFrame': 'MASTER_FRAMES'}
#: the wrappers of fields whose C++ type does not say enough to a visitor
_MARKS = {'text': 'Text', 'texts': 'Texts', 'instant': 'Instant'}

_HEAD = """\
// Generated from src/move_base_abstract/lockstep/wire_format.py by src/lockstep/wire/make_wire_format.py; do not edit.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_WIRE_FORMAT_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_WIRE_FORMAT_H

#include <cstdint>
#include <string_view>
#include <variant>
#include <vector>

#include "clock/scaled_clock.h"

namespace move_base_abstract::wire {

"""

_MARKED = """\
// Wrappers that tell a visitor of fields what the C++ type of a field does not say.
struct Text {
  std::string_view& value;
};
struct Texts {
  std::vector<std::string_view>& values;
};
struct Instant {
  Nanoseconds& value;
};
/** @brief The first and the last number of a choice. */
template <typename Choice>
struct Range;

/** @brief A frame's or item's number on the wire. */
template <typename Structure>
constexpr int kTypeOf = 0;

"""

_TAIL = """\
}  // namespace move_base_abstract::wire

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_WIRE_FORMAT_H
"""


def header(table):
    """Return the text of the header.

    :raises ValueError: if the table contradicts itself.
    """
    frames = [layout for name in _FRAMES.values() for layout in table[name]]
    items = [layout for name in _ITEMS.values() for layout in table[name]]
    names = [layout.name for layout in frames + items]
    if len(set(names)) < len(names):
        raise ValueError('a name of a frame or an item is there twice: {}'.format(', '.join(names)))
    text = _HEAD + _constants(table) + _MARKED
    text += ''.join(_choice(name, values) for name, values in table['CHOICES'].items())
    for variant, name in _ITEMS.items():
        text += ''.join(map(_structure, table[name])) + _variant(variant, table[name])
    for variant, name in _FRAMES.items():
        text += ''.join(map(_structure, table[name])) + _variant(variant, table[name])
    return text + ''.join(map(_visit, frames + items)) + _TAIL


def _constants(table):
    if table['NEVER'] != 2 ** 63 - 1:
        raise ValueError('NEVER must be the largest i64, got {}'.format(table['NEVER']))
    return ''.join('constexpr std::uint32_t k{} = {}U;\n'.format(_camel(name), table[name])
                   for name in ('PROTOCOL', 'ODOMETRY', 'LARGEST_FRAME', 'LARGEST_HELLO', 'CONNECT_RETRY_MS',
                                'CONNECT_REMINDER_MS')) + '\n'


def _choice(name, values):
    _check_row(name, [number for number, _ in values], values[0][0])
    lines = ''.join('  k{} = {},\n'.format(_camel(value), number) for number, value in values)
    return ('enum class {0} : std::uint8_t {{\n{1}}};\ntemplate <>\nstruct Range<{0}> {{\n'
            '  static constexpr int kLow = {2};\n  static constexpr int kHigh = {3};\n}};\n\n'
            ).format(name, lines, values[0][0], values[-1][0])


def _structure(layout):
    lines = ''.join('  {};\n'.format(_declaration(field)) for field in layout.fields)
    return ('struct {0} {{{1}}};\ntemplate <>\ninline constexpr int kTypeOf<{0}> = {2};\n\n'
            .format(_camel(layout.name), '\n' + lines if lines else '', layout.number))


def _declaration(field):
    kind, name, default = _parts(field)
    if kind in _ITEMS:
        return 'std::vector<{}> {}'.format(kind, name)
    if kind in ('text', 'bytes', 'texts'):
        return '{} {}'.format(_TYPES[kind], name)
    value = 'k' + _camel(default) if default else 'false' if kind == 'flag' else '0' if kind in _TYPES else (
        'static_cast<{0}>(Range<{0}>::kLow)'.format(kind))
    return '{} {} = {}'.format(_TYPES.get(kind, kind), name, value)


def _variant(variant, layouts):
    """Return the C++ type that is one of the layouts, the number of the first layout, and the names of all."""
    _check_row(variant, [layout.number for layout in layouts], layouts[0].number)
    return ('using {0} = std::variant<{1}>;\nconstexpr int kFirst{0} = {2};\n'
            'constexpr const char* k{0}Names[] = {{{3}}};\n\n'
            .format(variant, ', '.join(_camel(layout.name) for layout in layouts), layouts[0].number,
                    ', '.join('"{}"'.format(layout.name) for layout in layouts)))


def _visit(layout):
    """Return the C++ function that visits the fields of a structure, for writing and reading; items are left out."""
    lines = ''
    for field in layout.fields:
        kind, name, _ = _parts(field)
        if kind not in _ITEMS:
            value = 'one.' + name
            marked = '{}{{{}}}'.format(_MARKS[kind], value) if kind in _MARKS else value
            lines += '  visit("{}", {});\n'.format(name, marked)
    arguments = '{0}& one, Visit&& visit' if lines else '{0}&, Visit&&'
    return ('template <typename Visit>\nvoid fields({}) {{{}}}\n\n'
            .format(arguments.format(_camel(layout.name)), '\n' + lines if lines else ''))


def _parts(field):
    """Return (type, name, default or '')."""
    declaration, _, default = field.partition(' = ')
    kind, name = declaration.split()
    return kind, name, default


def _check_row(name, numbers, first):
    if numbers != list(range(first, first + len(numbers))):
        raise ValueError('the numbers of {} must follow on each other, got {}'.format(name, numbers))


def _camel(name):
    return ''.join(part.capitalize() for part in name.split('_'))


def main():
    """Write the header, unless it is up to date."""
    table, path = sys.argv[1:]
    text = header(runpy.run_path(table))
    if os.path.exists(path):
        with open(path, encoding='utf-8') as stream:
            if stream.read() == text:
                return
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path + '.part', 'w', encoding='utf-8') as stream:
        stream.write(text)
    os.replace(path + '.part', path)


if __name__ == '__main__':
    main()
