"""What all readers of a log tell of a run, held to what its raw rows say, looked at in another way, and to one another.

The Story takes row after row; here each span between two instants is judged by the last rows before it.
"""
import json
import math
import random

import pytest

from move_base_abstract.fleet import Dispatch, Fleet
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.orders.order import Order, Stop
from move_base_abstract.properties.judgement import Run, judge
from move_base_abstract.runs.states import NAMES, STATES
from move_base_abstract.runs.story import Story
from move_base_abstract.scenario import make_scenario
from move_base_abstract.tasks.arrivals import Task
from move_base_abstract_experiments.fleet_report import json_text, lines_of, main, story_of
from move_base_abstract_experiments.trials import metrics
from move_base_abstract_replay import page_data
from move_base_abstract_replay.recording import read_recording

S = 1_000_000_000
SEEN = ('driving', 'working', 'waiting', 'charging', 'idle', 'failed')  # the states in which robots of the world are


def world(seed, **more):
    """Return a scenario in which robots fail, charge, give way and wait, with orders that come late."""
    return make_scenario({
        'seed': seed, 'defaults': {
            'max_speed': 1.0, 'battery_capacity': 0.4, 'charging_current': 3.0, 'failure_kind': 'stall',
            'failures_per_km': 4.0, 'repair_time': 25.0, 'log_motion': True},
        'robots': [{'name': 'robot', 'count': 4, 'step_x': 2.0}],
        'zones': [{'name': 'dock', 'rectangle': [-4.0, -4.0, -2.0, -2.0], 'charger': True, 'capacity': 1},
                  {'name': 'door', 'rectangle': [3.0, 4.0, 8.0, 6.0], 'capacity': 1}],
        'places': [{'name': 'shelf', 'x': 6.0, 'y': 8.0, 'duration': 5.0},
                   {'name': 'gate', 'y': 9.0, 'duration': 6.0, 'capacity': 1, 'queue': 2}],
        'orders': [{'name': 'picks', 'rate_per_hour': 260.0, 'count': 30, 'deadline': 90.0,
                    'stops': [{'place': 'shelf', 'action': 'load'}, {'place': 'gate', 'action': 'unload'}]}],
        'dispatcher': {'charge_below': 0.5, 'charge_until': 0.8}, **more})


def log_of(path, seed=1, until=None, **more):
    """Write the log of a run; return its rows, [(time_ns, robot, kind, values), ...], as the file has them."""
    dispatch = Dispatch(world(seed, **more))
    dispatch.order(Order('wrong', 0, (Stop(Pose2D(), 'nowhere'),)))
    dispatch.run(until=until)
    dispatch.fleet.write_log(str(path))
    return rows_of(path)


def rows_of(path):
    found = []
    for line in path.read_text().splitlines():
        try:
            row = json.loads(line)
        except ValueError:  # cut off
            continue
        if 'kind' in row:
            found.append((row['time_ns'], row['robot'], row['kind'], row['values']))
    return found


def end_of(path):
    """Return when the run was over [ns], as its last record says."""
    last = json.loads(path.read_text().splitlines()[-1])
    return last['end']['at_ns']


def last_of(rows, *kinds):
    """Return the kind of the last row of these kinds."""
    return next((kind for _, _, kind, _ in reversed(rows) if kind in kinds), None)


def state_after(rows):
    """Return what a robot does when these are all of its rows so far."""
    if last_of(rows, 'failed', 'repaired') == 'failed':
        return 'failed'
    if last_of(rows, 'departed', 'stands') == 'departed':
        return 'driving'
    if last_of(rows, 'waiting_began', 'task_began', 'task_ended') == 'task_began':
        return 'working'
    if ({values[0] for *_, kind, values in rows if kind == 'goal'}
            - {values[0] for *_, kind, values in rows if kind == 'ended'}
            or last_of(rows, 'waiting_began', 'waiting_ended', 'task_began', 'task_ended') == 'waiting_began'
            or last_of(rows, 'charge_awaited', 'charge_assigned') == 'charge_awaited'):
        return 'waiting'
    return 'charging' if last_of(rows, 'charging_began', 'charging_ended') == 'charging_began' else 'idle'


def shares(rows, name, begin_ns, end_ns):
    """Return {state: s} of a robot."""
    found = dict.fromkeys(NAMES, 0)
    own = [row for row in rows if row[1] == name]
    instants = sorted({begin_ns, end_ns, *(row[0] for row in own)})
    for one, other in zip(instants, instants[1:]):
        found[state_after([row for row in own if row[0] <= one])] += other - one
    return {state: ns / S for state, ns in found.items()}


def waits_of(rows, end_ns):
    """Return {where: [s, ...]}: for each row at which somebody begins to wait, how long until one that ends it."""
    areas, found = {values[0] for _, _, kind, values in rows if kind in ('entered', 'places')}, {}

    def reasons(row):
        return [part for reason in row[3] for part in reason.split(', ')]

    def add(where, begin_ns, over_ns):
        if over_ns > begin_ns:
            found.setdefault(where, []).append((over_ns - begin_ns) / S)
    for number, (begin_ns, name, kind, values) in enumerate(rows):
        behind = [row for row in rows[number + 1:] if row[1] == name]
        before = [row for row in rows[:number] if row[1] == name]
        if kind == 'held':
            held = [row for row in before if row[2] in ('held', 'released')]
            for where in set(reasons(rows[number])) & areas - set(reasons(held[-1]) if held else ()):
                add(where, begin_ns, next((row[0] for row in behind if row[2] in ('held', 'released')
                                           and where not in reasons(row)), end_ns))
        elif kind == 'waiting_began':
            add('place ' + values[1], begin_ns,
                next((row[0] for row in behind if row[2] == 'waiting_ended' and row[3][0] == values[0]), end_ns))
        elif kind == 'charge_awaited' and last_of(before, 'charge_awaited', 'charge_assigned') != 'charge_awaited':
            add('chargers', begin_ns, next((row[0] for row in behind if row[2] == 'charge_assigned'), end_ns))
    return found


def orders_of(rows):
    """Return {order: {'arrived': ns, ...}} of those that arrived."""
    found = {}
    for time_ns, _, kind, values in rows:
        if kind == 'order_arrived':
            found[values[0]] = {'arrived': time_ns, 'deadline': values[2] or None}
        elif kind in ('order_assigned', 'order_done') and kind not in found[values[0]]:
            found[values[0]].update({kind: time_ns, 'code': values[1]})
    return found


def check(path, rows, begin_ns, end_ns):
    """Compare all figures of the report on a log with what the rows say."""
    story, _ = story_of(str(path))
    assert story.seconds == (end_ns - begin_ns) / S
    names = sorted({row[1] for row in rows if not row[1].startswith('/')})
    assert sorted(story.figures) == names
    for name, figures in story.figures.items():
        assert {state: figures[state] for state in NAMES} == pytest.approx(shares(rows, name, begin_ns, end_ns))
        own = [row for row in rows if row[1] == name]
        assert figures['failures'] == sum(row[2] == 'failed' for row in own)
        assert figures['charges'] == sum(row[2] == 'charging_began' for row in own)
        assert figures['orders'] == sum(row[2] == 'order_done' and row[3][1] != 'failed' for row in own)
        charges = [row[3] for row in own if row[2] == 'charge']
        for what, sign in (('used', -1), ('charged', 1)):
            joules = [sign * (now[0] - before[0]) * now[1] for before, now in zip(charges, charges[1:])
                      if now[2] == what]
            assert figures['energy_' + what] == pytest.approx(math.fsum(joules) / 3.6e6)
    waits = waits_of(rows, end_ns)
    assert {where: (one.count, one.total_ns / S, one.longest_ns / S) for where, one in story.waits.items()} == {
        where: (len(spans), pytest.approx(math.fsum(spans)), max(spans)) for where, spans in waits.items()}
    orders = orders_of(rows)
    over = [one for one in orders.values() if 'order_done' in one]
    done = [one for one in over if one['code'] != 'failed']
    late = [max(0, one['order_done'] - one['deadline']) / S for one in done if one['deadline']]
    assert story.orders.times == (
        len(orders), len(done), sum(one['order_done'] > (one['deadline'] or end_ns) for one in done),
        len(over) - len(done), len(orders) - len(over), sum(row[2] == 'order_returned' for row in rows),
        [(one['order_done'] - one['arrived']) / S for one in done],
        [(one['order_assigned'] - one['arrived']) / S for one in done], late,
        sum(row[2] == 'order_refused' for row in rows))
    assert list(story.orders.undone) == [name for name, one in orders.items() if 'order_done' not in one]
    return story


@pytest.mark.parametrize('seed', range(1, 5))
def test_all_figures_are_those_of_the_raw_rows(tmp_path, seed):
    rows = log_of(tmp_path / 'run.jsonl', seed)
    story = check(tmp_path / 'run.jsonl', rows, S, end_of(tmp_path / 'run.jsonl'))
    assert {'door', 'dock', 'place gate'} & set(story.waits)
    assert all(sum(one[state] for one in story.figures.values()) > 0 for state in SEEN)


def test_a_run_that_is_stopped_leaves_orders_open_and_says_with_whom(tmp_path, capsys):
    path = tmp_path / 'run.jsonl'
    rows = log_of(path, 2, until=200.0)
    story = check(path, rows, S, 200 * S)
    assert story.orders.undone
    for name, text in story.orders.undone.items():
        last = [row for row in rows if row[2].startswith('order_') and row[3][0] == name][-1]
        assert text.startswith({'order_arrived': 'no robot', 'order_returned': 'came back from ' + last[1]}.get(
            last[2], 'with ' + last[1]))
    main([str(path)])
    out = capsys.readouterr().out
    assert '1 more were refused' in out
    assert all('open: {}, {}'.format(*one) in out for one in story.orders.undone.items())
    assert json.loads(json_text(story, []))['undone'] == story.orders.undone


@pytest.mark.parametrize('share', [0.1, 0.37, 0.8])
def test_a_log_that_is_cut_off_counts_up_to_its_last_row(tmp_path, share):
    path = tmp_path / 'run.jsonl'
    log_of(path, 3)
    text = path.read_text()
    path.write_text(text[:int(share * len(text))])
    rows = rows_of(path)
    check(path, rows, S, max(row[0] for row in rows))


def test_robots_that_never_move_are_idle_all_the_time(tmp_path):
    rows = log_of(tmp_path / 'run.jsonl', until=50.0, orders=[])
    story = check(tmp_path / 'run.jsonl', rows, S, 50 * S)
    assert [one['idle'] for one in story.figures.values()] == [49.0] * 4
    assert lines_of(story, [], 'log')[0] == 'log: 4 robots, 49.0 s'


def test_robots_of_which_no_row_tells_count_among_those_of_a_dispatcher():
    dispatch = Dispatch(make_scenario({'robots': [{'name': 'r', 'count': 4, 'step_x': 9.0}], 'places': []}))
    dispatch.order(Order('a', 0, (Stop(Pose2D(0.0, 5.0)),)))
    dispatch.run()
    assert {entry.robot for entry in dispatch.fleet.trace} == {'r_0', '/dispatcher'}
    assert dispatch.metrics()['share_driving'] == 25.0


def test_a_wait_of_no_length_is_none_also_at_the_end():
    story = Story(0)
    for row in ((0, 'r', 'places', ['door', 1]), (S, 'r', 'held', ['door']), (S, 'r', 'released', []),
                (2 * S, 'r', 'held', ['door'])):
        story.take(*row)
    story.close(2 * S)
    assert story.waits == {}


def charging_on_the_way(path):
    """Write the log of a robot that is held by a zone for 56 s while it stands at a charger; return its rows."""
    fleet = Fleet(make_scenario({
        'defaults': {'max_speed': 1.0}, 'robots': [
            {'name': 'a', 'start_x': 1.0, 'battery_capacity': 5.0, 'battery_start': 0.5},
            {'name': 'b', 'start_x': 10.0}],
        'zones': [{'name': 'dock', 'rectangle': [0.0, -2.0, 8.5, 2.0], 'charger': 5.0},
                  {'name': 'gate', 'rectangle': [8.0, -2.0, 12.0, 2.0], 'capacity': 1}]}))
    fleet.robot('a').send(20.0, 0.0)
    fleet.at(62 * S, lambda fleet: fleet.robot('b').send(10.0, 30.0))
    fleet.run(until=122.0)
    fleet.write_log(path)
    return rows_of(path)


def told_by_all(path):
    """Return {reader: {robot: {state: s}}} of all that tell of the times of robots."""
    story, _ = story_of(str(path))
    summary = metrics.summarise(str(path))
    recording = read_recording(path)
    page = {}
    for line in page_data.Run(recording).timelines:
        if line.is_robot:
            own = page[line.name] = dict.fromkeys(NAMES, 0.0)
            for span in line.spans:
                own[NAMES[span.state]] += (span.end_ns - span.begin_ns) / S
            own['idle'] += (recording.end_ns - recording.begin_ns) / S - math.fsum(own.values())
    return {'report': {name: {state: one[state] for state in NAMES} for name, one in story.figures.items()},
            'metrics': {name: {state.name: one.get(state.key, 0.0) for state in STATES}
                        for name, one in summary.robots.items()},
            'page': page}


def test_a_robot_that_is_charged_while_it_is_kept_from_its_goal_waits_for_all_readers(tmp_path):
    rows = charging_on_the_way(tmp_path / 'run.jsonl')
    assert last_of([row for row in rows if row[1] == 'a'], 'charging_began') == 'charging_began'
    for reader, told in told_by_all(tmp_path / 'run.jsonl').items():
        assert (round(told['a']['waiting']), told['a']['charging']) == (56, 0.0), reader


def test_a_robot_that_is_held_when_its_goal_comes_waits(tmp_path):
    fleet = Fleet(make_scenario({'robots': [{'name': 'a', 'log_motion': True}]}))
    fleet.robot('a').hold('door')
    fleet.at(11 * S, lambda fleet: fleet.robot('a').send(20.0, 0.0))
    fleet.run(until=101.0)
    fleet.write_log(tmp_path / 'run.jsonl')
    assert fleet.trace[-1].kind == 'goal'
    story, _ = story_of(str(tmp_path / 'run.jsonl'))
    assert [tuple(span) for span in story.spans('a')] == []  # a report keeps sums only
    assert {state: one for state, one in story.figures['a'].items() if one} == {'idle': 10.0, 'waiting': 90.0}


def test_in_a_log_of_an_earlier_release_a_goal_begins_with_its_departure(tmp_path):
    rows = charging_on_the_way(tmp_path / 'run.jsonl')
    figures = []
    for without in ((), ('goal',)):
        story = Story(S)
        for row in rows:
            if row[2] not in without:
                story.take(*row)
        story.close(122 * S)
        figures.append(story.figures)
    assert figures[0] == figures[1]


@pytest.mark.parametrize('names', [('x', 'y'), ('', '')])
def test_of_two_tasks_at_once_the_first_end_ends_one(names):
    def values(name):
        return [name, S] if name else []
    story = Story(0, keeps_spans=True)
    for time, kind, name in ((1, 'task_began', names[0]), (2, 'task_began', names[1]), (3, 'task_ended', names[0]),
                             (7, 'task_ended', names[1])):
        story.take(time * S, 'r/dig' if time > 1 else 'r', kind, values(name))
    story.close(9 * S)
    assert [(span.begin_ns // S, span.end_ns // S, NAMES[span.state]) for span in story.spans('r')] == [
        (0, 1, 'idle'), (1, 7, 'working'), (7, 9, 'idle')]


def random_run(path, seed):
    """Write the log of a random fleet; return {(instant [ns], robot): what the fleet itself says that it does}."""
    draw = random.Random(seed)
    fleet = Fleet(make_scenario({
        'seed': seed, 'deadlock': draw.choice(['wait', 'avoid', 'retreat']),
        'defaults': {'max_speed': 1.5, 'acceleration': draw.choice([0.5, 1.0]), 'log_motion': True,
                     'battery_capacity': 0.6, 'battery_start': 0.7, 'failures_per_km': draw.choice([0.0, 8.0]),
                     'failure_kind': draw.choice(['stall', 'abort', 'silent', 'stuck']), 'repair_time': 20.0},
        'robots': [{'name': 'r', 'count': 4, 'step_x': 2.0}],
        'zones': [{'name': 'dock', 'rectangle': [-1.0, -1.0, 5.0, 3.0], 'charger': True},
                  {'name': 'gate', 'rectangle': [8.0, -9.0, 12.0, 9.0], 'capacity': 1}],
        'places': [{'name': 'bench', 'x': 20.0, 'y': 0.0, 'capacity': 1, 'duration': 9.0}]}))
    now = 1.0
    for _ in range(60):
        now += draw.uniform(0.0, 4.0)
        fleet.at(round(now * S), _deed(draw, fleet.robot('r_{}'.format(draw.randrange(4)))))
    told = {}
    for _ in range(40):
        fleet.run_for(draw.uniform(0.5, 6.0))
        told.update({(fleet.now_ns, name): _doing(fleet.robot(name)) for name in fleet.names})
    fleet.write_log(path)
    return told


def _doing(robot):
    """Return the state of a robot as the live objects say it, or None if they say something else."""
    words = robot.activity.split(',')[0].split(':')[0]
    if words == 'held':
        works = robot._tasks is not None and robot._tasks.is_working
        return 'waiting' if robot.navigator.is_active and not works else None
    return None if words == 'battery empty' else words


def _deed(draw, robot):
    """Return what is done to a robot, at random."""
    x, y = draw.choice([0.0, 3.0, 20.0]), draw.uniform(-3.0, 3.0)
    return draw.choice([
        lambda _: robot.send(x, y), lambda _: robot.send(x, y), lambda _: robot.cancel(), lambda _: robot.hold('door'),
        lambda _: robot.release('door'), lambda _: robot.release('door'), lambda _: robot.place(Pose2D(20.0, 0.0)),
        lambda _: robot.send_task(Task('t', 0, 'bench', Pose2D(20.0, 0.0)))])


@pytest.mark.parametrize('seed', range(50))
def test_all_readers_tell_the_same_of_random_runs_as_the_fleet_itself(tmp_path, seed):
    path = tmp_path / 'run.jsonl'
    told = random_run(path, seed)
    rows, end_ns = rows_of(path), end_of(path)
    readers = told_by_all(path)
    for name, times in readers['report'].items():
        assert times == pytest.approx(shares(rows, name, S, end_ns))
        assert readers['metrics'][name] == pytest.approx(times)
        left = (end_ns - max(row[0] for row in rows)) / S  # the page ends with the last event
        assert {state: readers['page'][name][state] for state in NAMES} == pytest.approx(times, abs=left + 1e-6)
    story = page_data.story_of(read_recording(path))
    for (now_ns, name), state in told.items():
        span = next((one for one in story.spans(name) if one.begin_ns < now_ns < one.end_ns), None)
        if span is not None and state is not None:
            assert NAMES[span.state] == state, (now_ns / S, name)
    open_goals = {name for name, robot in story.robots.items() if robot.begun('goal') is not None}
    end = json.loads(path.read_text().splitlines()[-1])['end']
    assert open_goals == {one['action'].split('/')[0] for one in end.get('open_goals', [])}
    broken = {one.node for one in judge(Run(str(path))) if one.property == 'charged'}
    assert broken == {one.robot for one in story.emptied}


def test_a_clock_that_starts_anew_takes_no_time_back():
    story = Story(0, keeps_spans=True)
    for time, kind in ((1, 'departed'), (9, 'stands'), (2, 'departed'), (5, 'stands')):
        story.take(time * S, 'r', kind, [0.0, 0.0, 0.0])
    story.close()
    assert story.figures['r']['driving'] == 8.0 + 3.0
    assert all(span.begin_ns < span.end_ns for span in story.spans('r')) and min(story.figures['r'].values()) >= 0.0
