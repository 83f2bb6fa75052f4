"""The world in a replay, in Chromium: names that do not overlap, robots that wait, pictures, many robots."""
import json

import pytest
from replay_test_pages import S, log_text

from move_base_abstract.fleet import Fleet
from move_base_abstract.scenario import make_scenario
from move_base_abstract_replay.page import write_page

#: script for the boxes of the texts on the map; each text is there twice, and the filled one counts
BOXES = """
    const texts = [...document.querySelectorAll('.map svg text')].filter((text) => !text.getAttribute('stroke'));
    return texts.map((text) => {
      const box = text.getBBox();
      return [text.textContent, box.x, box.y, box.x + box.width, box.y + box.height];
    });"""
READOUT = "return document.querySelector('.map output').textContent"
HOSTILE = '</script><img src=x onerror=alert(1)>'


@pytest.fixture(scope='module')
def page(tmp_path_factory):
    """Return the page of 50 robots, most of which wait at one gate, and of a name that is HTML."""
    folder = tmp_path_factory.mktemp('world')
    scenario = make_scenario({
        'defaults': {'max_speed': 2.0, 'acceleration': 1.0, 'log_motion': True, 'battery_capacity': 1.0,
                     'battery_start': 0.4},
        'robots': [{'name': 'robot', 'count': 50, 'step_y': 1.5}],
        'zones': [{'name': 'gate', 'rectangle': [20.0, -5.0, 40.0, 90.0], 'capacity': 2},
                  {'name': 'plug', 'rectangle': [50.0, 10.0, 54.0, 14.0], 'charger': True}],
        'places': [{'name': 'dock', 'x': 30.0, 'y': 30.0, 'capacity': 1, 'duration': 10.0}]})
    fleet = Fleet(scenario)
    for number in range(49):  # the last one never leaves
        fleet.robot('robot_{}'.format(number)).send(60.0, 1.5 * number)
    fleet.run_for(40.0)
    stops = ('dock', 30.0, 30.0, 'pick')
    entries = [*fleet.trace, (41 * S, '/dispatcher', 'order_arrived', (HOSTILE, 0, 0, *stops)),
               (41 * S, HOSTILE, 'departed', (1.0, 2.0, 0.0)), (42 * S, HOSTILE, 'stands', (1.0, 2.0, 0.0)),
               (42 * S, 'robot_49', 'order_assigned', (HOSTILE, 1)),
               (43 * S, 'robot_49', 'order_stop', (HOSTILE, 1, 'drives'))]
    (folder / 'run.jsonl').write_text(log_text(entries))
    write_page([folder / 'run.jsonl'], folder / 'page.html', scenario=scenario)
    return folder / 'page.html'


def test_names_of_fifty_robots_do_not_cover_one_another_and_fewer_are_there_from_far_away(browser, page):
    browser.open('{}?style=print'.format(page))
    browser.frame()  # before it the camera has no place to zoom
    counts = []
    for factor in (1.0, 0.4):
        browser.run('window.replay.camera.zoom(arguments[0], 30, 37); window.replay.seek(30e9)', factor)
        browser.frame()
        boxes = browser.run(BOXES)
        counts.append(len(boxes))
        for index, (one, *box) in enumerate(boxes):
            for other, *next_box in boxes[:index]:
                wide = min(box[2], next_box[2]) - max(box[0], next_box[0])
                high = min(box[3], next_box[3]) - max(box[1], next_box[1])
                assert wide <= 1.0 or high <= 3.0, (one, other)  # a line is higher than its letters
    assert counts[0] > 30 and counts[1] < counts[0]
    assert browser.console() == []


def test_a_picture_is_of_lines_and_letters_in_black_on_white(browser, page):
    browser.open('{}?style=print'.format(page))
    assert browser.run("return [...document.querySelectorAll('canvas')].every((one) => !one.offsetWidth)")
    assert browser.run("return document.querySelectorAll('.map svg path').length") > 100
    assert browser.run("return document.querySelectorAll('.timeline svg text').length") > 50
    assert browser.run('return getComputedStyle(document.body).backgroundColor') == 'rgb(255, 255, 255)'
    browser.open(page)
    assert browser.run("return document.querySelector('svg.drawn')") is None
    browser.run("window.dispatchEvent(new Event('beforeprint'))")
    assert browser.run("return document.querySelectorAll('.map svg path').length") > 100
    browser.run("window.dispatchEvent(new Event('afterprint'))")
    assert browser.run("return document.querySelector('.map canvas').offsetWidth") > 0


def test_who_waits_where_is_said_in_words_also_when_time_goes_back(browser, page):
    browser.open(page)
    told = {}
    for time in (1.0, 30.0, 12.0, 30.0, 1.0):
        browser.run('window.replay.seek(arguments[0] * 1e9); window.replay.chooseThing(0)', time)
        browser.frame()
        told.setdefault(time, set()).add(browser.run(READOUT))
    assert all(len(texts) == 1 for texts in told.values())
    assert told[1.0] == {'zone gate · 0 of 2'}
    assert next(iter(told[30.0])).startswith('zone gate · 2 of 2: robot_')
    assert ' wait: robot_' in next(iter(told[30.0]))


def test_a_robot_that_has_not_left_is_there_with_its_charge_and_order_and_names_are_no_markup(browser, page):
    browser.open(page)
    browser.run("window.replay.seek(1e9); window.replay.choose('robot_49')")
    browser.frame()
    assert browser.run(READOUT) == 'robot_49 · idle · (0.00, 73.50) m, 0° · 40 % charged'
    browser.run('window.replay.seek(43e9)')
    browser.frame()
    assert 'order {} · stop 1 of 1'.format(HOSTILE) in browser.run(READOUT)
    assert browser.run("return document.querySelector('.orders').textContent") == (
        'Orders: 0 open · 1 assigned · 0 done')
    assert browser.run("return document.querySelectorAll('img').length") == 0
    assert browser.console() == []


def test_spots_are_rings_and_parking_places_have_a_letter(browser, tmp_path):
    (tmp_path / 'net.yaml').write_text(json.dumps({
        'nodes': [{'name': 'a', 'x': 0.0, 'y': 0.0}, {'name': 'lot', 'x': 9.0, 'y': 0.0, 'spots': [[8, 3], [10, 3]]},
                  {'name': 'side', 'x': 5.0, 'y': 5.0, 'capacity': 1}], 'edges': [{'from': 'a', 'to': 'lot'}]}))
    scenario = make_scenario({
        'lanes': str(tmp_path / 'net.yaml'), 'defaults': {'routes': 'lanes'}, 'robots': [{'name': 'r'}],
        'places': [{'name': 'garage', 'x': 9.0, 'y': 0.0, 'reach': 4.0, 'parking': True, 'capacity': 2}]})
    fleet = Fleet(scenario)
    fleet.robot('r').send(9.0, 0.0)
    fleet.run()
    fleet.write_log(tmp_path / 'run.jsonl')
    write_page([tmp_path / 'run.jsonl'], tmp_path / 'page.html', scenario=scenario)
    browser.open('{}?style=print'.format(tmp_path / 'page.html'))
    browser.frame()
    browser.run('window.replay.seek(26e9)')
    browser.frame()
    texts = [text for text, *_ in browser.run(BOXES)]
    assert 'P' in texts and 'lot 1/2' in texts and 'garage' in texts
    rings = """return [...document.querySelectorAll('.map svg path')].map((path) => path.getAttribute('d'))
      .filter((d) => /^M[^A]*M[^A]*A[^AMZ]*A[^AMZ]*$/.test(d)).length"""
    assert browser.run(rings) == 3
    told = []
    for thing in range(4):
        browser.run('window.replay.chooseThing(arguments[0])', thing)
        browser.frame()
        told.append(browser.run(READOUT))
    assert told[1:] == ['node lot · 1 of 2: r', 'node side · 0 of 1', 'parking place garage']
    assert browser.console() == []


def test_a_thousand_robots_are_shown(browser, tmp_path):
    robots = [{'name': 'r', 'count': 1000, 'step_x': 0.2, 'start_y': 3.0}]
    (tmp_path / 'run.jsonl').write_text(log_text(
        [(S, 'r_{}'.format(number), 'departed', (0.2 * number, 50.0, 0.0)) for number in range(1000)]
        + [(60 * S, 'r_{}'.format(number), 'stands', (0.2 * number, 50.0, 0.0)) for number in range(1000)]))
    write_page([tmp_path / 'run.jsonl'], tmp_path / 'page.html', scenario=make_scenario({'robots': robots}))
    browser.open(tmp_path / 'page.html')
    browser.run('window.replay.seek(30e9)')
    browser.frame()
    assert browser.run('return window.replay.runs[0].robots') == 1000
    found = json.loads(browser.run('return JSON.stringify(window.replay.runs[0].poseAt(500, 30e9))'))
    assert 0.0 < found['y'] < 50.0
    assert browser.console() == []


def test_the_limit_of_a_zone_and_the_level_of_a_charge_are_those_of_the_instant(browser, tmp_path):
    fleet = Fleet(make_scenario({
        'defaults': {'battery_capacity': 0.1, 'ambient_power': 36.0, 'log_motion': True},
        'robots': [{'name': 'a'}, {'name': 'b', 'start_y': 5.0}],
        'dispatcher': {'charge_below': 0.25, 'charge_when_idle': 0.6},
        'zones': [{'name': 'slow', 'rectangle': [4, -1, 6, 1], 'max_speed': 0.4}]}), start_ns=0)
    fleet.at(40 * S, lambda fleet: fleet.set_zone_limit('slow', 0.3))
    fleet.at(60 * S, lambda fleet: fleet.set_zone_limit('slow'))
    fleet.run(until=100.0)
    fleet.robot('a').send(1.0, 0.0)
    fleet.run()
    fleet.write_log(tmp_path / 'run.jsonl')
    write_page([tmp_path / 'run.jsonl'], tmp_path / 'page.html', scenario=fleet.scenario)
    browser.open(tmp_path / 'page.html')

    def said(choice, second):
        browser.run('{}; window.replay.seek({}e9)'.format(choice, second))
        browser.frame()
        return browser.run(READOUT)
    zone = 'window.replay.choose(null); window.replay.chooseThing(0)'
    assert [said(zone, second) for second in (61, 20, 40)] == [
        'zone slow · 0 in it', 'zone slow · 0 in it · at most 0.4 m/s', 'zone slow · 0 in it · at most 0.3 m/s']
    robot = "window.replay.choose('b')"
    assert [said(robot, second).split(' · ')[-2:] for second in (10, 60, 95)] == [
        ['92 % charged', 'good'], ['50 % charged', 'below good'], ['21 % charged', 'critical']]
    assert browser.console() == []
