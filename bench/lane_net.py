"""The net of lanes on which robots of the benchmarks drive."""
import json
import os

ROWS, COLUMNS = 25, 40


def write(folder, gap, **lane):
    """Write a net of ROWS x COLUMNS nodes, ``gap`` [m] apart; return its path and the places of its nodes [(x, y), m].

    ``lane``: what each lane has besides its ends, such as a capacity.
    """
    nodes = {(row, column): {'name': f'{row} {column}', 'x': column * gap, 'y': row * gap}
             for row in range(ROWS) for column in range(COLUMNS)}
    edges = [{'from': node['name'], 'to': nodes[to]['name'], **lane}
             for (row, column), node in nodes.items() for to in ((row, column + 1), (row + 1, column)) if to in nodes]
    path = os.path.join(folder, 'net.yaml')
    with open(path, 'w', encoding='utf-8') as stream:
        json.dump({'nodes': list(nodes.values()), 'edges': edges}, stream)
    return path, [(node['x'], node['y']) for node in nodes.values()]
