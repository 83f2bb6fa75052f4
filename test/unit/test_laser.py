"""A laser's rays end where a ray that is held against each cell and each side by itself does."""
import math

import numpy as np
import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.config.settings import read_settings
from move_base_abstract.engine.chance import Chance, Purpose
from move_base_abstract.fleet import Fleet
from move_base_abstract.maps.occupancy import OccupancyMap
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.scenario import make_scenario
from move_base_abstract.sensing import rays
from move_base_abstract.sensing.laser import Laser, LaserSettings

GRAZE = 1e-9  # cells; a ray that is in a cell for less than this only touches it


def map_of(*rows, resolution=1.0, origin=Pose2D()):
    """Return a map of texts, the northernmost first: # occupied, ? unknown."""
    values = {'#': 100, '?': -1, '.': 0}
    cells = np.array([[values[cell] for cell in row] for row in reversed(rows)], np.int8)
    return OccupancyMap(cells, resolution, origin)


def directions(count, yaw=0.0):
    angles = yaw + np.arange(count) * (2.0 * math.pi / count)
    return np.cos(angles), np.sin(angles)


def chords(occupancy, x, y, dx, dy):
    """Return where one ray comes into and leaves each occupied cell [m], by the cell's box in its own axes alone."""
    turn = np.array([[math.cos(occupancy.origin.yaw), math.sin(occupancy.origin.yaw)],
                     [-math.sin(occupancy.origin.yaw), math.cos(occupancy.origin.yaw)]])
    start = turn @ (x - occupancy.origin.x, y - occupancy.origin.y)
    direction = turn @ (dx, dy)
    south_west = np.argwhere(occupancy.cells == 100)[:, ::-1] * occupancy.resolution
    with np.errstate(divide='ignore', invalid='ignore'):
        one, other = ((south_west + side - start) / direction for side in (0.0, occupancy.resolution))
    begin = np.nanmax(np.minimum(one, other), axis=1)
    end = np.nanmin(np.maximum(one, other), axis=1)
    begin = np.maximum(begin, 0.0)
    return begin[end >= begin - GRAZE], end[end >= begin - GRAZE]


def assert_ends_there(occupancy, x, y, dx, dy, most, found):
    begins, ends = chords(occupancy, x, y, dx, dy)
    sure = begins[ends - begins > GRAZE].min(initial=math.inf)
    if sure > most + GRAZE:
        sure = math.inf
    touched = begins[ends - begins <= GRAZE]
    if found != sure and not (max(found, sure) < math.inf and abs(found - sure) <= 1e-9):
        assert np.abs(touched - found).min(initial=1.0) <= 1e-9


@pytest.mark.parametrize('seed', range(30))
def test_rays_end_at_the_first_occupied_cell_of_any_map(seed):
    random = np.random.default_rng(seed)
    shape = random.integers(1, 40, 2)
    cells = np.where(random.random(shape) < random.choice([0.003, 0.05, 0.3]), 100, 0).astype(np.int8)
    cells[random.random(shape) < 0.1] = -1
    origin = Pose2D(*random.uniform(-5.0, 5.0, 2), random.choice([0.0, random.uniform(-3.0, 3.0)]))
    occupancy = OccupancyMap(cells, random.choice([0.05, 0.1, 1.0]), origin)
    for _ in range(6):
        place = random.uniform(-0.5, 1.5, 2) if random.random() < 0.3 else random.random(2)
        x, y = occupancy.from_cells(place[0] * shape[1], place[1] * shape[0])
        most = random.uniform(0.1, 60.0) * occupancy.resolution
        dx, dy = directions(31, random.uniform(-3.0, 3.0))
        found = rays.of_map(occupancy, x, y, dx, dy, most)
        for each in zip(dx, dy, found):
            assert_ends_there(occupancy, x, y, each[0], each[1], most, each[2])


@pytest.mark.parametrize('place', [(2.0, 2.0), (2.5, 2.0), (2.0, 2.5), (2.5, 2.5), (0.0, 0.0), (5.0, 5.0)])
def test_rays_along_lines_and_through_corners_of_cells(place):
    occupancy = map_of('#....', '.....', '.....', '...#.', '.....')
    slant = math.sqrt(0.5)
    dx, dy = np.array([1.0, 0.0, -1.0, 0.0, slant, -slant]), np.array([0.0, 1.0, 0.0, -1.0, slant, slant])
    found = rays.of_map(occupancy, *place, dx, dy, 20.0)
    for each in zip(dx, dy, found):  # a cell has its lower edges
        x, y = place[0] + 1e-7 * (each[0] == 0.0), place[1] + 1e-7 * (each[1] == 0.0)
        assert_ends_there(occupancy, x, y, each[0], each[1], 20.0, each[2])


def test_long_rays_end_as_short_ones_do():
    cells = np.zeros((1, 1000), np.int8)
    cells[0, 900] = 100
    for most, expected in ((1000.0, 899.5), (899.5, 899.5), (899.0, math.inf)):
        assert rays.of_map(OccupancyMap(cells, 1.0), 0.5, 0.5, np.array([1.0]), np.array([0.0]), most) == [expected]


def test_unknown_cells_and_what_is_off_the_map_stop_no_ray_and_an_occupied_start_stops_all():
    occupancy = map_of('.?#')
    dx, dy = np.array([1.0, -1.0]), np.zeros(2)
    assert list(rays.of_map(occupancy, 0.5, 0.5, dx, dy, 9.0)) == [1.5, math.inf]
    assert list(rays.of_map(occupancy, -4.0, 0.5, dx, dy, 9.0)) == [6.0, math.inf]
    assert list(rays.of_map(occupancy, 2.5, 0.5, dx, dy, 9.0)) == [0.0, 0.0]


@pytest.mark.parametrize('seed', range(10))
def test_rays_end_at_the_outline_of_a_body(seed):
    random = np.random.default_rng(seed)
    settings = read_settings({'footprint': [[-0.5, -0.3], [0.7, -0.3], [0.7, 0.3], [-0.5, 0.3]]} if seed % 2 else
                             {'robot_radius': 0.4}, '/robot')
    pose = Pose2D(*random.uniform(-3.0, 3.0, 2), random.uniform(-3.0, 3.0))
    corners = settings.costmaps.global_footprint.at(pose)
    body = rays.Body(pose.x, pose.y, 0.8, corners)
    dx, dy = directions(181)
    found = np.full(181, 4.0)
    rays.shorten(found, 0.3, -0.2, dx, dy, body)
    middle = np.mean(corners, axis=0)
    sides = [(a, b) for a, b in zip(corners, corners[1:] + corners[:1])]
    far = np.arange(0.0, 4.0, 1e-3)[:, None]
    points = np.array((0.3, -0.2)) + far[..., None] * np.stack((dx, dy), axis=1)  # small steps along each ray

    def side_of(a, b, at):
        return (b[0] - a[0]) * (at[..., 1] - a[1]) - (b[1] - a[1]) * (at[..., 0] - a[0])
    inside = np.all([side_of(a, b, points) * side_of(a, b, middle) >= 0.0 for a, b in sides], axis=0)
    assert not inside[0].any()
    first = np.where(inside.any(axis=0), far[inside.argmax(axis=0), 0], 4.0)
    assert np.abs(found - first).max() < 2e-3 or (np.abs(found - first) > 2e-3).sum() <= 2  # a corner between two steps
    assert (found < 4.0).sum() >= 3 or math.hypot(pose.x, pose.y) > 3.0


def test_beams_noise_and_what_is_too_near_or_too_far_are_as_rep_117_says():
    occupancy = map_of('.....#')
    settings = LaserSettings(beams=3, angle_min=-math.pi / 2, angle_max=math.pi / 2, range_min=1.0, range_max=5.0)
    scan = Laser(settings).scan(Pose2D(2.0, 0.5), occupancy, (), 7)
    assert (list(scan.ranges), scan.ranges.dtype, scan.stamp_ns) == ([math.inf, 3.0, math.inf], np.float32, 7)
    assert settings.angle_increment == math.pi / 2
    assert Laser(settings).scan(Pose2D(4.5, 0.5), occupancy, (), 0).ranges[1] == -math.inf
    mounted = LaserSettings(beams=1, angle_min=0.0, range_max=9.0, mount=Pose2D(0.0, 1.0, -math.pi / 2))
    scan = Laser(mounted).scan(Pose2D(3.0, 0.5, math.pi / 2), occupancy, (), 0)
    assert scan.pose.distance_to(Pose2D(2.0, 0.5)) < 1e-12 and list(scan.ranges) == [3.0]


def test_noise_follows_from_seed_robot_and_instant_alone():
    occupancy = map_of('.' * 50 + '#')
    settings = LaserSettings(beams=4000, angle_min=-1e-6, angle_max=1e-6, range_max=100.0, noise=0.1)
    place = Pose2D(10.0, 0.5)
    laser = Laser(settings, 1, 'robot')
    ranges = laser.scan(place, occupancy, (), 5_000_000_000).ranges
    assert abs(ranges.mean() - 40.0) < 0.01 and abs(ranges.std() - 0.1) < 0.005
    laser.scan(place, occupancy, (), 6_000_000_000)
    assert (laser.scan(place, occupancy, (), 5_000_000_000).ranges == ranges).all()
    for other, stamp_ns in ((Laser(settings, 2, 'robot'), 5), (Laser(settings, 1, 'other'), 5), (laser, 6)):
        assert (other.scan(place, occupancy, (), stamp_ns * 1_000_000_000).ranges != ranges).mean() > 0.9


def test_rows_of_numbers_are_those_of_the_blocks_in_turn():
    chance = Chance(3, 'robot')
    row = chance.uniforms(17, Purpose.SCAN, 12)
    assert [abs(row[4 * place] - chance.uniform(17, Purpose.SCAN, place)) < 1e-15 for place in range(3)] == [True] * 3
    assert (chance.uniforms(17, Purpose.SCAN, 12) == row).all()


ROBOTS = [{'name': 'a', 'start_x': 1.0}, {'name': 'b', 'start_x': 4.0}, {'name': 'c', 'start_x': 4.0, 'start_y': 3.0}]
FORWARD = {'scan_beams': 3, 'scan_angle_min': -math.pi / 2, 'scan_angle_max': math.pi / 2, 'robot_radius': 0.5}


def test_robots_of_a_fleet_see_one_another_and_the_map():
    fleet = Fleet(make_scenario({'defaults': dict(FORWARD, use_map=True, max_speed=1.0), 'robots': ROBOTS}),
                  occupancy=OccupancyMap(np.array([[0] * 9 + [100]] * 10, np.int8), 1.0, Pose2D(0.0, -5.0)))
    radius = pytest.approx(0.51, abs=0.01)  # of 16 corners, with costmap_2d's footprint_padding
    ahead = fleet.robot('a').scan().ranges
    assert (ahead[0], 3.0 - ahead[1], ahead[2]) == (math.inf, radius, math.inf)
    ahead = fleet.robot('b').scan().ranges
    assert (ahead[0], ahead[1], 3.0 - ahead[2]) == (math.inf, 5.0, radius)
    fleet.robot('b').send(5.0, 0.0)
    fleet.run_for(0.5)
    scan = fleet.robot('a').scan()
    assert 3.5 - scan.ranges[1] == radius and scan.stamp_ns == fleet.now_ns
    fleet.remove('b')
    assert fleet.robot('a').scan().ranges[1] == 8.0
    fleet.add('d', start_x=3.0, global_frame='elsewhere')
    assert fleet.robot('a').scan().ranges[1] == 8.0


def test_a_robot_without_a_map_sees_robots_only():
    fleet = Fleet(make_scenario({'defaults': FORWARD, 'robots': ROBOTS}))
    assert [math.isinf(each) for each in fleet.robot('c').scan().ranges] == [False, True, True]


def test_one_beam_has_one_direction():
    fleet = Fleet(make_scenario({'defaults': dict(FORWARD, scan_beams=1, scan_angle_min=0.0, scan_angle_max=0.0),
                                 'robots': ROBOTS}))
    assert fleet.robot('a').scan().ranges.tolist() == [pytest.approx(3.0 - 0.51, abs=0.01)]


@pytest.mark.parametrize('parameters, text', [
    ({'scan_range_min': 3.0, 'scan_range_max': 3.0}, 'scan_range_min: got 3.0 with scan_range_max: 3'),
    ({'scan_angle_min': 1.0, 'scan_angle_max': 0.0}, 'scan_angle_min: got 1.0 with scan_angle_max: 0'),
    ({'scan_beams': 2, 'scan_angle_min': 1.0, 'scan_angle_max': 1.0}, 'scan_angle_min: got 1.0 with scan_angle_max: 1'),
    ({'scan_beams': 0}, 'scan_beams: got 0'), ({'scan_rate': -1.0}, 'scan_rate: got -1.0')])
def test_impossible_lasers_are_refused(parameters, text):
    with pytest.raises(ConfigurationError, match=text):
        read_settings(parameters, '/robot')
