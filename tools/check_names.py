#!/usr/bin/env python3
"""Find names of our own modules that are used in the product, its tests or benchmarks, but do not exist.

usage: check_names.py FOLDER...    (reads all files below the folders; our modules are in src/)

It needs neither ROS nor imports: a name exists if its module binds it at the top level. Programs in texts of a file are
read in the same way, as tests have them for the processes that they start.
"""
import ast
import pathlib
import re
import sys

SOURCE = pathlib.Path('src')
IMPORT = re.compile(r'^\s*from (?:move_base_abstract|soil_mapping)', re.MULTILINE)
GENERATED = ('cfg', 'msg', 'srv')  # catkin makes these modules


def bound_names(tree):
    """Return the names that a module binds at its top level, also below if, try and with, and those of ``__all__``."""
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
            if stored == ['__all__'] and isinstance(node.value, ast.List):  # it may import them when they are used
                names.update(one.value for one in node.value.elts)
    return names | {'__name__', '__file__', '__doc__'}


def our_modules():
    """Return {dotted name: names} of our modules and packages: their top-level names, and the modules of a package."""
    modules = {}
    for path in sorted(SOURCE.rglob('*.py')):
        parts = path.relative_to(SOURCE).with_suffix('').parts
        parts = parts[:-1] if parts[-1] == '__init__' else parts
        tree = ast.parse(path.read_text())
        modules.setdefault('.'.join(parts), set()).update(bound_names(tree))
        if len(parts) > 1:
            modules.setdefault('.'.join(parts[:-1]), set()).add(parts[-1])
    return modules


def is_ours(module, modules):
    """Return whether a module is in src/, or would be there if it existed."""
    parts = module.split('.')
    return parts[0] in modules and parts[-1] not in GENERATED


def missing_names(tree, modules):
    """Yield (line, module, name) of every name that ``tree`` uses from one of ``modules``, but that does not exist."""
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
    """Yield (first line, tree) of each text in ``tree`` that is a program with imports of our modules."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and IMPORT.search(node.value):
            try:
                yield node.lineno, ast.parse(node.value)
            except SyntaxError:  # prose, or a part of a program
                continue


def main():
    """Check all files below the folders of the command line; return the exit code, 1 if a name is missing."""
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
