"""The paths of the published Mesa study: a greedy best-first search on a grid with eight neighbours.

The search uses only a cell's estimated distance from the goal and the cell's own weight, never its distance from the
start. The search library of the published program does this under the name A*. Its order of ties is kept, because it
decides the lengths of detours around other robots, and so which robot wins a task.
"""

NEIGHBOURS = ((-1, -1), (-1, 0), (-1, 1), (0, -1), (0, 1), (1, -1), (1, 0), (1, 1))  # (x, y), in the order of search


def greedy_path(weights, start, goal):
    """Return the cells (x, y) from start to goal, both included.

    :param weights: array of shape (width, height), the weight of each cell. The estimate of a cell is its weight plus
        its Manhattan distance from the goal. The search goes on from the open cell with the least estimate: from the
        youngest one if no older one has a smaller estimate, otherwise from the oldest of those with the least estimate.
        If the youngest one is passed over, it is forgotten.
    """
    width, height = weights.shape
    goal = tuple(goal)
    estimates, parents, closed = {}, {}, set()
    open_cells, cell = [], tuple(start)
    here_estimate = 0
    while cell != goal:
        for dx, dy in NEIGHBOURS:
            x, y = near = cell[0] + dx, cell[1] + dy
            if not (0 <= x < width and 0 <= y < height) or near in closed:
                continue
            if near not in estimates:
                estimates[near] = int(weights[x, y]) + abs(x - goal[0]) + abs(y - goal[1])
                parents[near] = cell
                open_cells.append(near)
            elif estimates[near] < here_estimate:
                parents[near] = cell
        cell = _choose(open_cells, estimates)
        here_estimate = estimates.pop(cell)
        closed.add(cell)
    return _trace(parents, cell, tuple(start))


def _choose(open_cells, estimates):
    """Remove and return the open cell to go on from."""
    youngest = open_cells.pop()
    if not open_cells:
        return youngest
    index = min(range(len(open_cells)), key=lambda i: estimates[open_cells[i]])
    if estimates[open_cells[index]] >= estimates[youngest]:
        return youngest
    estimates.pop(youngest)
    return open_cells.pop(index)


def _trace(parents, cell, start):
    path = [cell]
    while cell != start:
        cell = parents[cell]
        path.append(cell)
    return path[::-1]
