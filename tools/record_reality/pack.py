#!/usr/bin/env python3
"""Pack recorded missions into the tables of examples/reality; the same missions give the same bytes.

usage: python3 tools/record_reality/pack.py FOLDER TARGET

FOLDER: the output of record.py. A mission that missed more than 2 % of its control cycles is named and left out.
"""
import csv
import gzip
import io
import os
import sys
from pathlib import Path

from legs import COLUMNS
from places import place

_MOST_MISSED = 0.02
_DURATION = COLUMNS.index('duration_s')  # 0: the goal was sent in the last step


def _rows(path):
    with open(str(path), newline='') as stream:
        return list(csv.reader(stream))


def _write(path, rows):
    text = io.StringIO()
    csv.writer(text, lineterminator='\n').writerows(rows)
    data = text.getvalue().encode()
    part = path.with_name(path.name + '.part')
    part.write_bytes(gzip.compress(data, 9, mtime=0) if path.suffix == '.gz' else data)
    os.replace(str(part), str(path))


def main():
    """Pack the missions of the command line."""
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    source, target = map(Path, sys.argv[1:])
    tables, maps = {'mission': [], 'legs': [], 'poses': []}, set()
    for folder in sorted(path.parent for path in source.glob('*/mission.csv')):
        head, values = _rows(folder / 'mission.csv')
        named = dict(zip(head, values))
        if int(named['missed_loops']) > _MOST_MISSED * int(named['cycles']):
            print('{run}: left out, {missed_loops} of {cycles} cycles missed'.format(**named))
            continue
        maps.add(named['map'])
        for name, table in tables.items():
            rows = _rows(folder / (name + '.csv'))[1 if table else 0:]
            table.extend(row for row in rows if name != 'legs' or row[_DURATION] != '0.0')
    for name, table in tables.items():
        _write(target / ('missions.csv' if name == 'mission' else name + '.csv.gz'), table)
    for name in sorted(maps - {'farm_yard'}):  # that map is in maps/
        place(name).write(target)
    print('{} missions, {} legs, {} poses'.format(*(len(table) - 1 for table in tables.values())))


if __name__ == '__main__':
    main()
