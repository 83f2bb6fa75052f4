"""A replay in Chromium: the actions of a person, and that its legs are those of the simulator."""
import json
import math
from pathlib import Path

import pytest
from replay_test_pages import many_legs, page, small_run

from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.motion.pieces import Piece
from move_base_abstract.runs import debug_command, run_file

S = 1_000_000_000
ROOT = Path(__file__).resolve().parents[2]
MAP = ROOT / 'maps' / 'farm_yard.yaml'
TABLE = ROOT / 'test' / 'data' / 'pieces.json'
TIME = 'return window.replay.time'
#: script for the (x, y, yaw) of a robot of a run in the page
POSE = ('const p = window.replay.runs[arguments[0]].poseAt(arguments[1], window.replay.time); '
        'return [p.x, p.y, p.yaw]')
#: script that keeps the trail and the way that are drawn of a robot, as [[x, y], ...] in m and without repeated points
DOTTED_AND_TRAIL = """
    window.lines = {};
    const robots = window.replay.maps[0].robots, {view} = robots;
    for (const [name, draw] of [['trail', 'drawTrail'], ['way', 'drawWay']]) {
      robots[draw] = function (context, ...given) {
        const points = [], add = (x, y) => {
          const {x: east, y: north, scale} = view.camera, {clientWidth: w, clientHeight: h} = view.figure;
          const at = [Math.round(east + (x - w / 2) / scale), Math.round(north - (y - h / 2) / scale)];
          if (`${at}` !== `${points[points.length - 1]}`) points.push(at);
        };
        const spy = new Proxy({}, {set: () => true, get: (_, key) => (/To$/.test(key) ? add : () => {})});
        Object.getPrototypeOf(robots)[draw].call(this, spy, ...given);
        window.lines[name] = points;
      };
    }"""
#: script for the debugger's command, '' if it is not shown
COMMAND = """const [command] = document.querySelectorAll('.debug:not([hidden]) input');
              return command ? command.value : ''"""
CURRENT = "return document.querySelector('.event.current:not([hidden])').textContent"


@pytest.fixture(scope='module')
def pages(tmp_path_factory):
    """Return (a folder for pages, the page of a small run)."""
    folder = tmp_path_factory.mktemp('replay')
    return folder, page(folder, 'small', small_run(), map_file=MAP)


def test_poses_are_those_of_the_table_for_all_languages(browser, pages):
    browser.open(pages[1])
    for case in json.loads(TABLE.read_text())['cases']:
        columns = dict(zip((f'piece_{name}' for name in Piece._fields), zip(*case['pieces'])))
        rows = [row for row in case['asked'] if row[0] < 2 ** 53]
        found = browser.run("""
            const run = Object.assign(Object.create(window.replay.runs[0]), arguments[0]);
            run.piece_first = [0, run.piece_x.length];
            return arguments[1].map(([time]) => {
              const {x, y, yaw} = run.poseIn(run.pieceAt(0, time), time);
              return [x, y, yaw];
            });""", columns, rows)
        for (x, y, yaw), expected in zip(found, rows):
            assert (x, y) == pytest.approx(expected[1:3], abs=1e-9), case['motion']
            assert abs(math.remainder(yaw - expected[3], 2.0 * math.pi)) < 1e-9, case['motion']


def test_it_plays_pauses_and_goes_where_the_slider_the_events_and_the_keys_say(browser, pages):
    from selenium.webdriver.common.keys import Keys
    browser.open(pages[1])
    assert browser.run(TIME) == S
    browser.click('#play')
    browser.wait('return window.replay.time > 2e9')
    browser.click('#play')
    stopped = browser.run(TIME)
    browser.frame()
    assert browser.run(TIME) == stopped
    slider = browser.driver.find_element('css selector', '#slider')
    slider.click()  # its middle
    middle = browser.run('return (window.replay.begin + window.replay.end) / 2')
    assert browser.run(TIME) == pytest.approx(middle, rel=0.02)
    browser.run('window.replay.seek(0); window.replay.seek(60e9)')
    assert browser.run(CURRENT).endswith('drives in 6 pieces')
    browser.press(',')
    assert '60.000' in browser.run(CURRENT) and 'departs for (4.00, 4.00) m' in browser.run(CURRENT)
    browser.press(',')
    assert browser.run(CURRENT).endswith('gets the goal robot_0-2')
    browser.press(',')
    before = browser.run(TIME)
    assert before < 60 * S and browser.run(CURRENT).endswith('robot_1-2')
    browser.press('.', Keys.END)
    assert browser.run(TIME) == browser.run('return window.replay.end')
    browser.press(Keys.HOME, ' ')
    browser.wait('return window.replay.time > window.replay.begin')
    browser.press(' ')
    assert not browser.run('return window.replay.isPlaying')


def test_a_click_on_an_event_goes_to_its_instant_where_robots_are_as_the_log_says(browser, pages):
    browser.open(pages[1])
    browser.run("const s = window.replay.events.search; s.value = 'robot_1'; s.dispatchEvent(new Event('input'))")
    browser.wait("return document.querySelector('.count').textContent.includes(' of ')")
    lines = browser.driver.find_elements('css selector', '.event:not([hidden])')
    [stopped] = [line for line in lines if line.get_attribute('data-kind') == 'stands'][:1]
    stopped.click()
    assert browser.run(TIME) == 10 * S
    logged = [entry for entry in small_run() if entry.kind == 'stands' and entry.robot == 'robot_1'][0]
    assert browser.run(POSE, 0, 1) == pytest.approx(logged.values, abs=1e-9)
    assert browser.run('return window.replay.runs[0].poseAt(1, 9e9).y') < logged.values[1]


def test_it_fits_a_phone_and_a_dark_room(browser, pages):
    browser.open(pages[1], 400, 800, dark=True)
    browser.frame()
    assert browser.run('return document.documentElement.scrollWidth') <= 400
    assert browser.run('return getComputedStyle(document.body).backgroundColor') == 'rgb(17, 21, 23)'
    wall = browser.run("return document.querySelector('.map canvas').getContext('2d') !== null")
    assert wall


def test_the_way_of_a_leg_has_its_corners_and_its_trail_ends_where_it_was_cut_short(browser, pages):
    pieces = [[S, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0], [9 * S, 8.0, 0.0, 1.5, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0],
              [15 * S, 8.0, 6.0, 1.5, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0]]
    entries = [(S, 'r', 'departed', (8.0, 6.0, 0.0)), (S, 'r', 'pieces', pieces),
               (11 * S, 'r', 'stands', (8.0, 2.0, 1.5)),
               (12 * S, 'r', 'departed', (0.0, 2.0, 0.0)), (20 * S, 'r', 'stands', (0.0, 2.0, 3.14))]
    browser.open(page(pages[0], 'corners', entries))
    browser.run(DOTTED_AND_TRAIL)
    drawn = {}
    for seconds in (4, 14):
        browser.run('window.lines = {}; window.replay.seek(arguments[0] * 1e9)', seconds)
        browser.wait('return window.lines.trail')
        drawn[seconds] = browser.run('return window.lines')
    assert drawn[4] == {'trail': [[0, 0], [3, 0]], 'way': [[3, 0], [8, 0], [8, 6]]}
    assert drawn[14] == {'trail': [[0, 0], [8, 0], [8, 2], [6, 2]], 'way': [[6, 2], [0, 2]]}


def test_arcs_of_a_robot_that_is_driven_by_velocities_are_drawn_round_and_it_has_no_way(browser, pages):
    first, turned = [S, 10.0, 0.0, 0.5 * math.pi, 0.0, 1.0, 1.0, 0.0, 0.1, -1.0], 1.5 + 0.5 * math.pi
    there = 10.0 * math.cos(1.5), 10.0 * math.sin(1.5)
    second = [16 * S, *there, turned, math.cos(turned), math.sin(turned), 1.0, 0.0, 0.0, -1.0]
    end = there[0] + 10.0 * math.cos(turned), there[1] + 10.0 * math.sin(turned)
    rest = [60 * S, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    entries = [(S, 'r', 'driven', (10.0, 0.0, 1.57, 1.0, 0.0, 0.1)), (S, 'r', 'pieces', [first, rest]),
               (16 * S, 'r', 'driven', (*there, turned, 1.0, 0.0, 0.0)), (16 * S, 'r', 'pieces', [second, rest]),
               (26 * S, 'r', 'stands', (*end, turned))]
    browser.open(page(pages[0], 'arcs', entries))
    browser.run(DOTTED_AND_TRAIL)
    browser.run('window.lines = {}; window.replay.seek(24e9)')
    browser.wait('return window.lines.trail')
    lines = browser.run('return window.lines')
    arc = [point for point in lines['trail'] if point[0] > 0 and math.hypot(*point) < 10.8]
    assert not lines['way'] and len(arc) >= 10
    assert all(abs(math.hypot(*point) - 10.0) < 0.8 for point in arc)
    assert lines['trail'][-1] == [round(there[0] + 8.0 * math.cos(turned)), round(there[1] + 8.0 * math.sin(turned))]
    assert 'drives with 1.00 m/s, turns with 0.00 rad/s' in browser.run('return document.body.textContent')


def test_links_of_the_radio_are_drawn_while_they_are_up(browser, pages):
    rows = [(S, '', 'link', ('base', 'robot_0', 'up')), (S, '', 'link', ('base', 'robot_1', 'up')),
            (S, '', 'link', ('robot_0', 'robot_1', 'down')), (S, 'base', 'host', (20.0, 20.0)),
            (20 * S, '', 'link', ('base', 'robot_1', 'down'))]
    entries = sorted([*rows, *small_run()], key=lambda entry: entry[0])
    browser.open(page(pages[0], 'links', entries, map_file=MAP))
    # Keep the dotted lines that the page draws, as [[x, y] of both ends] [px].
    browser.run("""
        window.drawn = [];
        const P = CanvasRenderingContext2D.prototype, {setLineDash, moveTo, lineTo} = P;
        let dashed = false, from = null;
        P.setLineDash = function (dash) { dashed = dash[0] === 2; setLineDash.call(this, dash); };
        P.moveTo = function (x, y) { from = [x, y]; moveTo.call(this, x, y); };
        P.lineTo = function (x, y) { if (dashed) window.drawn.push([from, [x, y]]); lineTo.call(this, x, y); };""")
    for time_ns, expected in ((15 * S, [0, 1]), (30 * S, [0])):
        browser.run('window.drawn = []; window.replay.seek(arguments[0])', time_ns)
        browser.wait('return window.drawn.length > 0')
        browser.frame()
        drawn = browser.run('return window.drawn')
        robots = browser.run("""return arguments[0].map((robot) => {
            const pose = window.replay.runs[0].poseAt(robot, window.replay.time);
            return [pose.x - 20, pose.y - 20];})""", expected)
        base, end = drawn[0]
        scale = (end[0] - base[0]) / robots[0][0]  # px/m
        assert scale > 0
        for number, (begin, end) in enumerate(drawn):  # each frame draws all of them
            x, y = robots[number % len(robots)]
            assert begin == base
            assert (end[0] - base[0], base[1] - end[1]) == pytest.approx((x * scale, y * scale), abs=0.01)
        assert len(drawn) % len(robots) == 0
        assert browser.run('return window.replay.runs[0].hosts.map(({name}) => name)') == ['base']


def test_two_runs_stand_side_by_side_and_a_button_shows_the_first_difference(browser, pages):
    browser.open(page(pages[0], 'two', small_run(), small_run((30.0, 4.0))))
    browser.click('#jump')
    assert browser.run(TIME) == 60 * S
    assert 'departs for (4.00, 4.00) m' in browser.run(CURRENT)
    browser.click('[data-list="1"]')
    browser.press(',')
    assert 'departs for (30.00, 4.00) m' in browser.run(CURRENT)
    browser.run('window.replay.seek(window.replay.end)')
    assert [browser.run(POSE, run, 0)[:2] for run in (0, 1)] == [pytest.approx((4.0, 4.0)), pytest.approx((30.0, 4.0))]
    assert len(browser.driver.find_elements('css selector', '.map canvas')) == 2


def test_debug_here_copies_the_command_to_before_the_present_event(browser, pages):
    from selenium.webdriver.common.keys import Keys
    log, other = (pages[0] / 'debug_{}.jsonl'.format(number) for number in range(2))
    run_file.write(str(log), run_file.of_run(['system.launch'], '/here', {}, ()))
    browser.open(page(pages[0], 'debug', small_run(), small_run()))
    begin = 'rosrun move_base_abstract debug --log {}'.format(log)
    assert browser.run(COMMAND) == begin  # at the start
    for time in (12.25, 10, 60):
        browser.run('window.replay.seek(arguments[0] * 1e9)', time)
        where = ' --at 12.25' if time == 12.25 else debug_command.of_instant(str(log), time * S)[len(begin):]
        assert browser.run(COMMAND) == begin + where and where
    assert where.startswith(' --row ')
    browser.run("document.addEventListener('copy', (event) => { "
                "const {value, selectionStart, selectionEnd} = event.target; "
                "window.copied = value.slice(selectionStart, selectionEnd); })")
    browser.click('.debug button')
    assert browser.run('return window.copied') == begin + where
    assert browser.run("return document.querySelector('.debug button').textContent") == 'Copied'
    browser.press(Keys.HOME, 'b')
    assert browser.run('return window.copied') == begin
    browser.run('window.replay.runs[0].is_whole = false; window.replay.seek(60e9)')  # rows cannot be counted
    assert browser.run(COMMAND) == begin + ' --at 59.9'
    browser.click('[data-list="1"]')
    assert browser.run(COMMAND) == '' and not other.with_suffix('.jsonl.run').exists()


def test_a_hundred_thousand_legs_are_played_and_their_events_scrolled(browser, pages):
    entries = many_legs()
    browser.open(page(pages[0], 'many', entries))
    browser.run("document.getElementById('speed').value = '1000'")
    browser.press(' ')
    browser.wait('return window.replay.time > 300e9')
    browser.press(' ')
    browser.run("const s = document.querySelector('.scroller'); s.scrollTop = s.scrollHeight")
    last = '{:.3f}'.format(entries[-1][0] / S).replace('5000', '5\u202f000')
    browser.wait("return [...document.querySelectorAll('.event:not([hidden])')].some((line) => "
                 "line.textContent.startsWith('{}'))".format(last))
    assert len(browser.driver.find_elements('css selector', '.event')) < 60
    browser.run('window.replay.seek(2500.25e9)')
    goal = next(entry for entry in entries if entry[0] == 2500 * S and entry[1] == 'robot_7' and entry[2] == 'departed')
    start = next(entry for entry in entries if entry[0] == 2499 * S + 3 * S // 4 and entry[1] == 'robot_7')
    third = [a + (b - a) / 3 for a, b in zip(start[3], goal[3])]
    assert browser.run(POSE, 0, 7)[:2] == pytest.approx(third[:2])
    assert Pose2D(*third).x != start[3][0]
    browser.press('+', '+')
    browser.frame()
