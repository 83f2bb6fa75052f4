"""The start of a run: programs that wait for others before init_node, and questions to the ROS master."""

import shutil
import unittest

from lockstep_launcher_run import assert_same, command, run_programs, run_scenario
from own_folder import OwnFolder

from move_base_abstract_ros.loopback import find_executable

LINKS = 8


class BeforeInitNodeTest(OwnFolder, unittest.TestCase):
    """Calls of a program before rospy.init_node."""

    def test_who_waits_for_others_before_it_is_a_node_takes_part_from_there_on(self):
        runs = run_scenario({'stock_taker': ['stock_taker.py'], 'store': ['store.py']}, until=6.0)
        assert_same(self, runs)
        # The service exists from 2.5 s on, the parameter from 3.005 s on; the program looks every 10 ms.
        self.assertEqual(runs[0].printed('stock_taker'), ["3.010000000 2500 pieces ['/store/sold']",
                                                          '4.010000000 4010 pieces'])
        self.assertEqual(runs[0].codes['stock_taker'], 0)

    def test_its_sleeps_are_simulated_from_the_first_one_on_if_asked_for(self):
        run = run_programs({'stock_taker': [['--sleep', 'simulated'], 'sleeper.py'], 'store': ['store.py']}, until=6.0)
        self.assertEqual(run.printed('stock_taker'), ['4.000000000 4000 pieces'])
        self.assertTrue(run.state.repeatable)

    def test_the_name_may_be_told_by_the_script_alone(self):
        words = command(['stock_taker.py'], 'x')[:-1]
        run = run_programs({'stock_taker': None, 'store': ['store.py']}, until=6.0, commands={'stock_taker': words})
        self.assertEqual(run.printed('stock_taker')[-1], '4.010000000 4010 pieces')

    def test_where_the_name_is_not_known_that_is_told(self):
        path = self.write('asker.py', 'import rospy\nrospy.get_published_topics()\n'
                                      "rospy.init_node('%s' % 'asker')\nprint('here')\n")
        run = run_programs({'asker': None}, until=3.0, commands={'asker': command([path], 'x')[:-1]})
        self.assertEqual(run.printed('asker')[-1], 'here')
        self.assertIn('a program whose name is not known yet', run.outputs['asker'])

    def test_a_program_that_has_gone_is_named_as_gone(self):
        path = self.write('gone.py', "import sys\nimport rospy\nif True:\n  sys.exit(3)\nrospy.init_node('gone')\n")
        text = 'its HELLO: it was there, and left .its program ended with code 3 before rospy.init_node'
        with self.assertRaisesRegex(AssertionError, text):
            run_programs({'gone': [path], 'store': ['store.py']}, until=3.0)


class WhoIsThereTest(OwnFolder, unittest.TestCase):
    """Questions to the ROS master."""

    def test_what_is_started_at_one_instant_is_there_whoever_was_slower(self):
        links = {'link_%d' % k: ['link.py', '/link_%d' % (k - 1) if k else '-', '/link_%d' % k]
                 for k in reversed(range(LINKS))}  # not in the order of their names
        links['link_3'].append('_slow:=0.3')  # s, wall
        others = {'census': ['census.py'], 'counter': [find_executable('shim_census')], 'late': ['late.py']}
        runs = run_scenario({**links, **others}, until=5.0)
        assert_same(self, runs)
        names = ' '.join('/link_%d' % k for k in range(LINKS))
        self.assertEqual(runs[0].printed('census'), [
            '1.000000000 %d: %s' % (LINKS, names), '1.000000000 ' + names,
            '/census /counter /late %s /time_master' % names, '2.240000000 late'])
        # /late exists from 2.234 s on. A program that asks without pause asks every 10 ms, in C++ every 1 ms.
        self.assertEqual(runs[0].printed('counter'), [
            '1.000000000 topics ' + names, '1.000000000 %d nodes' % LINKS, '2.234000000 late'])

    def test_who_takes_no_part_and_offers_something_is_labelled(self):
        asks = ("import rosgraph\nimport rospy\nimport rosservice\nrospy.init_node('asker')\n"
                'while not [name for name, kind in rospy.get_published_topics() if name == "/offered"]:\n'
                '    rospy.sleep(1.0)\n'
                "print([nodes for name, nodes in rosgraph.Master('/x').getSystemState()[0] if name == '/offered'])\n"
                'print([name for name in rosservice.get_service_list() if "looks_on" in name])\n')
        run = run_programs({'asker': [self.write('asker.py', asks)]}, until=1e9, onlookers=['/looks_on'], others={
            '/offers': ([shutil.which('rostopic'), 'pub', '/offered', 'std_msgs/String', 'x'], 0)})
        nodes, services = run.printed('asker')
        self.assertEqual(services, '[]')
        self.assertEqual(nodes, "[['/offers']]")
        self.assertEqual(len(run.state.not_repeatable_because), 1, run.state)
        self.assertIn("'/asker': it has asked the ROS master for nodes, topics or services: /offers",
                      run.state.not_repeatable_because[0])
