"""Python scripts take part if they import rospy, also by other modules; that is found by reading the sources."""
import sys
import unittest
from unittest import mock

from own_folder import OwnFolder

from move_base_abstract_ros.launching import programs

NODE = 'import rospy\nrospy.init_node("x")\nrospy.Publisher("/clock", None)\n'
#: the __init__.py that catkin writes into a devel space, for a package whose sources are elsewhere
RELAY = "__extended_path = '{}'.split(';')\nfor p in reversed(__extended_path):\n    del p\n"


class LockstepImportsTest(OwnFolder, unittest.TestCase):

    def put(self, name, text=''):
        return self.write(name, text, 0o755)

    def takes_part(self, script):
        """Return whether the script is a rospy program; check that only then its publisher of /clock is found."""
        path = self.put('scripts/script', '#!/usr/bin/env python3\n' + script)
        kind = programs.kind_of(path)[0]
        self.assertIn(kind, ('rospy', None))
        self.assertEqual(programs.publishes_clock(path), kind == 'rospy', script)
        return kind == 'rospy'

    def test_a_module_of_a_package_is_found_however_it_is_imported(self):
        self.put('scripts/study/__init__.py')
        self.put('scripts/study/node.py', NODE)
        self.put('scripts/study/plain.py', 'import math\n')
        self.put('scripts/front/__init__.py', 'from .parts import (plain,\n    begin as start)\n')
        self.put('scripts/front/parts/__init__.py', 'from . import plain\n')
        self.put('scripts/front/parts/plain.py', 'from ..deep.node import main\n')
        self.put('scripts/front/deep/__init__.py')
        self.put('scripts/front/deep/node.py', NODE)
        for line in ('import study.node', 'from study import node', 'from study import plain, node as it',
                     'from study import (\n    plain,  # not this\n    node)', 'from study.node import main',
                     'import front', 'from front import start'):
            self.assertTrue(self.takes_part(line + '\n'), line)
        for line in ('import study', 'from study import plain', 'from study import none', 'from study import *',
                     'from none import node', 'import math'):
            self.assertFalse(self.takes_part(line + '\n'), line)

    def test_a_package_of_a_devel_space_is_found_where_its_sources_are(self):
        self.put('sources/study/__init__.py')
        self.put('sources/study/node.py', NODE)
        self.put('devel/study/__init__.py', RELAY.format('/none;' + self.path('sources')))
        with mock.patch.object(sys, 'path', [*sys.path, self.path('devel')]):
            for line in ('from study import node', 'import study.node', 'from study.node import main'):
                self.assertTrue(self.takes_part(line + '\n'), line)
            self.assertFalse(self.takes_part('import study\n'))
