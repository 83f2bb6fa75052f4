"""Fit how long a real robot's legs take from recordings, check the fit, and write it for the simulator.

    rosrun move_base_abstract calibrate RECORDING... [-o robot.yaml] [--map MAP.yaml --radius M]
    rosrun move_base_abstract calibrate RECORDING... --predict robot.yaml [--map MAP.yaml --radius M]
    rosrun move_base_abstract calibrate FOLDER... --encounters robot.yaml [-o robot_with_encounters.yaml]
    rosrun move_base_abstract calibrate FOLDER... --stuck robot.yaml [-o robot_that_gets_stuck.yaml]

Exit codes: 0 written; 2 a file cannot be read or written, there are too few legs, a library is missing, or the
arguments are wrong.
"""
from __future__ import annotations

import argparse
import os
import sys
from typing import TYPE_CHECKING, Iterable, List, Optional, Sequence, Tuple

from move_base_abstract.common.bounded_yaml import load_yaml_file
from move_base_abstract.common.errors import ConfigurationError, telling
from move_base_abstract.common.kinds import number
from move_base_abstract.common.options import POSITIVE, word_of
from move_base_abstract.common.shown import shown
from move_base_abstract.motion.calibration import calibration_file, read_calibration

if TYPE_CHECKING:
    from move_base_abstract.maps.occupancy import OccupancyMap

    from .check import Score
    from .legs import Pair, RecordedLeg

_YAML = 'calibration.yaml'
_COUNT = word_of(number(0, 100_000, whole=True))
_KEPT = '90 %, as the calibration said to which encounters were fitted'


def main(words: Optional[Sequence[str]] = None) -> None:
    """Run the command with these arguments (default: those of the shell); exit with code 2 on an error."""
    options = _parse(words)
    try:
        with telling('calibrate'):
            _run(options)
    except ModuleNotFoundError as error:
        print('calibrate: {} is not installed for {}; install what it needs: make deps-experiment, or on Debian: '
              'apt install python3-jinja2 python3-matplotlib python3-scipy'.format(error.name, sys.executable),
              file=sys.stderr)
        sys.exit(2)


def _parse(words: Optional[Sequence[str]]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog='calibrate', description='Fit how long the legs of a real robot take, from recordings of it. Write a YAML '
        'file that scenarios can name, and a page that shows how well it predicts.',
        epilog='exit codes: 0 written, 2 a file cannot be read or written, too few legs, no scipy or matplotlib, '
        'or wrong arguments')
    parser.add_argument('recordings', metavar='RECORDING', nargs='+',
                        help='a bag with goals, results and poses of move_base, or a CSV file with one row per leg')
    parser.add_argument('-o', '--output', metavar='FILE.yaml', default=_YAML,
                        help='the calibration (default: %(default)s); the page is FILE.html beside it. Only files '
                        'of this program are replaced')
    what = parser.add_mutually_exclusive_group()
    what.add_argument('--predict', metavar='CALIBRATION', help='fit and write nothing; print how well this file (or '
                      'a calibration that ships, by name) predicts the recordings')
    what.add_argument('--encounters', metavar='CALIBRATION', help='fit the law of encounters to folders of '
                      'recordings of several robots, and add it to the values of this file (or of a calibration '
                      'that ships)')
    what.add_argument('--stuck', metavar='CALIBRATION', help='fit how robots get stuck to such folders, and add it '
                      'to the values of this file')
    parser.add_argument('--touch', type=POSITIVE, metavar='M', default=0.52, help='with --stuck: robots touch if their '
                        'centres are no further apart (default: %(default)g m)')
    parser.add_argument('--map', metavar='MAP.yaml', help='use lengths and turns of the ways that the simulator plans '
                        'on this map, not the recorded ones')
    parser.add_argument('--radius', type=POSITIVE, metavar='M', default=0.46,
                        help='with --map, --encounters or --stuck: distance of ways from occupied cells (default: '
                        '%(default)g m)')
    parser.add_argument('--clear-of-robots', type=POSITIVE, metavar='M', help='leave out legs that came nearer than '
                        'this to another robot, if the recording says so')
    parser.add_argument('--pose-topic', metavar='NAME', help="for bags: the topic of the poses in a robot's "
                        'namespace (default: base_pose_ground_truth, then amcl_pose, then odom)')
    parser.add_argument('--nominal-speed', type=POSITIVE, metavar='M/S', help='speed of the straight-line prediction '
                        'that is shown for comparison (default: the fitted top speed)')
    parser.add_argument('--bootstrap', type=_COUNT, metavar='N', default=100, help='number of bootstrap samples for '
                        'the '
                        'intervals of the parameters (default: %(default)d)')
    parser.add_argument('--source', metavar='TEXT', help='one line that says where the recordings come from')
    options = parser.parse_args(words)
    if not options.output.endswith('.yaml'):
        parser.error('-o: got {}; allowed: a name that ends with .yaml'.format(shown(options.output)))
    return options


def _run(options: argparse.Namespace) -> None:
    if options.encounters or options.stuck:
        _add_section(options)
    elif options.predict:
        _predict(options)
    else:
        _calibrate(options)


def _predict(options: argparse.Namespace) -> None:
    from . import check  # this takes a while to import
    from .fit import succeeded
    name = os.path.abspath(options.predict) if options.predict.endswith('.yaml') else options.predict
    read_calibration(name, 'calibrate')
    values = load_yaml_file(calibration_file(name, 'calibrate'))
    pairs, _ = _pairs(options)
    if not succeeded(pairs):
        raise ConfigurationError('no leg succeeded and counts; at least one must')
    nominal_speed = options.nominal_speed or values['max_speed']
    _say([check.score(options.predict, check.predict(values, pairs, nominal_speed),
                      check.success_rates(values, pairs))])


def _add_section(options: argparse.Namespace) -> None:
    from . import encounter_report, outputs, stuck_fit  # these take a while to import
    outputs.check(options.output)
    name = options.encounters or options.stuck
    name = os.path.abspath(name) if name.endswith('.yaml') else name
    found: Iterable[str]
    if options.encounters:
        values, fitted, scores, _ = encounter_report.calibrate_encounters(options.recordings, name, options.radius)
        found = encounter_report.lines(fitted, scores)
    else:
        values, how, cases, reach = stuck_fit.calibrate_stuck(options.recordings, name, options.radius, options.touch)
        found = stuck_fit.lines(how, cases, reach)
    source, recorded, kept, motion = (values.pop(name, None) for name in (
        'source', 'recorded', 'intervals', 'tail_motion'))
    outputs.write(options.output, outputs.yaml_text(values, source, recorded, kept, _KEPT, motion))
    for line in found:
        print(line)
    print(options.output)


def _pairs(options: argparse.Namespace) -> Tuple[List[Pair], List[str]]:
    """Return the legs with their ways, and notes; the notes are printed, too."""
    from . import checks
    from .legs import met_no_robot, ways_of
    legs, notes = _read(options)
    legs, found = checks.examine(legs)
    notes += found
    occupancy = _map(options, notes)
    pairs = ways_of(legs, occupancy, options.radius)
    if len(pairs) < len(legs):
        notes.append('{} of {} legs have no way on the map and are left out'.format(len(legs) - len(pairs), len(legs)))
    if options.clear_of_robots:
        clear = [pair for pair in pairs if met_no_robot(pair[0], options.clear_of_robots)]
        notes.append('{} legs that came nearer than {:g} m to another robot are left out'.format(
            len(pairs) - len(clear), options.clear_of_robots))
        pairs = clear
    for note in notes:
        print('calibrate: note: {}'.format(note), file=sys.stderr)
    return pairs, notes


def _calibrate(options: argparse.Namespace) -> None:
    from . import check, outputs  # these take a while to import
    from .check import by_class
    from .fit import fit, succeeded, tail_motion
    from .intervals import intervals, recorded_range
    page = options.output[:-len('.yaml')] + '.html'
    outputs.check(options.output, page)
    pairs, notes = _pairs(options)
    values = fit(pairs)
    source = options.source or '{} legs of {}'.format(
        len(succeeded(pairs)), ', '.join(os.path.basename(path) for path in options.recordings))
    found, how = intervals(pairs, options.bootstrap)
    text = outputs.yaml_text(values, source, recorded_range(pairs), found, how, tail_motion(values, pairs))
    nominal_speed = options.nominal_speed or values['max_speed']
    rows, folds = check.scores(values, pairs, nominal_speed)
    from .pictures import draw
    used, predicted = (succeeded(pairs), check.predict(values, pairs, nominal_speed)) if folds is None else (
        folds.pairs, folds.predicted)
    picture = draw(values, pairs, predicted)
    outputs.write(options.output, text)
    outputs.write(page, outputs.page_text(text, source, rows, picture, nominal_speed, notes,
                                          by_class(used, predicted), found, how))
    _say(rows)
    print(options.output)
    print(page)


def _say(rows: Sequence[Score]) -> None:
    for row in rows:
        print('{:60s} {:5d} legs: median error {:5.2f} %, mean {:.3f}, in 90 %: {:4.1f} %; success {:.1f} %, measured '
              '{:.1f} %; straight line: {:.0f} %'.format(
                  row.name, row.legs, 100.0 * row.median_error, row.mean_ratio, 100.0 * row.within,
                  *(100.0 * rate for rate in row.success), 100.0 * row.straight_error))  # type: ignore[union-attr]


def _read(options: argparse.Namespace) -> Tuple[List[RecordedLeg], List[str]]:
    """Return all RecordedLegs, and notes."""
    legs, notes = [], []
    for path in options.recordings:
        if path.endswith('.bag'):
            from .bags import read_legs as read_bag  # only bags need ROS
            found, about = read_bag(path, options.pose_topic)
            notes += about
        else:
            from .csv_files import read_legs as read_csv
            found = read_csv(path)
        legs += found
    return legs, notes


def _map(options: argparse.Namespace, notes: List[str]) -> Optional[OccupancyMap]:
    """Return the OccupancyMap of --map, or None."""
    if options.map is None:
        return None
    from move_base_abstract.maps.map_files import load_map, read_description
    description = read_description(options.map)
    notes += list(description.warnings)
    return load_map(description)
