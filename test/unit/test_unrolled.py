"""Shell scripts that start several nodes in the background: an adopted file gets these nodes in the script's place."""
import tracemalloc

import pytest

from move_base_abstract_ros.adopting import unrolled
from strangers_package import adopt, package_fixture  # noqa: F401 - a fixture

SCRIPT = """#!/bin/bash
name="$(rosparam get /robot_name)_"
count=$(rosparam get how_many)
[ "$(rosparam get /debug)" = "true" ] && rosservice call /robot_0/set_logger_level debug
for ((i=0; i<count; i++)); do
  ROS_NAMESPACE="$name$i" rosrun of_a_stranger agent.py _speed:=$1 "_text:=a b" &
done
rosrun of_a_stranger other __name:=named &
cat
"""
FILE = """<launch><param name="robot_name" value="bot"/><param name="how_many" value="11"/>
  <param name="debug" value="true" type="bool"/><node pkg="move_base" type="move_base" name="move_base"/>
  <node pkg="of_a_stranger" type="start.sh" name="start" args="0.5"/></launch>"""


def test_the_nodes_are_added_with_their_names_namespaces_and_arguments(package):
    package('scripts/start.sh', SCRIPT, 0o755)
    package('scripts/agent.py', '#!/usr/bin/env python\nimport rospy\nrospy.init_node("Agent")\nprint 1\n', 0o755)
    made = adopt(package('one.launch', FILE))
    assert made.problems == () and made.options.leave_out == ('/start',)
    assert [*made.options.add.items()] == [
        *(('/bot_{}/Agent'.format(number), "of_a_stranger/agent.py _speed:=0.5 '_text:=a b'") for number in range(11)),
        ('/named', 'of_a_stranger/other')]
    assert any('/start (of_a_stranger/start.sh) is left out: it is a shell script that starts 12 nodes' in line
               for line in made.done)
    assert made.options.python2 == ('of_a_stranger',)


@pytest.mark.parametrize(('text', 'expected'), [
    (SCRIPT, True), ('#!/bin/sh\nexec rosrun a b\n', False), ('#!/bin/sh\n# rosrun a b &\n', False),
    ('#!/usr/bin/env python3\nrosrun a b &\n', False), ('#!/bin/sh\nsleep 1 & rosrun a b\n', False),
    ('rosrun a b &\n', False)])
def test_only_shell_scripts_that_leave_nodes_in_the_background_count(tmp_path, text, expected):
    (tmp_path / 'x').write_text(text)
    assert unrolled.starts_several(str(tmp_path / 'x')) is expected


def test_a_script_that_does_not_end_is_ended_and_what_it_has_started_counts(tmp_path, monkeypatch):
    monkeypatch.setattr(unrolled, '_LONGEST', 0.5)
    path = tmp_path / 'x'
    path.write_text('#!/bin/sh\nrosrun a b &\nwait\nwhile :; do sleep 1; done\n')
    path.chmod(0o755)
    assert unrolled.nodes_of(str(path), [], {}, lambda *_: None) == (
        {'/b': 'a/b'}, '; while they were looked for, it could not do this: end within 0.5 s')


def test_a_node_is_added_once_and_one_that_no_option_could_add_is_told(package):
    package('scripts/start.sh', """#!/bin/bash
for i in 1 2 3; do rosrun of_a_stranger b __name:=/b2 & done
rosrun of_a_stranger scripts/b.py "text:=a b" &
rosrun of_a_stranger b __name:=1² & rosrun of_a_stranger b "__name:=x y" & rosrun "of a" b &
""", 0o755)
    made = adopt(package('one.launch', FILE))
    assert made.options.add == {'/b': "of_a_stranger/b.py 'text:=a b'", '/b2': 'of_a_stranger/b'}
    line, = (line for line in made.remarks if '/start' in line)
    assert 'starts 2 nodes' in line and line.count("start 'of_a_stranger/b' as '/") == 2
    assert "'/1\\xb2'" in line and "start 'of a/b' as '/b'" in line


def test_a_script_that_starts_nothing_is_told(package):
    package('scripts/start.sh', '#!/bin/bash\nif then\nrosrun of_a_stranger b &\n', 0o755)
    assert any('starts 0 nodes' in line for line in adopt(package('one.launch', FILE)).remarks)


def test_what_a_script_prints_is_not_kept(tmp_path):
    path = tmp_path / 'x'
    path.write_text('#!/bin/sh\nrosrun a b &\nhead -c 50000000 /dev/zero\n')
    path.chmod(0o755)
    tracemalloc.start()
    found, _ = unrolled.nodes_of(str(path), [], {}, lambda *_: None)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert [*found] == ['/b'] and most < 5_000_000


def test_nodes_are_waited_for_whatever_becomes_of_their_output(tmp_path, monkeypatch):
    monkeypatch.setattr(unrolled, '_RUN', unrolled._RUN.replace('printf', '/bin/sleep 0.1; printf'))
    path = tmp_path / 'x'
    path.write_text('#!/bin/bash\nrosrun a b >> log 2>&1 &\nrosrun a c >/dev/null 2>&1 &\n')
    assert len(unrolled.nodes_of(str(path), [], {}, lambda *_: None)[0]) == 2


def test_a_script_changes_nothing_and_what_it_is_refused_is_told(tmp_path):
    kept = tmp_path / 'kept'
    kept.write_text('kept')
    path = tmp_path / 'x'
    path.write_text("""#!/bin/bash
cd {0}
rm kept; /bin/rm {0}/kept; echo > {0}/kept; echo >> {0}/kept; : >| {0}/kept
history -w {0}/kept; kill -TERM $PPID; command kill -TERM $PPID
PATH=/bin:/usr/bin
python3 -c "open('{0}/kept', 'w')"; env rm {0}/kept; exec rm {0}/kept
(enable kill; kill -TERM $PPID)
sleep 100; rosrun a b >> {0}/kept 2>&1 &
rosrun a c
""".format(tmp_path))
    path.chmod(0o644)
    nodes, refused = unrolled.nodes_of(str(path), [], {}, lambda *_: None)
    assert nodes == {'/b': 'a/b', '/c': 'a/c'}
    assert ': line 3: rm; line 3: /bin/rm; ' in refused and refused.endswith('; and more')
    assert kept.read_text() == 'kept' and sorted(one.name for one in tmp_path.iterdir()) == ['kept', 'x']
