"""Sets of objects: the order repeats for the program's own classes; other sets are labelled with file and line."""

import os
import unittest

from lockstep_launcher_run import FOLDER, assert_same, run_programs


class SetsTest(unittest.TestCase):
    def test_sets_of_the_programs_own_objects_repeat(self):
        runs = [run_programs({'dispatcher': ['dispatcher.py']}, until=30.0) for _ in range(4)]
        assert_same(self, runs)
        given, idle, *others = runs[0].printed('dispatcher')
        # In the order of numbers; the object that was hashed first comes first.
        self.assertEqual(len(given.split()), 60)
        self.assertGreater(len(idle.split()), 3)
        self.assertEqual(others, [
            '1', '1 True', "True True True ['CARRIER', 'SCOUT']",
            "{'name': 'robot_3', 'kind': <Kind.SCOUT: 1>, 'padding': 'x'}"])

    def test_those_of_others_are_told_with_file_and_line(self):
        run = run_programs({'shifts': ['shifts.py']}, until=5.0)
        path = os.path.join(FOLDER, 'shifts.py')
        with open(path) as script:
            lines = script.read().splitlines()
        expected = [(1 + number, kinds) for number, line in enumerate(lines) for text, kinds in (
            ('for thread in threads:', 'threading.Thread'),
            ('first =', 'builtins.builtin_function_or_method, builtins.function'),
            ('slots =', '__main__.Slot')) if line.startswith(text)]
        self.assertEqual(len(expected), 3)
        self.assertEqual(list(run.state.not_repeatable_because), [
            "'/shifts': {}, line {}: goes through a set of objects that Python hashes by their address ({}): "
            'its order differs from run to run; a list or a dict keeps the order in which it was filled'.format(
                path, number, kinds) for number, kinds in expected])
        self.assertEqual(len([line for line in run.logged('shifts', 'WARN') if 'goes through a set' in line]), 3)
