"""rosrun and roslaunch offer in a catkin workspace what users may start: no tests, no tools, no benches."""
import os
import shutil
import unittest

import completion
from own_folder import OwnFolder

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))


class Completion(OwnFolder, unittest.TestCase):
    """The workspace has the sources and the devel space of this tree, and no folder on the way begins with a dot."""

    def workspace(self, sources):
        """Make a catkin workspace; return the environment of a shell that has sourced it."""
        os.makedirs(self.path('src'))
        os.symlink(sources, self.path('src/move_base_abstract'))
        os.symlink(os.path.join(ROOT, '.ws', 'devel'), self.path('devel'))
        others = os.environ['ROS_PACKAGE_PATH'].split(os.pathsep)[1:]
        prefixes = os.environ['CMAKE_PREFIX_PATH'].split(os.pathsep)[1:]
        return {**os.environ, 'CMAKE_PREFIX_PATH': os.pathsep.join([self.path('devel'), *prefixes]),
                'ROS_PACKAGE_PATH': os.pathsep.join([self.path('src'), *others])}

    def test_a_workspace_offers_what_is_documented(self):
        env = self.workspace(ROOT)
        self.assertEqual(completion.offered('rosrun', env), completion.documented('Programs'))
        self.assertEqual(completion.offered('roslaunch', env), completion.documented('Launch files'))

    def test_the_built_environment_of_the_sources_offers_the_documented_programs(self):
        offered = completion.offered('rosrun', dict(os.environ), os.path.join(ROOT, '.ws', 'setup.sh'))
        self.assertEqual(offered, completion.documented('Programs'))

    def test_an_executable_test_would_be_offered(self):
        sources = shutil.copytree(os.path.join(ROOT, 'test', 'systems'), self.path('copy/test'))
        shutil.copy(os.path.join(ROOT, 'package.xml'), self.path('copy'))
        os.chmod(os.path.join(sources, 'onlooker.py'), 0o755)
        with open(os.path.join(sources, 'mine.launch'), 'w') as stream:
            stream.write('<launch/>')
        env = self.workspace(self.path('copy'))
        self.assertIn('onlooker.py', completion.offered('rosrun', env))
        self.assertEqual(completion.offered('roslaunch', env), ['mine.launch'])
