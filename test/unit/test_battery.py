"""Batteries: energy against a numerical integral, instants of thresholds to the nanosecond, chargers, what is off."""
import math
import random

import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.config.settings import read_settings
from move_base_abstract.energy.consumption import GRAVITY, LegEnergy, Mechanics
from move_base_abstract.fleet import Fleet
from move_base_abstract.motion.approach import MotionPhases
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.motion.leg import Leg, MotionLimits, Tolerances
from move_base_abstract.motion.limited_profile import profile_over
from move_base_abstract.motion.pace import Pace, PacedLeg
from move_base_abstract.motion.phased_route import PhasedRoute
from move_base_abstract.motion.planned_way import PieceLimit, PlannedWay
from move_base_abstract.motion.route import CornerLaw, Route
from move_base_abstract.scenario import make_scenario
from move_base_abstract.tasks.arrivals import Task
from move_base_abstract_experiments import fleet_report
from traces import rows_of_one as rows

S = 1_000_000_000
EMPTY = 'Aborting on the goal because the battery is empty'
ROBOT = Mechanics(70.0, 40.0, 0.22)
DOCK = {'name': 'dock', 'rectangle': [-1.0, -1.0, 1.0, 1.0], 'charger': True}


def fleet_of(zones=(), **settings):
    """Return a Fleet of one robot of 1 m/s, at the time 0: 0.01 Ah at 10 V are 360 J."""
    defaults = {'max_speed': 1.0, 'battery_capacity': 0.01, 'nominal_voltage': 10.0, 'friction_coefficient': 0.0,
                'mass': 1e-12, 'ambient_power': 0.0, **settings}
    return Fleet(make_scenario({'robots': [{'name': 'bot', **defaults}], 'zones': list(zones)}), 0)


def soc(fleet):
    return fleet.robot('bot').condition.battery.soc


# ---- energy of legs: the oracle

def phases():
    return MotionPhases((0.5, 0.1), 0.5, 0.05, 0.8, 1.2, 0.1)


def a_leg(kind, rng):
    """Return a leg of this kind, of chance."""
    limits = MotionLimits(rng.uniform(0.3, 2.0), rng.uniform(0.2, 2.0), rng.uniform(0.3, 2.0))
    start, goal = (Pose2D(rng.uniform(-9, 9), rng.uniform(-9, 9), rng.uniform(-3, 3)) for _ in range(2))
    corners = [(rng.uniform(-9, 9), rng.uniform(-9, 9)) for _ in range(rng.randint(1, 4))]
    law, tolerances = rng.choice(list(CornerLaw)), Tolerances(0.1, 0.1)
    begin_ns = rng.randint(0, 10 ** 12)
    if kind == 'leg':
        return Leg(start, goal, limits, tolerances, begin_ns)
    if kind == 'phased':
        return PhasedRoute(start, goal, corners, limits, phases(), tolerances, begin_ns, law)
    route = Route(start, goal, corners, limits, tolerances, begin_ns, law)
    return PacedLeg(route, Pace(rng.randint(0, 3 * S), rng.uniform(0.7, 3.0))) if kind == 'paced' else route


def integral(leg, mechanics, steps=20_000):
    """Return the work of :mod:`.energy` along ``leg``, in small steps of time: m |dv| v + I |dw| w + f m g ds."""
    begin, span = leg.depart_ns, leg.duration_ns
    speeds = [(0.0, 0.0), *(leg.velocity_at(begin + span * step // steps)[::2] for step in range(steps)), (0.0, 0.0)]
    work = math.fsum(
        mechanics.mass * abs(v - v_before) * 0.5 * (v + v_before)
        + mechanics.moment_of_inertia * abs(abs(w) - abs(w_before)) * 0.5 * (abs(w) + abs(w_before))
        for (v_before, w_before), (v, w) in zip(speeds, speeds[1:]))
    way = math.fsum(0.5 * (one[0] + other[0]) for one, other in zip(speeds[1:], speeds[2:])) * span / steps / S
    return work + mechanics.friction_coefficient * mechanics.mass * GRAVITY * way


@pytest.mark.parametrize('kind', ['leg', 'route', 'phased', 'paced'])
def test_the_energy_of_a_leg_is_the_integral_of_its_power(kind):
    rng = random.Random(kind)
    for _ in range(5):
        leg = a_leg(kind, rng)
        assert LegEnergy(leg, ROBOT).until(leg.arrive_ns) == pytest.approx(integral(leg, ROBOT), rel=1e-3)


@pytest.mark.parametrize('kind', ['leg', 'route', 'phased', 'paced'])
def test_energy_never_falls_and_ends_where_the_leg_does(kind):
    rng = random.Random(kind)
    for _ in range(5):
        leg = a_leg(kind, rng)
        energy = LegEnergy(leg, ROBOT)
        instants = sorted({leg.depart_ns, leg.arrive_ns, *(piece.begin_ns for piece in leg.pieces), *(
            leg.depart_ns + rng.randint(0, leg.duration_ns) for _ in range(100))})
        taken = [energy.until(at_ns) for at_ns in instants]
        assert all(one <= other + 1e-6 for one, other in zip(taken, taken[1:]))
        assert energy.until(leg.arrive_ns + S) == taken[-1] >= energy.until(leg.arrive_ns - 1)


def test_a_trapezoid_costs_what_the_formula_says_and_lanes_do_too():
    leg = Leg(Pose2D(), Pose2D(20.0, 0.0), MotionLimits(2.0, 0.5), depart_ns=7)
    friction = 0.22 * 70.0 * GRAVITY
    assert LegEnergy(leg, ROBOT).until(leg.arrive_ns) == pytest.approx(70.0 * 4.0 + friction * 20.0)
    assert LegEnergy(leg, ROBOT).until(7 + 2 * S) == pytest.approx(0.5 * 70.0 + friction * 1.0)
    way = PlannedWay([(10.0, 0.0)], (PieceLimit(2.0), PieceLimit(1.0)))
    route = Route(Pose2D(), Pose2D(20.0, 0.0), way, MotionLimits(2.0, 0.5))
    assert LegEnergy(route, ROBOT).until(route.arrive_ns) == pytest.approx(70.0 * 4.0 + friction * 20.0)
    assert profile_over(((10.0, 2.0), (10.0, 1.0)), 0.5).seconds * S == pytest.approx(route.duration_ns)


def test_a_turn_at_once_costs_nothing_and_one_that_takes_time_its_start_and_end():
    for rate, energy in ((math.inf, 0.0), (0.5, 40.0 * 0.25)):
        leg = Leg(Pose2D(), Pose2D(0.0, 0.0, 2.0), MotionLimits(1.0, 1.0, rate))
        assert LegEnergy(leg, ROBOT).until(leg.arrive_ns) == pytest.approx(energy)


# ---- thresholds

THIRSTY = {'battery_capacity': 0.02, 'mass': 7.0, 'friction_coefficient': 0.1, 'acceleration': 0.3, 'turn_rate': 0.7,
           'ambient_power': 3.0, 'battery_thresholds': [0.9, 0.5, 0.31]}


def errands(fleet):
    """Have the robot drive five ways, with a rest behind each, and a cancel and a hold on them."""
    for x, y in ((9.0, 4.0), (0.0, 0.0), (7.0, 1.0), (2.0, 2.0), (9.0, 9.0)):
        fleet.at(fleet.now_ns, lambda fleet, x=x, y=y: fleet.robot('bot').send(x, y, 1.0))
        fleet.run_for(11.0)
        fleet.robot('bot').hold('door')
        fleet.run_for(2.0)
        fleet.robot('bot').release('door')
        fleet.run_for(10.0)
        fleet.robot('bot').cancel()
    return [entry for entry in fleet.trace if entry.kind == 'battery']


def test_thresholds_are_passed_at_the_first_nanosecond_at_which_the_formula_says_so():
    passed = errands(fleet_of(**THIRSTY))
    assert [entry.values for entry in passed] == [(0.9, 'below'), (0.5, 'below'), (0.31, 'below'), (0.0, 'empty')]
    again, found = fleet_of(**THIRSTY), []
    for entry in passed:
        for at_ns in (entry.time_ns - 1, entry.time_ns):
            again.at(at_ns, lambda fleet: found.append((fleet.now_ns, soc(fleet))))
    assert errands(again) == passed
    for entry, (before_ns, before), (at_ns, at) in zip(passed, found[::2], found[1::2]):
        assert (before_ns, at_ns) == (entry.time_ns - 1, entry.time_ns)
        assert at <= entry.values[0] < before


def test_who_stops_on_its_way_has_braked():
    fleet = fleet_of(mass=2.0)
    fleet.robot('bot').send(20.0, 0.0)
    for act in (fleet.robot('bot').hold, fleet.robot('bot').release):  # it has not moved
        act('door')
    assert soc(fleet) == 1.0
    fleet.run(3 * S)
    assert soc(fleet) == pytest.approx(1.0 - 1.0 / 360.0)
    for tool in (True, False):
        fleet.robot('bot').set_tool(tool)
    fleet.robot('bot').cancel()
    assert soc(fleet) == pytest.approx(1.0 - 2.0 / 360.0)


def test_empty_on_the_way_it_stands_there_and_refuses_goals():
    fleet = fleet_of(ambient_power=36.0, battery_thresholds=[0.2])  # 10 s
    fleet.robot('bot').send(20.0, 0.0)
    fleet.run(12 * S)
    fleet.robot('bot').send(1.0, 0.0)
    fleet.run(20 * S)
    assert rows(fleet, 'battery', 'stands', 'ended') == [
        (8.0, 'battery', 0.2, 'below'), (10.0, 'battery', 0.0, 'empty'), (10.0, 'stands', 10.0, 0.0, 0.0),
        (10.0, 'ended', 'bot-1', 'ABORTED', EMPTY), (12.0, 'ended', 'bot-2', 'ABORTED', EMPTY)]
    assert (fleet.robot('bot').condition.state_text, soc(fleet)) == ('battery empty', 0.0)


def test_an_idle_battery_runs_down_at_its_instants_but_no_run_waits_for_it():
    fleet = fleet_of(ambient_power=3.6)  # 100 s
    fleet.robot('bot').send(5.0, 0.0)
    fleet.run()
    assert fleet.now_ns == 5 * S
    fleet.run(1000 * S)
    assert rows(fleet, 'battery') == [(80.0, 'battery', 0.2, 'below'), (100.0, 'battery', 0.0, 'empty')]


def test_a_tool_takes_its_power_while_it_works_also_on_the_way():
    fleet = fleet_of(tool_power=18.0, mass=1.0, battery_thresholds=[])  # 20 s
    fleet.robot('bot').send(100.0, 0.0)
    fleet.run(4 * S)
    fleet.robot('bot').set_tool(True)
    fleet.run(14 * S)
    fleet.robot('bot').set_tool(False)
    assert soc(fleet) == pytest.approx(0.5 - 0.5 / 360.0)  # half a joule was for the speed
    fleet.run(40 * S)
    fleet.robot('bot').set_tool(True)
    fleet.run(60 * S)
    assert rows(fleet, 'battery') == [(pytest.approx(50.0 - 0.5 / 18.0, abs=1e-8), 'battery', 0.0, 'empty')]


# ---- charging

def test_who_stands_in_a_charger_is_charged_until_it_is_full():
    fleet = fleet_of([DOCK], charging_current=0.36, battery_start=0.1, start_x=10.0, mass=1.0)  # 3.6 W: 100 s for all
    fleet.robot('bot').send(0.5, 0.0)
    fleet.run(1000 * S)
    full = 9.5 + 90.0 + 1.0 / 3.6  # it took 1 J to be fast and to stand again
    assert rows(fleet, 'battery', 'charging_began') == [
        (9.5, 'charging_began', 'dock'), (pytest.approx(9.5 + 10.0 + 1.0 / 3.6), 'battery', 0.2, 'above'),
        (pytest.approx(full), 'battery', 1.0, 'full')]
    assert soc(fleet) == 1.0
    fleet.robot('bot').send(10.0, 0.0)
    fleet.run()
    assert rows(fleet, 'charging_ended') == [(1000.0, 'charging_ended', 'dock')]


def test_a_chargers_own_current_counts_and_who_drives_through_is_not_charged():
    fleet = fleet_of([dict(DOCK, charger=0.72)], battery_start=0.5, mass=1.0, start_x=5.0, battery_thresholds=[])
    fleet.robot('bot').send(-5.0, 0.0)
    fleet.run()
    assert rows(fleet, 'charging_began', 'battery') == []
    fleet.robot('bot').place(Pose2D())
    fleet.run_for(5.0)
    assert soc(fleet) == pytest.approx(0.5 - 1.0 / 360.0 + 0.1)


@pytest.mark.parametrize('charge', [lambda fleet: fleet.robot('bot').place(Pose2D()),
                                    lambda fleet: fleet.robot('bot').set_charge(0.5)])
def test_an_empty_robot_takes_goals_again_as_soon_as_there_is_charge(charge):
    fleet = fleet_of([DOCK], battery_start=0.0, start_x=5.0)
    fleet.run(S)
    charge(fleet)
    fleet.run(2 * S)
    fleet.robot('bot').send(3.0, 0.0)
    fleet.run()
    assert [entry.values[1] for entry in fleet.trace if entry.kind == 'ended'] == ['SUCCEEDED']
    assert soc(fleet) > 0.0


def test_a_robot_that_begins_in_a_charger_or_empty_is_so_from_the_beginning():
    fleet = fleet_of([DOCK], battery_start=0.0, charging_current=0.36)
    fleet.run(50 * S)
    assert rows(fleet, 'charging_began', 'battery') == [
        (0.0, 'charging_began', 'dock'), (1e-9, 'battery', 0.0, 'above'), (20.000000001, 'battery', 0.2, 'above')]


def test_a_reset_fills_the_battery_as_at_the_start():
    fleet = fleet_of(ambient_power=36.0, battery_start=0.5)
    fleet.robot('bot').send(20.0, 0.0)
    fleet.run(7 * S)
    assert fleet.robot('bot').condition.state_text == 'battery empty'
    fleet.reset()
    assert (soc(fleet), fleet.robot('bot').condition.state_text) == (0.5, '')
    fleet.robot('bot').send(2.0, 0.0)
    fleet.run(30 * S)
    assert rows(fleet, 'battery')[2:] == [(10.0, 'battery', 0.2, 'below'), (12.0, 'battery', 0.0, 'empty')]


def test_the_charge_can_be_set_and_what_it_passes_is_told():
    fleet = fleet_of(battery_thresholds=[0.6, 0.3])
    for share in (0.1, 0.5, 1.0, 0.0):
        fleet.robot('bot').set_charge(share)
    assert [row[2:] for row in rows(fleet, 'battery')] == [
        (0.1, 'set'), (0.6, 'below'), (0.3, 'below'), (0.5, 'set'), (0.3, 'above'), (1.0, 'set'), (0.6, 'above'),
        (0.0, 'set'), (0.6, 'below'), (0.3, 'below'), (0.0, 'empty')]
    with pytest.raises(ConfigurationError, match='state_of_charge: got 1.5; allowed: a number in 0..1'):
        fleet.robot('bot').set_charge(1.5)


def test_the_clock_starting_anew_changes_no_charge():
    fleet = fleet_of(ambient_power=3.6)
    fleet.run(30 * S)
    member = fleet.robot('bot')
    fleet.simulation.restart(5 * S)
    member.condition.restart(-25 * S)
    member.navigator.restart(30 * S, 5 * S)
    assert soc(fleet) == pytest.approx(0.7)
    fleet.run(200 * S)
    assert rows(fleet, 'battery') == [(pytest.approx(55.0), 'battery', 0.2, 'below'),
                                      (pytest.approx(75.0), 'battery', 0.0, 'empty')]


def test_work_at_a_place_draws_its_power_until_the_battery_is_empty():
    fleet = Fleet(make_scenario({
        'robots': [{'name': 'bot', 'battery_capacity': 0.01, 'nominal_voltage': 10.0, 'ambient_power': 0.0}],
        'places': [{'name': 'bench', 'x': 0.0, 'y': 0.0}]}), 0)
    states = []
    for name in 'abc':
        fleet.robot('bot').send_task(Task(name, 0, 'bench', Pose2D(), 50 * S, 4.5, 0.0))
        fleet.run_for(60.0)
        states.append(round(soc(fleet), 9))
    assert states == [0.375, 0.0, 0.0]
    assert [(entry.time_ns / S, entry.values[1]) for entry in fleet.trace if entry.kind == 'task_ended'] == [
        (50.0, 'SUCCEEDED'), (90.0, 'ABORTED'), (120.0, 'ABORTED')]


def test_a_charge_that_is_set_on_the_way_counts_from_there_on():
    fleet = fleet_of(ambient_power=3.6, mass=36.0)
    fleet.robot('bot').send(100.0, 0.0)
    fleet.run(10 * S)
    assert soc(fleet) == pytest.approx(1.0 - 0.05 - 0.1)
    fleet.robot('bot').set_charge(0.7)
    fleet.run(20 * S)
    assert soc(fleet) == pytest.approx(0.7 - 0.1)


# ---- settings

@pytest.mark.parametrize('wrong, text', [
    ({'battery_capacity': -1.0}, r'allowed: a number in 0..1e9 \[Ah\], 0 = no battery'),
    ({'nominal_voltage': 0.0}, r'allowed: a number > 0, <= 1e9 \[V\]'),
    ({'battery_start': 1.1}, 'battery_start: got 1.1'),
    ({'battery_thresholds': [0.2, 0.2]}, 'allowed: a list of different numbers > 0, < 1'),
    ({'battery_thresholds': [1.0]}, 'battery_thresholds'), ({'battery_thresholds': 0.2}, 'battery_thresholds')])
def test_what_is_not_allowed_is_an_error_that_says_what_is(wrong, text):
    with pytest.raises(ConfigurationError, match=text):
        read_settings(wrong, 'x')


@pytest.mark.parametrize('value', ['yes', 0.0, -1.0, [1.0]])
def test_a_charger_is_true_or_a_current(value):
    with pytest.raises(ConfigurationError, match=r'charger: got .*; allowed: true, or a number > 0, <= 1e9 \[A\]'):
        fleet_of([dict(DOCK, charger=value)])


def test_without_a_capacity_nothing_is_made_and_the_log_is_the_same():
    def drive(**settings):
        fleet = Fleet(make_scenario({'robots': [{'name': 'bot', **settings}], 'zones': [DOCK]}), 0)
        fleet.robot('bot').send(7.0, 3.0)
        fleet.run()
        return fleet
    plain, full = drive(mass=9.0), drive(battery_capacity=1000.0, battery_thresholds=[])
    assert plain.robot('bot').condition.battery is None
    assert plain.trace == drive().trace != []
    assert [entry for entry in full.trace if not entry.kind.startswith('charging')] == plain.trace


@pytest.mark.parametrize('extreme', [
    {'charging_current': 5e-324}, {'battery_capacity': 5e-324, 'nominal_voltage': 1e-9}, {'ambient_power': 5e-324}])
@pytest.mark.parametrize('start', [0.0, 0.2, 1.0])
def test_numbers_that_are_almost_nothing_are_taken(extreme, start):
    fleet = fleet_of([DOCK], battery_start=start, **extreme)
    fleet.run_for(10.0)
    fleet.robot('bot').send(5.0, 0.0)
    fleet.run_for(10.0)
    assert 0.0 <= soc(fleet) <= 1.0


def test_a_robot_that_runs_empty_is_in_the_warnings_and_in_the_report_with_where_and_why(tmp_path, capsys):
    spot = {'x': 30.0, 'duration': 1000.0, 'capacity': 1}
    fleet = Fleet(make_scenario({
        'defaults': {'max_speed': 1.0, 'battery_capacity': 0.01, 'nominal_voltage': 10.0, 'ambient_power': 3.6,
                     'mass': 1e-12},  # 100 s
        'robots': [{'name': name, 'start_x': x, 'start_y': y} for name, x, y in (
            ('drives', 0.0, 0.0), ('waits', 10.0, 0.0), ('digs', 30.0, 0.0), ('queues', 30.0, 0.0),
            ('idle', 0.0, 9.0))] + [{'name': 'full', 'battery_capacity': 1.0},
                                    {'name': 'blocks', 'start_x': 15.0, 'battery_capacity': 0.0}],
        'places': [{'name': 'spot', **spot}],
        'zones': [{'name': 'gate', 'rectangle': [12.0, -2.0, 18.0, 2.0], 'capacity': 1}]}), start_ns=0)
    fleet.robot('drives').send(-300.0, 0.0, goal_id='far')
    fleet.robot('waits').send(20.0, 0.0, goal_id='through')
    fleet.robot('digs').send_task(Task('w', 0, 'spot', Pose2D(30.0, 0.0)))
    fleet.robot('queues').send_task(Task('q', 0, 'spot', Pose2D(30.0, 0.0)))
    fleet.run(200 * S)
    assert [(one.robot, one.goal_id, one.text) for one in fleet.warnings] == [
        (name, goal, 'The battery is empty at ({}, {}); the robot was {}.'.format(x, y, doing))
        for name, goal, x, y, doing in (
            ('drives', 'far', '-100', '0', 'on its way to (-300, 0)'),
            ('waits', 'through', '12', '0', 'held on its way for zone gate'),
            ('digs', '', '30', '0', 'working at place spot'),
            ('queues', '', '30', '0', 'waiting for room at place spot'),
            ('idle', '', '0', '9', 'without anything to do'))]
    assert {one.time_ns for one in fleet.warnings} == {100 * S}
    fleet.write_log(tmp_path / 'run.jsonl')
    fleet_report.main([str(tmp_path / 'run.jsonl')])
    assert [line for line in capsys.readouterr().out.splitlines() if line.startswith('ran empty')] == [
        'ran empty: {} at 100.0 s, {}'.format(*one) for one in (
            ('drives', 'at (-100.00, 0.00), driving'),
            ('waits', 'at (12.00, 0.00), waiting for zone gate since 2.0 s'),
            ('digs', 'working at place spot since 0.0 s'),
            ('queues', 'waiting for place spot since 0.0 s'), ('idle', 'idle'))]
