import math

import pytest

from move_base_abstract.common.errors import ConfigurationError
from soil_mapping.config import TrialConfig
from soil_mapping.mission.commands import FIRST_SAMPLE, Drive, Place, Stop, TakeSample
from soil_mapping.mission.coordinator import Coordinator
from soil_mapping.mission.mission_log import Activity
from soil_mapping.results.result import collect, measure

S = 1_000_000_000


def mission(hill, **options):
    options = {'field': 'hill', 'cell_m': 2, 'sampling': 'random', **options}
    return Coordinator(TrialConfig(**options), 3, hill)


def first_samples(coordinator, now_ns):
    """Let every robot take its first sample; return the commands of the last one."""
    commands = []
    for robot, (x, y) in enumerate(coordinator.start_places):
        commands = coordinator.sampled(robot, now_ns, Place(x, y), coordinator.truth.value_at(x, y))
    return commands


def test_each_robot_begins_with_a_sample_where_it_stands(hill):
    coordinator = mission(hill, dwell_s=1.5)
    assert coordinator.start(5 * S) == [TakeSample(robot, FIRST_SAMPLE, 1_500_000_000) for robot in range(3)]
    assert coordinator.end_ns == 245 * S


def test_the_third_sample_makes_the_map_and_sends_all_robots_off_in_order(hill):
    coordinator = mission(hill, allocation='rr')
    coordinator.start(0)
    (x, y), other = coordinator.start_places[0], coordinator.start_places[1]
    assert coordinator.sampled(0, S, Place(x, y), 800.0) == []
    assert coordinator.sampled(1, S, Place(*other), 805.0) == []
    assert coordinator.estimate is None
    commands = coordinator.sampled(2, S, Place(*coordinator.start_places[2]), 810.0)
    assert coordinator.estimate.mean.shape == (110, 162)
    assert [(type(command), command.robot, command.task) for command in commands] == \
        [(Drive, 0, 0), (Drive, 1, 1), (Drive, 2, 2)]


def test_a_leg_is_followed_by_a_dwell_and_that_by_new_tasks_and_the_next_leg(hill):
    coordinator = mission(hill, allocation='rr')
    coordinator.start(0)
    drive = first_samples(coordinator, S)[1]
    assert coordinator.arrived(1, 9 * S, Place(drive.x, drive.y)) == [TakeSample(1, 1, S)]
    queued = len(coordinator.queue(1))
    commands = coordinator.sampled(1, 10 * S, Place(drive.x, drive.y), 801.0)
    assert [(type(command), command.robot) for command in commands] == [(Drive, 1)]
    assert len(coordinator.queue(1)) == queued  # one came with the round of three, one was begun
    assert coordinator.log.task_ns == [9 * S]
    assert [moment.samples for moment in coordinator.log.history] == [3, 4]


def test_dynamic_sampling_makes_two_tasks_per_robot(hill):
    coordinator = mission(hill, sampling='dynamic')
    coordinator.start(0)
    first_samples(coordinator, S)
    assert sum(event.event == 'allocate' for event in coordinator.log.events) == 6


def test_grid_sampling_has_all_its_tasks_at_the_start_and_no_first_samples(hill):
    coordinator = mission(hill, sampling='grid')
    commands = coordinator.start(0)
    assert all(isinstance(command, Drive) for command in commands)
    assert sum(event.event == 'allocate' for event in coordinator.log.events) == 100


def test_a_failed_leg_drops_its_task(hill):
    coordinator = mission(hill, allocation='rr')
    coordinator.start(0)
    first_samples(coordinator, S)
    assert coordinator.failed(0, 3 * S, Place(1.0, 2.0)) == []  # nothing else in its queue
    assert coordinator.log.activity(0) is Activity.IDLE
    assert coordinator.current_task(0) is None
    assert coordinator.log.task_ns == []


def test_a_robot_whose_leg_has_failed_goes_on_with_its_next_task(hill):
    coordinator = mission(hill, sampling='grid', allocation='rr')
    first = coordinator.start(0)[1]
    following = coordinator.queue(1)[0]
    assert coordinator.failed(1, 3 * S, Place(4.0, 6.0)) == [Drive(1, following.number, following.x, following.y)]
    told = [event for event in coordinator.log.events if event.event == 'fail']
    assert [(event.time_ns, event.robot, event.task, event.x_m, event.y_m) for event in told] == [
        (3 * S, 1, first.task, 4.0, 6.0)]
    assert coordinator.current_task(1) == following


def test_a_robot_whose_leg_has_failed_bids_from_where_it_is(hill):
    def bidder(place):
        """Return who gets the next sample's task when robot 0 has given up at ``place``, and where that is."""
        coordinator = mission(hill, allocation='ssi', robots=2, sampling='random')
        coordinator.start(0)
        for robot, (x, y) in enumerate(coordinator.start_places):
            coordinator.sampled(robot, S, Place(x, y), 800.0 + robot)
        for robot in range(2):
            while coordinator.current_task(robot) is not None:
                coordinator.failed(robot, 2 * S, place if robot == 0 else Place(160.0, 100.0))
        coordinator.sampled(1, 3 * S, Place(160.0, 100.0), 805.0)
        told = [event for event in coordinator.log.events if event.event == 'allocate'][-1]
        return told.robot, Place(told.x_m, told.y_m)

    _, task = bidder(Place(160.0, 101.0))
    far = Place(0.0 if task.x > 160.0 else 320.0, 0.0 if task.y > 100.0 else 215.0)
    assert (bidder(task), bidder(far)) == ((0, task), (1, task))


def test_a_dwell_is_logged_where_the_robot_stands_with_its_length(hill):
    coordinator = mission(hill, dwell_s=1.25)
    coordinator.start(0)
    drive = first_samples(coordinator, S)[0]
    assert coordinator.arrived(drive.robot, 9 * S, Place(drive.x, drive.y)) == [
        TakeSample(drive.robot, drive.task, 1_250_000_000)]
    told = [event for event in coordinator.log.events if event.event == 'dwell'][-1]
    assert (told.time_ns, told.robot, told.task, told.x_m, told.y_m, told.value) == (
        9 * S, drive.robot, drive.task, drive.x, drive.y, 1.25)
    assert coordinator.log.activity(drive.robot) is Activity.SAMPLING


def test_a_spread_dwell_may_be_shorter_or_longer_than_its_mean(hill):
    coordinator = mission(hill, dwell_s=2.0, dwell_spread_s=0.5, robots=8)
    dwells = [command.dwell_ns for command in coordinator.start(0)]
    assert min(dwells) < 2 * S < max(dwells)


def test_the_end_stops_who_is_at_work_and_counts_begun_legs(hill):
    coordinator = mission(hill, allocation='rr', robots=3)
    coordinator.start(0)
    drives = first_samples(coordinator, S)
    coordinator.failed(2, 2 * S, Place(*coordinator.start_places[2]))
    places = [Place(*coordinator.start_places[0], driven_m=4.5), Place(drives[1].x, drives[1].y),
              Place(*coordinator.start_places[2])]
    assert coordinator.end(11 * S, places) == [Stop(0), Stop(1)]
    whole_leg = math.dist(coordinator.start_places[1], (drives[1].x, drives[1].y))
    assert measure(coordinator).distance_m == pytest.approx(4.5 + whole_leg)
    assert measure(coordinator).idle_s == 9.0
    assert math.isnan(measure(coordinator).task_s)


def test_what_is_told_after_the_end_changes_nothing(hill):
    coordinator = mission(hill)
    coordinator.start(0)
    first_samples(coordinator, S)
    places = [Place(*place) for place in coordinator.start_places]
    coordinator.end(2 * S, places)
    before = list(coordinator.log.events)
    assert coordinator.arrived(0, 3 * S, places[0]) == []
    assert coordinator.sampled(0, 3 * S, places[0], 1.0) == []
    assert coordinator.failed(1, 3 * S, places[1]) == []
    assert coordinator.end(3 * S, places) == []
    assert coordinator.log.events == before


def test_held_up_time_is_waiting_and_a_robots_times_add_up_to_the_mission(hill):
    coordinator = mission(hill, allocation='rr')
    coordinator.start(7 * S)
    first_samples(coordinator, 8 * S)
    coordinator.held(0, 10 * S)
    coordinator.resumed(0, 13 * S)
    coordinator.held(2, 15 * S)
    coordinator.end(20 * S, [Place(*place) for place in coordinator.start_places])
    assert measure(coordinator).waiting_s == 8.0
    for robot in coordinator.log.seconds_ns:
        assert sum(robot.values()) == 13 * S
    assert coordinator.log.seconds_ns[0] == {
        Activity.IDLE: 0, Activity.DRIVING: 9 * S, Activity.SAMPLING: S, Activity.WAITING: 3 * S}


def test_two_robots_need_not_wait_for_a_third_sample_that_nobody_takes(hill):
    coordinator = mission(hill, robots=2, sampling='dynamic', allocation='rr')
    coordinator.start(0)
    commands = first_samples(coordinator, S)
    assert coordinator.estimate is None
    assert [type(command) for command in commands] == [Drive, Drive]


def test_a_mission_is_complete_when_no_task_can_be_made_and_none_is_open(hill):
    coordinator = mission(hill, robots=1, sampling='dynamic', coarse_m=100.0)
    now_ns, commands = 0, coordinator.start(0)
    commands = first_samples(coordinator, now_ns)
    while commands:
        drive = commands[0]
        assert not coordinator.complete
        now_ns += S
        coordinator.arrived(0, now_ns, Place(drive.x, drive.y))
        commands = coordinator.sampled(0, now_ns, Place(drive.x, drive.y), 800.0 + drive.x / 100.0)
    assert coordinator.complete
    assert len(coordinator.log.samples) == 1 + 1 + 1 + 12  # two at random before the map, 4 x 3 squares


def test_dwells_are_spread_by_the_seed_within_their_limits(hill):
    dwells = [[command.dwell_ns for command in mission(hill, dwell_s=2.0, dwell_spread_s=0.5, robots=n).start(0)]
              for n in (3, 4)]
    assert dwells[1][:3] == dwells[0]
    assert len(set(dwells[1])) == 4
    assert all(1_500_000_000 <= dwell <= 2_500_000_000 for dwell in dwells[1])


def test_a_mission_without_a_map_has_maps_of_nan(hill):
    coordinator = mission(hill)
    coordinator.start(0)
    coordinator.end(S, [Place(*place) for place in coordinator.start_places])
    result = collect(coordinator, {'name': 'none'}, {}, math.nan)
    assert math.isnan(result.metrics.rmse_kpa)
    assert result.prediction.shape == (110, 162)
    assert math.isnan(result.speed_up['overall'])


@pytest.mark.parametrize('options, complaint', [
    ({'robots': 0}, 'robots: got 0; allowed: a whole number in 1..1000'), ({'robots': True}, 'robots: got True'),
    ({'robots': 10 ** 5000}, 'robots: got a whole number of about 5001 digits; allowed'),
    ({'allocation': 'SSI'}, "allocation: got 'SSI'; allowed: rr, ssi, or a class of your own"),
    ({'sampling': None}, 'sampling: got None; allowed: random, dynamic, grid, or'),
    ({'budget_s': math.nan}, 'budget_s: got nan; allowed: a number in 0.001..1e7 [s]'),
    ({'speed': 1e-300}, 'speed: got 1e-300; allowed: a number in 0.001..1000 [m/s]'),
    ({'dwell_s': 10 ** 400}, 'dwell_s: got a whole number of about 401 digits; allowed'),
    ({'dwell_spread_s': 1.5}, 'dwell_spread_s: got 1.5; allowed: at most dwell_s, 1 s'),
    ({'cell_m': 0}, 'cell_m: got 0; allowed: a number in 0.001..'), ({'field': 4}, 'field: got 4; allowed: a text')])
def test_a_configuration_that_cannot_be_used_is_refused(options, complaint):
    with pytest.raises(ConfigurationError) as caught:
        TrialConfig(**options)
    assert str(caught.value).startswith(complaint)


def test_a_configuration_survives_json_and_names_the_nearest_key():
    config = TrialConfig(allocation='rr', coarse_cells='clusters')
    assert TrialConfig.from_dict(config.to_dict()) == config
    with pytest.raises(ConfigurationError, match="robotts: unknown key; did you mean 'robots'"):
        TrialConfig.from_dict({'robotts': 3})
