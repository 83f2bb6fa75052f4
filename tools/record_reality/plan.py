#!/usr/bin/env python3
"""Print the plan of the recordings in examples/reality for record.py, one mission per line.

usage: python3 tools/record_reality/plan.py [MISSIONS]
"""
import itertools
import sys

_MOST = 96
_SECONDS = 300  # simulated
_KINDS = {'aisles': (('headon', 2), ('stander', 2), ('turns', 3), ('crossing', 3), ('random', 3), ('headon', 3),
                     ('gather', 3), ('random', 4), ('crossing', 2), ('turns', 4), ('stander', 3), ('headon', 4)),
          'rooms': (('headon', 2), ('random', 3), ('stander', 2), ('turns', 3), ('headon', 3), ('random', 4),
                    ('gather', 3), ('stander', 3), ('turns', 4), ('headon', 4)),
          'farm_yard': (('crossing', 3), ('turns', 3), ('headon', 2), ('random', 3), ('crossing', 4), ('stander', 3))}
_MAPS = {'aisles': ('aisles_1', 'aisles_2', 'aisles_3', 'aisles_4', 'aisles_5'),
         'rooms': ('rooms_1', 'rooms_2', 'rooms_3'), 'farm_yard': ('farm_yard',)}
_ORDER = ('aisles', 'rooms', 'aisles', 'rooms', 'farm_yard')


def missions():
    """Yield (run, map, kind, robots, seed, simulated_s) without end; kinds and maps take turns."""
    kinds = {kind: itertools.cycle(pairs) for kind, pairs in _KINDS.items()}
    maps = {kind: itertools.cycle(names) for kind, names in _MAPS.items()}
    for number, area in enumerate(itertools.cycle(_ORDER), 1):
        kind, robots = next(kinds[area])
        yield 'm{:03}'.format(number), next(maps[area]), kind, robots, 1000 + number, _SECONDS


def main():
    """Print the plan."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else _MOST
    print('run,map,kind,robots,seed,simulated_s')
    for row in itertools.islice(missions(), count):
        print(*row, sep=',')


if __name__ == '__main__':
    main()
