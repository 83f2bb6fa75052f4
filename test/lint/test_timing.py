"""Which kind of time it is, is asked in one place."""
import ast
import os

SOURCES = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', 'src')
TIMING = os.path.join(SOURCES, 'move_base_abstract_ros', 'clocks', 'timing.py')


def trees():
    """Yield (path below src, syntax tree) of each Python file."""
    for folder, _, names in sorted(os.walk(SOURCES)):
        for name in sorted(names):
            if name.endswith('.py'):
                path = os.path.join(folder, name)
                with open(path, encoding='utf-8') as stream:
                    yield os.path.relpath(path, SOURCES), ast.parse(stream.read())


def names_in(tree):
    return {getattr(node, 'id', getattr(node, 'attr', getattr(node, 'arg', None))) for node in ast.walk(tree)}


def test_nobody_asks_which_clock_it_is_but_timing_and_the_rooms_of_lockstep():
    asking = [path for path, tree in trees() if 'is_lockstep' in names_in(tree)]
    others = [path for path in asking if not path.startswith(os.path.join('move_base_abstract_ros', 'lockstep', ''))]
    assert others == [os.path.join('move_base_abstract_ros', 'clocks', 'timing.py')]


def test_both_timings_answer_the_same_questions_in_the_same_form():
    with open(TIMING, encoding='utf-8') as stream:
        classes = {node.name: node for node in ast.parse(stream.read()).body if isinstance(node, ast.ClassDef)}

    def questions(name):
        asked = {}
        for node in classes[name].body:
            if isinstance(node, ast.FunctionDef) and node.name == '__init__':
                asked.update((target.attr, None) for target in ast.walk(node)
                             if isinstance(target, ast.Attribute) and isinstance(target.ctx, ast.Store))
            elif isinstance(node, ast.FunctionDef):
                asked[node.name] = [argument.arg.strip('_') for argument in node.args.args]
            elif isinstance(node, (ast.Assign, ast.AnnAssign)):
                asked[(node.targets[0] if isinstance(node, ast.Assign) else node.target).id] = None
        return asked

    assert questions('ScaledTiming') == questions('LockstepTiming') != {}
