"""What the reports say of robots that are driven by velocities: of one run, and of an experiment."""
import html
import json
import re

import pytest

from driven_robots import S, fleet_of
from experiment_folder import plain, write
from move_base_abstract.fleet import Fleet
from move_base_abstract.runs.metrics import METRICS
from move_base_abstract.scenario import make_scenario
from move_base_abstract_experiments import fleet_report
from move_base_abstract_experiments.report import command
from move_base_abstract_experiments.trials.metrics import summarise


def test_the_report_of_a_fleet_has_the_time_of_drives_and_where_the_battery_was_empty(tmp_path, capsys):
    fleet = fleet_of(cmd_vel_timeout=0.0, failure_kind='stuck', battery_capacity=0.01, nominal_voltage=10.0, mass=10.0,
                     friction_coefficient=0.2, ambient_power=0.0, tool_power=0.0)
    robot = fleet.robot('r')
    robot.drive(0.5)
    fleet.run(4 * S)
    robot.drive(0.0)
    fleet.run(6 * S)
    robot.drive(1.0)
    fleet.run(7 * S)
    assert robot.fail()
    fleet.run(9 * S)
    assert robot.repair()
    robot.drive(1.0)
    fleet.run(40 * S)
    path = tmp_path / 'run.jsonl'
    fleet.write_log(path)
    fleet_report.main([str(path), '--json', '-'])
    found = json.loads(capsys.readouterr().out)['robots']['r']
    changes, friction = 2 * 1.25 + 2 * 5.0 + 5.0, 0.2 * 10.0 * 9.81  # J, of speeding up and of braking; N
    last_s = (360.0 - changes) / friction - 3.0  # 360 J are in the battery, and 3 m were driven before
    assert found['driving'] == pytest.approx(5.0 + last_s, abs=1e-6)
    assert found['idle'] == pytest.approx(2.0 + 31.0 - last_s, abs=1e-6)
    assert (found['failed'], found['failures']) == (2.0, 1)
    fleet_report.main([str(path)])
    said = f'\nran empty: r at {9.0 + last_s:.1f} s, at ({3.0 + last_s:.2f}, 0.00), driving\n'
    assert said in capsys.readouterr().out


def measured(folder, speed, number):
    """Return the metrics of a run of a robot under velocities, and of one that travels to a goal."""
    fleet = Fleet(make_scenario({'robots': [
        {'name': 'driven', 'driven_by': 'velocities', 'cmd_vel_timeout': 0.0, 'log_motion': True},
        {'name': 'travels', 'start_y': 20.0, 'max_speed': 1.0}]}), start_ns=0)
    fleet.robot('travels').send(5.0, 20.0)
    fleet.robot('driven').drive(speed, 1.0)
    fleet.run((4 + number) * S)
    fleet.robot('driven').drive(0.0)
    fleet.run(20 * S)
    path = folder / f'{speed}_{number}.jsonl'
    fleet.write_log(path)
    return summarise(str(path), {'driven': (0.0, 0.0), 'travels': (0.0, 20.0)}).metrics


def test_the_report_of_an_experiment_has_the_ways_of_arcs(tmp_path):
    runs = {(speed, number): measured(tmp_path, speed, number) for speed in (0.5, 1.0) for number in range(3)}
    for (speed, number), metrics in runs.items():
        assert metrics['distance'] == pytest.approx(5.0 + speed * (4 + number))  # along the arc
        assert metrics['moving'] == pytest.approx((5.0 + 4 + number) / 2)
        assert metrics['goals'] == 1
    names = ('distance', 'moving', 'goals')
    folder = tmp_path / 'experiment'
    folder.mkdir()
    write(folder, {'speed': [0.5, 1.0]}, 3,
          lambda levels, number: {name: runs[levels['speed'], number][name] for name in names},
          {name: METRICS[name].described() for name in names})
    page = command.write(folder)[0].read_text(encoding='utf-8')
    said = plain(html.unescape(re.sub(r'<[^>]*>', ' ', page)))
    assert 'Distance travelled' in said and 'Time moving, mean of the robots' in said
    for mean in ('7.5', '10.0'):  # 5 m of the goal, and 5 s at 0.5 or 1 m/s
        assert mean in said
