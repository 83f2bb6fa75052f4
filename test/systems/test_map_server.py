"""The stand-in for map_server: topics, services, command line, exit codes, and errors about bad files."""
import itertools
import math
import os
import shutil
import tempfile
import time
import unittest

import rosgraph
import rospy
from nav_msgs.msg import MapMetaData, OccupancyGrid
from nav_msgs.srv import GetMap
from robot_harness import GUARD, LoadMap, Record
from robot_process import Started

from move_base_abstract_ros.loopback import find_executable

LAUNCH_FILE = '<launch></launch>'
FACTOR = 10
OWN_NODE = 'map_server_test'

BLOCKS = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'data', 'blocks.yaml')
YAML = {'image': 'm.pgm', 'resolution': 0.5, 'origin': [1.0, 2.0, 0.0], 'negate': 0, 'occupied_thresh': 0.65,
        'free_thresh': 0.196}
PGM = b'P5\n3 2\n255\n\x00\xcd\xfe\xfe\xfe\x00'  # the cells, south first: 0 0 100, 100 -1 0
CELLS = (0, 0, 100, 100, -1, 0)
FAILURE = 255

_names = ('m{}'.format(number) for number in itertools.count())


class MapServer(unittest.TestCase):
    """Each test starts map servers in namespaces of their own."""

    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix='map_server_test_')
        self.addCleanup(shutil.rmtree, self.folder)
        self.write('m.pgm', PGM)
        self.namespace = '/' + next(_names)

    def write(self, name, content):
        """Write a file, from bytes, a text or a dictionary of YAML keys, and return its path."""
        path = os.path.join(self.folder, name)
        if isinstance(content, dict):
            content = ''.join('{}: {}\n'.format(*pair) for pair in content.items())
        with open(path, 'wb') as stream:
            stream.write(content if isinstance(content, bytes) else content.encode())
        return path

    def describe(self, **changes):
        """Write a map's YAML file with ``changes`` and return its path."""
        return self.write('m.yaml', dict(YAML, **changes))

    def start(self, *arguments, environment=None, **parameters):
        """Start a map server that is ended with the test."""
        if parameters:
            rospy.set_param(self.namespace + '/map_server', parameters)
        command = [find_executable('map_server'), *arguments, '__ns:=' + self.namespace, '__name:=map_server']
        process = Started(command, environment, self.folder)
        self.addCleanup(process.end)
        return process

    def grid(self):
        """Return the latched map on the topic."""
        return rospy.wait_for_message(self.namespace + '/map', OccupancyGrid, GUARD)

    def service(self, name, kind):
        """Wait for a service, and return its proxy."""
        rospy.wait_for_service('{}/{}'.format(self.namespace, name), GUARD)
        return rospy.ServiceProxy('{}/{}'.format(self.namespace, name), kind)

    def refused(self, arguments, *words, **parameters):
        """Assert that a map server ends at once with an error that holds ``words``, and without a traceback."""
        process = self.start(*arguments, **parameters)
        code, output = process.exit_code(), process.output
        self.assertEqual(code, FAILURE, output)
        for word in words:
            self.assertIn(word, output)
        self.assertNotIn('Traceback', output)

    def test_map_metadata_and_service_say_the_same(self):
        before = rospy.Time.now()
        self.start(self.describe(origin=[1.0, -2.0, math.pi / 2]))
        grid = self.grid()
        self.assertEqual(grid.data, CELLS)
        self.assertEqual((grid.header.frame_id, grid.info.width, grid.info.height, grid.info.resolution),
                         ('map', 3, 2, 0.5))
        origin = grid.info.origin
        self.assertEqual((origin.position.x, origin.position.y, origin.position.z), (1.0, -2.0, 0.0))
        self.assertAlmostEqual(origin.orientation.z, math.sqrt(0.5))
        self.assertAlmostEqual(origin.orientation.w, math.sqrt(0.5))
        self.assertEqual(grid.header.stamp, grid.info.map_load_time)
        self.assertTrue(before <= grid.header.stamp <= rospy.Time.now())
        metadata = rospy.wait_for_message(self.namespace + '/map_metadata', MapMetaData, GUARD)
        self.assertEqual(metadata, grid.info)
        served = self.service('static_map', GetMap)().map
        self.assertEqual((served.info, served.data, served.header.frame_id), (grid.info, grid.data, 'map'))

    def test_one_that_looks_on_in_lockstep_leaves_the_clock_but_knows_the_time_of_a_change(self):
        self.addCleanup(rospy.set_param, '/time_master/mode', rospy.get_param('/time_master/mode', 'scaled'))
        rospy.set_param('/time_master/mode', 'lockstep')  # what the node asks for; the clock of this test goes on
        self.start(self.describe())
        self.grid()
        name, master = self.namespace + '/map_server', rosgraph.Master(rospy.get_name())
        give_up_at = time.monotonic() + GUARD
        while name in dict(master.getSystemState()[1]).get('/clock', ()) and time.monotonic() < give_up_at:
            time.sleep(0.05)
        self.assertNotIn(name, dict(master.getSystemState()[1]).get('/clock', ()))
        if LoadMap is not None:
            before = rospy.Time.now()
            changed = self.service('change_map', LoadMap)(self.describe(resolution=1.0)).map.info
            self.assertEqual(changed.resolution, 1.0)
            self.assertTrue(before <= changed.map_load_time <= rospy.Time.now(), changed)

    def test_an_image_of_another_place_can_be_given(self):
        path = self.describe(image='gone/m.pgm')
        self.refused([path], 'gone/m.pgm: cannot be read', 'beside the YAML file there is')
        self.start(path, image=os.path.join(self.folder, 'm.pgm'))
        self.assertEqual(tuple(self.grid().data), CELLS)

    def test_the_floor_plan_of_a_world_of_stage_is_a_map_in_its_frame(self):
        self.start(self.write('one.world', 'floorplan ( bitmap "m.pgm" size [ 1.5 1.0 1 ] pose [ 2.75 4 0 0 ] )\n'))
        grid = self.grid()
        self.assertEqual((grid.data, grid.info.resolution), ((0, 0, 100, 100, 0, 0), 0.5))
        self.assertEqual((grid.info.origin.position.x, grid.info.origin.position.y), (2.0, 3.5))
        self.namespace = '/' + next(_names)
        self.refused((self.write('none.world', 'floorplan ( size [ 1 1 1 ] )\n'),), 'none.world', 'no floor plan')

    def test_frame_id_and_an_unknown_key(self):
        process = self.start(self.describe(modes='raw'), frame_id='field')
        self.assertEqual(self.grid().header.frame_id, 'field')
        process.end()
        self.assertIn("modes: unknown key, not used; did you mean 'mode'?", process.output)

    @unittest.skipIf(LoadMap is None, 'nav_msgs has no LoadMap here')
    def test_change_map_tells_those_who_listen(self):
        self.start(self.describe())
        grids = Record(self.namespace + '/map', OccupancyGrid)
        metadata = Record(self.namespace + '/map_metadata', MapMetaData)
        first = grids.wait_for()
        change = self.service('change_map', LoadMap)
        for url in (BLOCKS, 'file://' + BLOCKS, 'package://move_base_abstract/maps/farm_yard.yaml'):
            grids.clear()
            metadata.clear()
            width = 600 if 'farm' in url else 12
            answer = change(url)
            self.assertEqual((answer.result, answer.map.info.width), (answer.RESULT_SUCCESS, width))
            told = answer.map.info
            grids.wait_for(lambda grid, told=told: grid.info == told)
            metadata.wait_for(lambda info, told=told: info == told)
        self.assertGreater(grids.messages[-1].info.map_load_time, first.info.map_load_time)

    @unittest.skipIf(LoadMap is None, 'nav_msgs has no LoadMap here')
    def test_a_change_that_fails_leaves_the_old_map(self):
        process = self.start(self.describe())
        old = self.grid()
        change = self.service('change_map', LoadMap)
        self.write('cut.pgm', PGM[:-1])
        for url in ('/no/map.yaml', 'package://no_such_package/m.yaml', ''):
            self.assertEqual(change(url).result, 255)  # RESULT_UNDEFINED_FAILURE
        for content in (dict(YAML, image='cut.pgm'), dict(YAML, resolution=0), 'image: ['):
            self.assertEqual(change(self.write('m.yaml', content)).result, 255)
        self.assertEqual((self.grid().info, self.grid().data), (old.info, old.data))
        self.assertEqual(self.service('static_map', GetMap)().map.data, CELLS)
        process.end()
        output = process.output
        for words in ('/no/map.yaml: cannot be read', "there is no package 'no_such_package'", 'cut.pgm: the image',
                      'resolution: got 0; allowed', 'is not YAML of plain values', 'the map stays as it is'):
            self.assertIn(words, output)
        self.assertNotIn('Traceback', output)

    def test_the_old_form_has_its_thresholds_from_parameters(self):
        self.start('m.pgm', '0.25')
        grid = self.grid()
        self.assertEqual((grid.data, grid.info.resolution, grid.info.origin.position.x), (CELLS, 0.25, 0.0))
        self.namespace = '/' + next(_names)
        self.start('m.pgm', '0.25', negate=1, occupied_thresh=0.9, free_thresh=0.1)
        self.assertEqual(self.grid().data, (100, 100, 0, 0, -1, 100))

    def test_wrong_arguments_show_the_usage(self):
        self.refused((), 'got 0 arguments', 'USAGE: map_server')
        self.refused(('a', 'b', 'c'), 'got 3 arguments', 'USAGE: map_server')
        for resolution in ('0', '-1', 'fine', 'nan'):
            self.refused(('m.pgm', resolution), "RESOLUTION: got '{}'; allowed: a finite number > 0".format(resolution),
                         'USAGE: map_server')

    def test_bad_files_end_it_with_an_error_that_says_where_and_what(self):
        self.refused(('/no/map.yaml',), 'FATAL', '/no/map.yaml: cannot be read: No such file or directory')
        self.write('cut.pgm', PGM[:-1])
        self.refused((self.describe(image='cut.pgm'),), 'FATAL', 'cut.pgm: the image is damaged or truncated')
        self.refused(('none.pgm', '0.5'), 'FATAL', 'none.pgm: cannot be read')

    def test_bad_parameters_end_it_too(self):
        self.refused(('m.pgm', '1'), '/map_server/negate', "got 'no'", negate='no')
        self.refused((self.describe(),), '/map_server/frame_id', 'got 3', 'a frame name', frame_id=3)

    def test_where_the_real_one_is_installed_it_runs_with_the_same_arguments(self):
        package = os.path.join(self.folder, 'src', 'map_server')
        os.makedirs(package)
        self.write('src/map_server/package.xml', '<package><name>map_server</name></package>')
        os.chmod(self.write('src/map_server/map_server', '#!/bin/sh\necho the real one: "$@"\nexit 7\n'), 0o755)
        environment = dict(os.environ, ROS_PACKAGE_PATH=os.path.join(self.folder, 'src') + os.pathsep
                           + os.environ.get('ROS_PACKAGE_PATH', ''))
        process = self.start('some.yaml', '_frame_id:=field', environment=environment)
        code = process.exit_code()
        self.assertEqual((code, process.output), (
            7, 'the real one: some.yaml _frame_id:=field __ns:={} __name:=map_server\n'.format(self.namespace)))
