"""How many orders robots can do at most on a net of lanes, whatever policy leads them.

Each lane holds so many robots as its capacity says, so robots can spend so many seconds on it in each second. The most
orders in a second are the solution of a linear program: the largest concurrent multicommodity flow (F. Shahrokhi,
D. Matula, J. ACM 37, 1990) from each place to each other one of an order. No robot waits in it, brakes, or turns, and
flows may be split, so no robots do more.
"""
import math

import numpy
import yaml
from scipy import sparse
from scipy.optimize import linprog


def most_orders(net, pairs, robots, speed, seconds):
    """Return the most orders in ``seconds`` [s].

    ``net``: the path of the net; ``pairs``: {(x, y), [m]: {(x, y): share of the orders for which a robot drives from
    the first place to the second one}}; ``speed``: of robots [m/s].
    """
    with open(net, encoding='utf-8') as stream:
        described = yaml.safe_load(stream)
    places = {node['name']: (node['x'], node['y']) for node in described['nodes']}
    names, edges, wanted = list(places), described['edges'], _between_nodes(places, pairs)
    arcs = [(edge['from'], edge['to'], number) for number, edge in enumerate(edges)]
    arcs += [(to, from_, number) for from_, to, number in arcs if not edges[number].get('one_way')]
    lasts = [math.dist(places[edge['from']], places[edge['to']]) / speed for edge in edges]
    room = [edge.get('capacity', math.inf) for edge in edges]
    # One flow for each place where robots go to, and last the number of orders in a second.
    count = len(wanted) * len(arcs) + 1
    balance, limits = sparse.lil_matrix((len(wanted) * len(names), count)), sparse.lil_matrix((len(edges) + 1, count))
    for flow, (end, from_) in enumerate(wanted.items()):
        for number, (begin, to, edge) in enumerate(arcs):
            variable = flow * len(arcs) + number
            if begin != end:
                balance[flow * len(names) + names.index(begin), variable] += 1.0
            if to != end:
                balance[flow * len(names) + names.index(to), variable] -= 1.0
            limits[edge, variable] = limits[len(edges), variable] = lasts[edge]
        for begin, share in from_.items():
            if begin != end:
                balance[flow * len(names) + names.index(begin), count - 1] = -share
    aim = numpy.zeros(count)
    aim[-1] = -1.0
    most = numpy.array([*room, robots], dtype=float)
    bounded = numpy.isfinite(most)
    found = linprog(aim, limits.tocsr()[bounded], most[bounded], balance.tocsr(), numpy.zeros(balance.shape[0]),
                    method='highs')
    assert found.status == 0, found.message
    return -found.fun * seconds


def _between_nodes(places, pairs):
    """Return {node where robots go to: {node from which they come: share}}; ``places``: of the nodes {name: (x, y)}."""
    def node_at(place):
        return min(places, key=lambda name: math.dist(places[name], place))

    wanted = {}
    for begin, ends in pairs.items():
        for end, share in ends.items():
            from_ = wanted.setdefault(node_at(end), {})
            from_[node_at(begin)] = from_.get(node_at(begin), 0.0) + share
    return wanted
