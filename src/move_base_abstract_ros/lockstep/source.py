"""Finds in a program's source what cannot be noticed while it runs: clocks and generators that are made in C."""
import ast

_CLOCK = 'reads the wall clock; what it does with that differs from run to run'
_SEED = 'is seeded by the machine, so it differs from run to run; give it a seed'
_ENTROPY = 'comes from the machine, so it differs from run to run'
_ADDRESS = 'orders by addresses, which differ from run to run'
_LOOP = 'waits by the wall clock, while simulated time stands still'
#: the last parts of a call's name, as it is written
_CALLS = {
    ('datetime', 'now'): _CLOCK, ('datetime', 'utcnow'): _CLOCK, ('datetime', 'today'): _CLOCK,
    ('date', 'today'): _CLOCK,
    ('os', 'urandom'): _ENTROPY, ('random', 'SystemRandom'): _ENTROPY,
    ('asyncio', 'run'): _LOOP, ('asyncio', 'sleep'): _LOOP, ('select', 'select'): _LOOP,
}
#: those that take a seed
_SEEDED = {('random', 'Random'), ('random', 'default_rng'), ('random', 'RandomState')}


def check(filenames):
    """Return [(what: why, file, line)] of what the files call that lockstep cannot follow."""
    found = []
    for filename in filenames:
        try:
            with open(filename, 'rb') as stream:
                tree = ast.parse(stream.read())
        except (OSError, SyntaxError, ValueError):
            continue  # not for us to judge
        found += [('{}: {}'.format('.'.join(name), why), filename, line) for line, name, why in sorted(_calls(tree))]
    return found


def _calls(tree):
    """Yield (line, name, why)."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Call):
            name = _dotted(node.func)[-2:]
            if name in _CALLS:
                yield node.lineno, name, _CALLS[name]
            elif name in _SEEDED and not node.args and not node.keywords:
                yield node.lineno, name, _SEED
            if any(keyword.arg == 'key' and _dotted(keyword.value) == ('id',) for keyword in node.keywords):
                yield node.lineno, ('key=id',), _ADDRESS


def _dotted(node):
    """Return the parts of a dotted name, or () if it is something else."""
    if isinstance(node, ast.Name):
        return (node.id,)
    if isinstance(node, ast.Attribute):
        before = _dotted(node.value)
        return before + (node.attr,) if before else ()
    return ()
