"""What a node of a launch file sees under lockstep_launch is the same as under roslaunch itself, field by field."""
import json
import os
import re
import signal
import socket
import subprocess
import unittest
from types import SimpleNamespace

from own_folder import OwnPackage

from move_base_abstract_ros.launching import roles
from move_base_abstract_ros.loopback import find_executable

GUARD = 40.0  # s, wall
DUMP = """#!/usr/bin/env python3
import json, os, sys
seen = {'argv': sys.argv[:], 'folder': os.getcwd(), 'environment': dict(os.environ), 'modules': sys.path[0],
        'nice': os.nice(0), 'is_on_screen': not os.path.realpath('/dev/stdout').endswith('-stdout.log')}
open('/proc/self/stat').read()  # labels the run before the node is there
import rospy
rospy.init_node('dump')
seen.update(name=rospy.get_name(), namespace=rospy.get_namespace(), mappings=dict(rospy.names.get_mappings()),
            names=[rospy.resolve_name(name) for name in ('talk', 'out', '/scan', '~x')],
            words=rospy.myargv(), own=rospy.get_param('~', None), parameters=rospy.get_param('/'))
path = os.path.join(os.environ['DUMPS'], rospy.get_name().strip('/').replace('/', '-'))
path += '.again' * os.path.exists(path)
with open(path + '.new', 'w') as stream:
    json.dump(seen, stream)
os.rename(path + '.new', path)
if path.endswith('respawned'):
    os._exit(0)
rospy.spin()
"""
# Ends, and the launch with it, when all the others have dumped; notes what a program in C++ was started with.
LAST = """#!/usr/bin/env python3
import glob, json, os, sys, time
def words_of(path):
    try:
        return open(path).read().split('\\0')
    except OSError:
        return ['']
def is_ours(folder):
    return (words_of(folder + '/cmdline')[0].endswith('/shim_listener')
            and 'DUMPS=' + os.environ['DUMPS'] in words_of(folder + '/environ'))
while len([name for name in os.listdir(os.environ['DUMPS']) if not name.endswith('.new')]) < int(sys.argv[1]):
    time.sleep(0.1)
found = []
while not found:
    found = [folder for folder in glob.glob('/proc/[0-9]*') if is_ours(folder)]
seen = {'argv': words_of(found[0] + '/cmdline'), 'folder': os.readlink(found[0] + '/cwd'),
        'environment': dict(one.split('=', 1) for one in words_of(found[0] + '/environ') if one)}
with open(os.path.join(os.environ['DUMPS'], 'relay'), 'w') as stream:
    json.dump(seen, stream)
"""
INNER = """<launch>
  <arg name="text"/>
  <node pkg="study_of_others" type="dump.py" name="included" args="$(dirname) $(arg text)" cwd="ROS_HOME"/>
</launch>
"""
ALL = """<launch>
  <arg name="text" default="a b"/>
  <env name="OUTER" value="1 2"/>
  <param name="global" value="3"/>
  <remap from="talk" to="chat"/>
  <machine name="desk" address="localhost"/>
  <node pkg="study_of_others" type="dump.py" name="folder" cwd="node" output="screen"/>
  <node pkg="study_of_others" type="dump.py" name="prefix" launch-prefix="/usr/bin/nice -n 2" cwd="node"/>
  <node pkg="study_of_others" type="dump.py" name="python" launch-prefix="/usr/bin/env WORDS='x y' python3 -u"/>
  <node pkg="study_of_others" type="dump.py" name="shell" launch-prefix="bash -c 'exec &quot;$0&quot; &quot;$@&quot;'"/>
  <node pkg="study_of_others" type="dump.py" name="worded"
        launch-prefix="bash -c 'test -x $0 &amp;&amp; exec &quot;$0&quot; --first &quot;2 3&quot; $@'" args="4"/>
  <node pkg="study_of_others" type="dump.py" name="quotes" output="log"
        args="'a b' &quot;c d&quot; e\\ f '' --x=&quot;g h&quot; $(arg text) '$(arg text)' # $HOME ~ * _a:=5 out:=/b"/>
  <node pkg="study_of_others" type="dump.py" name="found" ns="deep/er"
        args="$(dirname) $(find study_of_others)/x $(optenv NOT_SET de fault) $(find study_of_others)/dump.py"/>
  <node pkg="study_of_others" type="dump.py" name="evaluated" args="$(eval str(1 + 2) + text + dirname())"/>
  <node pkg="study_of_others" type="dump.py" name="desk" machine="desk">
    <env name="OWN" value="$(arg text)"/><env name="OUTER" value=""/>
    <remap from="out" to="in"/><remap from="scan" to="base_scan"/><remap from="~x" to="/y"/>
    <param name="p" value="7"/><rosparam>{a: [1, 2.5, x], b: {c: true}}</rosparam>
  </node>
  <group ns="robot">
    <param name="~private" value="1"/>
    <include file="$(dirname)/inner.launch"><arg name="text" value="'in ner'"/></include>
    <node pkg="study_of_others" type="shell.sh" name="script" cwd="node" args="'p q'"/>
  </group>
  <node pkg="study_of_others" type="dump.py" name="respawned" respawn="true" respawn_delay="0.1" clear_params="true"/>
  <node pkg="move_base_abstract" type="shim_listener" name="relay" args="/a '/b'" cwd="node"/>
  <node pkg="study_of_others" type="last.py" name="last" args="13" required="true"/>
</launch>
"""
SCRIPT = '#!/bin/bash\nexec "$(dirname "$0")/dump.py" "from shell" "$@"\n'
#: differ from run to run; or are how we start nodes (docs/lockstep_launcher.md); or are of the shell of a test
VARIABLES = {
    'ROS_MASTER_URI', 'ROS_LOG_FILENAME', 'ROS_IP', 'DUMPS', 'SHLVL', '_', 'TMPDIR', 'PYTHONHASHSEED', 'LD_PRELOAD',
    'ROS_PYTHON_LOG_CONFIG_FILE', 'MKL_NUM_THREADS', 'OMP_NUM_THREADS', 'OMP_THREAD_LIMIT', 'OPENBLAS_NUM_THREADS',
    'BLIS_NUM_THREADS', 'NUMEXPR_NUM_THREADS', 'GLIBC_TUNABLES', 'MALLOC_ARENA_MAX'}
OURS = 'MOVE_BASE_ABSTRACT_'
PARAMETERS = {'roslaunch', 'run_id', 'time_master', 'use_sim_time', 'quotes'}  # the last one is set by its node


def compared(path):
    """Return what a node has dumped, without what differs for a reason."""
    with open(path) as stream:
        seen = json.loads(re.sub(r'(/log/)[0-9a-f-]{36}/', r'\1', stream.read()))
    seen['environment'] = {name: value for name, value in seen['environment'].items()
                           if name not in VARIABLES and not name.startswith(OURS)}
    seen['parameters'] = {name: value for name, value in seen.get('parameters', {}).items() if name not in PARAMETERS}
    return seen


class LikeRoslaunch(OwnPackage, unittest.TestCase):
    """One launch file with all attributes that become a node's command line, environment or parameters."""

    FILES = {'dump.py': DUMP, 'last.py': LAST, 'shell.sh': SCRIPT}

    def dumps(self, name, command):
        """Return {node: what it has dumped} of a launch by a command."""
        folder = self.path(name)
        os.mkdir(folder)
        environment = dict(self.environment, DUMPS=folder, PWD=self.folder, ROS_HOME=self.path('home'),
                           ROS_IP='127.0.0.1')
        for variable in ('ROS_LOG_DIR', 'ROS_NAMESPACE', 'ROS_HOSTNAME'):
            environment.pop(variable, None)
        with open(self.path(name + '.txt'), 'w+') as output:
            launching = subprocess.Popen([*command, 'launch/all.launch', "text:=c  'd e'"], env=environment,
                                         cwd=self.folder, stdin=subprocess.DEVNULL, stdout=output, stderr=output)
            try:
                launching.wait(GUARD)
            finally:
                launching.send_signal(signal.SIGINT)  # roslaunch ends its nodes then
                launching.wait()
            output.seek(0)
            said = output.read()
        found = {one: compared(os.path.join(folder, one)) for one in sorted(os.listdir(folder))}
        self.assertIn('relay', found, said[-6000:])
        return found

    def test_a_node_sees_the_same_as_under_roslaunch(self):
        for name, text in (('all', ALL), ('inner', INNER)):
            self.write('launch/{}.launch'.format(name), text)
        with socket.socket() as free:
            free.bind(('127.0.0.1', 0))
            port = str(free.getsockname()[1])
        self.environment['ROS_MASTER_URI'] = 'http://127.0.0.1:{}'.format(port)
        expected = self.dumps('theirs', ['roslaunch', '-p', port])
        self.maxDiff = None
        for options in ((), ('--tolerant',)):
            found = self.dumps('ours' + ''.join(options), ['rosrun', 'move_base_abstract', 'lockstep_launch', *options])
            self.assertEqual(sorted(found), sorted(expected))
            for node, seen in expected.items():
                self.assertEqual(found[node], seen, node)
        self.assertEqual(expected['folder']['folder'], self.folder)

    def test_where_roslaunch_starts_no_node_the_folder_is_the_programs(self):
        node = SimpleNamespace(package='move_base_abstract', type='fleet')
        program, launcher = roles.program_of(node), find_executable('lockstep')
        for words in (['nice', '-n', '2', program], [launcher, '--seed', '0', 'env', 'A=1', program],
                      [launcher, '--sleep', 'wall', program]):
            self.assertEqual(roles.folder_of(node, words, launcher), os.path.dirname(program))
        self.assertEqual(roles.folder_of(node, [launcher, '--seed', '0', '/usr/bin/python3', program], launcher),
                         '/usr/bin')


if __name__ == '__main__':
    unittest.main()
