"""What is replaced in rospy and Python's library: sources replace nothing past the table, and the page shows it."""
import ast
import os
import re

from move_base_abstract_ros.replacing import replaced

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..')
SOURCES = os.path.join(ROOT, 'src')
FOREIGN = re.compile(r'(rospy|actionlib|rosgraph|roslib|threading|time|queue|uuid|logging|sys|os|socket|random)(\.|$)')
#: what a program is started with is set, not replaced, and so is the hook of a trial's own process; the rospy ones are
#: what it reads of that when it is imported
VALUES = ('sys.argv', 'sys.stdout', 'sys.__stdout__', 'sys.stderr', 'sys.__stderr__',
          'threading.excepthook', 'rospy.names._mappings', 'rospy.names._caller_namespace', 'rospy.names._caller_id')


def python_files():
    for folder, _, names in sorted(os.walk(SOURCES)):
        yield from (os.path.join(folder, name) for name in sorted(names) if name.endswith('.py'))


def imports_of(tree):
    """Return {name in the file: dotted name} of what it imports."""
    found = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found.update((one.asname or one.name.split('.')[0], one.name if one.asname else one.name.split('.')[0])
                         for one in node.names)
        elif isinstance(node, ast.ImportFrom) and not node.level:
            found.update((one.asname or one.name, '{}.{}'.format(node.module, one.name)) for one in node.names)
    return found


def dotted(node, imports):
    """Return the dotted name that an expression stands for, '' if it is something else."""
    if isinstance(node, ast.Name):
        return imports.get(node.id, '')
    if isinstance(node, ast.Attribute):
        owner = dotted(node.value, imports)
        return owner and '{}.{}'.format(owner, node.attr)
    return ''


def set_in(tree):
    """Yield the dotted names that are assigned to."""
    imports = imports_of(tree)
    for node in ast.walk(tree):
        targets = getattr(node, 'targets', [node.target] if isinstance(node, ast.AugAssign) else [])
        for target in targets:
            yield from (dotted(one, imports) for one in getattr(target, 'elts', [target])
                        if isinstance(one, ast.Attribute))
        if isinstance(node, ast.Call) and dotted(node.func, {'setattr': 'setattr'}) == 'setattr':
            yield dotted(node.args[0], imports) + '.'


def test_nothing_is_replaced_past_the_table():
    found = []
    for path in python_files():
        with open(path, encoding='utf-8') as stream:
            names = set_in(ast.parse(stream.read()))
        found += [(os.path.relpath(path, SOURCES), name) for name in names
                  if FOREIGN.match(name) and name not in VALUES and not name.startswith('rospy.rostime._rostime')]
    assert found == []


def test_the_page_shows_the_table():
    with open(os.path.join(ROOT, 'docs', 'replaced_names.md'), encoding='utf-8') as stream:
        page = stream.read()
    python = 'Python {}.{} to {}.{}'.format(*replaced.PYTHON[0], *replaced.PYTHON[1])
    shown = [line for line in page.splitlines() if line.startswith('| `')]
    places = re.findall(r'^## In (.*)$|^\| `(.*?)` ', page, re.MULTILINE)
    where, at = {}, None
    for heading, name in places:
        at = heading or at
        where[name] = at
    assert {name: at for name, at in where.items() if name} == {row.name: row.where for row in replaced.ROWS.values()}
    assert sorted(shown) == sorted('| `{}` | {} | {} |'.format(row.name, row.why, ', '.join(row.digests) or python)
                                   for row in replaced.ROWS.values())
    assert replaced.SOURCES in page
