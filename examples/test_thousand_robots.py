"""A test of thousand_robots.py with fewer robots. It needs no ROS, and so no fixture of the plugin."""
import re

import thousand_robots


def test_each_robot_drives_one_goal_after_the_other(capsys):
    """Two runs have the same number of goals and kilometres; their wall time differs."""
    said = []
    for _ in range(2):
        thousand_robots.main(20, 0.5)
        said.append(re.match(r'20 robots, 0\.5 h: (\d+) goals, (\d+\.\d) km, ', capsys.readouterr().out).groups())
    assert said[0] == said[1] and int(said[0][0]) > 20 and float(said[0][1]) > 20.0
