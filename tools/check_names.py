#!/usr/bin/env python3
"""Tell which names of our own modules are used, in the product, its tests or benchmarks, and do not exist.

usage: check_names.py FOLDER...    (files below them are read; src/ is where our modules are)

Needs neither ROS nor any import: a name exists where its module binds it at the top level. Programs that a file holds
as texts, as tests do for the processes they start, are read as the files are.
"""
import ast
import pathlib
import re
import sys

SOURCE = pathlib.Path('src')
IMPORT = re.compile(r'^\s*from (?:move_base_abstract|soil_mapping)', re.MULTILINE)
GENERATED = ('cfg', 'msg', 'srv')  # catkin makes these modules


def bound_names(tree):
    """Return the names that a module binds at its top level, below if, try and with too, and those of its __all__."""
    names, waiting = set(), list(tree.body)
    while waiting:
        node = waiting.pop()
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            names.add(node.name)
        elif isinstance(node, (ast.Import, ast.ImportFrom)):
            names.update((alias.asname or alias.name).split('.')[0] for alias in node.names)
        elif isinstance(node, (ast.If, ast.Try, ast.With, ast.For)):
            waiting += [child for child in ast.walk(node) if isinstance(child, ast.stmt) and child is not node]
        else:
            stored = [child.id for child in ast.walk(node)
                      if isinstance(child, ast.Name) and isinstance(child.ctx, ast.Store)]
            names.update(stored)
            if stored == ['__all__'] and isinstance(node.value, ast.List):  # it may import them when they are asked for
                names.update(one.value for one in node.value.elts)
    return names | {'__name__', '__file__', '__doc__'}


def handed_on(tree):
    """Return the names of its modules that a package hands on, as move_base_abstract.common.handed_on does it."""
    return {name for node in tree.body if isinstance(node, ast.Assign) and isinstance(node.value, ast.Call)
            and getattr(node.value.func, 'id', '') == 'handed_on'
            for names in node.value.args[1].values for name in names.value.split()}


def our_modules():
    """Return the top-level names of each of our modules, and of each package the modules in it, by dotted name."""
    modules = {}
    for path in sorted(SOURCE.rglob('*.py')):
        parts = path.relative_to(SOURCE).with_suffix('').parts
        parts = parts[:-1] if parts[-1] == '__init__' else parts
        tree = ast.parse(path.read_text())
        modules.setdefault('.'.join(parts), set()).update(bound_names(tree), handed_on(tree))
        if len(parts) > 1:
            modules.setdefault('.'.join(parts[:-1]), set()).add(parts[-1])
    return modules


def is_ours(module, modules):
    """Tell whether a module is one that lies in src/, or would if it existed."""
    parts = module.split('.')
    return parts[0] in modules and parts[-1] not in GENERATED


def missing_names(tree, modules):
    """Yield (line, module, name) of every name of ``modules`` that ``tree`` imports or looks up in vain."""
    here = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.level == 0 and is_ours(node.module, modules):
            for alias in node.names:
                if alias.name not in modules.get(node.module, ()):
                    yield node.lineno, node.module, alias.name
                here[alias.asname or alias.name] = f'{node.module}.{alias.name}'
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            module = here.get(node.value.id)
            if module in modules and isinstance(node.ctx, ast.Load) and node.attr not in modules[module]:
                yield node.lineno, module, node.attr


def programs(tree):
    """Yield the first line and the tree of each text in ``tree`` that is a program with imports of ours."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and IMPORT.search(node.value):
            try:
                yield node.lineno, ast.parse(node.value)
            except SyntaxError:  # prose, or a part of a program
                continue


def main():
    """Check all files below the folders named; the exit status is 1 if a name is missing."""
    modules, bad = our_modules(), False
    for folder in sys.argv[1:]:
        for path in sorted(pathlib.Path(folder).rglob('*.py')):
            tree = ast.parse(path.read_text())
            for first, program in [(1, tree), *programs(tree)]:
                for line, module, name in missing_names(program, modules):
                    print(f'{path}:{first + line - 1}: {module} has no {name}')
                    bad = True
    return 1 if bad else 0


if __name__ == '__main__':
    sys.exit(main())
