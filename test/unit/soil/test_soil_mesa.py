import math

import pytest

from move_base_abstract.common.errors import ConfigurationError
from soil_mapping.config import PUBLISHED_CONFIGURATIONS, TrialConfig
from soil_mapping.mesa_models.motion import EightWayTrip
from soil_mapping.results.trial_folder import events_text
from soil_mapping.stopwatch import Stopwatch

pytest.importorskip('mesa', reason='Mesa is not installed; it needs Python 3.11')
from soil_mapping.mesa_models.mesa_model import SoilMappingModel, run_mesa_trial  # noqa: E402

S = 1_000_000_000


def run(hill, seed=1, motion='euclidean', **options):
    return run_mesa_trial(TrialConfig(**{'field': 'hill', 'cell_m': 2, **options}), seed, motion, hill)


@pytest.mark.parametrize('allocation, sampling', PUBLISHED_CONFIGURATIONS)
def test_the_same_seed_gives_the_same_events_and_another_one_others(hill, allocation, sampling):
    texts = [events_text(run(hill, seed, allocation=allocation, sampling=sampling, budget_s=80.0).events)
             for seed in (1, 1, 2)]
    assert texts[0] == texts[1] != texts[2]


def test_straight_legs_last_their_length_over_the_speed_to_the_nanosecond(hill):
    result = run(hill, budget_s=100.0)
    begun = {}
    legs = 0
    for event in result.events:
        if event.event in ('start', 'sample'):
            begun[event.robot] = (event.x_m, event.y_m)
        elif event.event == 'drive':
            begun[event.robot, 'goal'] = event
        elif event.event == 'arrive':
            drive = begun[event.robot, 'goal']
            metres = math.dist(begun[event.robot], (event.x_m, event.y_m))
            assert abs(event.time_ns - drive.time_ns - metres / 2.0 * 1e9) <= 1.0
            legs += 1
    assert legs >= 3


@pytest.mark.parametrize('motion', ['euclidean', 'eight'])
def test_metrics_agree_with_one_another(hill, motion):
    result = run(hill, 4, motion, budget_s=120.5 if motion == 'euclidean' else 120.0, allocation='ssi')
    sampling_s = result.metrics.samples * 1.0
    moving_s = result.metrics.distance_m / 2.0
    total_s = 3 * result.simulated_s
    if motion == 'euclidean':  # dwells that the end cuts short are in neither: at most one per robot
        assert -1e-6 <= total_s - result.metrics.idle_s - sampling_s - moving_s <= 3.0 + 1e-6
    else:
        assert moving_s > total_s - result.metrics.idle_s - sampling_s - 3.0  # diagonals go further in their time
    assert result.simulated_s == (120.5 if motion == 'euclidean' else 120.0)
    assert result.metrics.samples == len(result.samples)
    assert result.metrics.rmse_kpa == result.history[-1].rmse_kpa
    assert result.metrics.waiting_s == 0.0


def test_eight_way_trips_go_diagonally_first_a_cell_a_second():
    trip = EightWayTrip.between((1.0, 1.0), (7.0, 19.0), 2.0, 5 * S)
    assert trip.arrive_ns == 14 * S
    assert trip.bends() == [(8 * S, 7.0, 7.0)]
    assert [trip.place_at(t * S) for t in (0, 5, 6, 8, 9, 14, 99)] == \
        [(1.0, 1.0), (1.0, 1.0), (3.0, 3.0), (7.0, 7.0), (7.0, 9.0), (7.0, 19.0), (7.0, 19.0)]


def test_eight_way_distance_counts_diagonals_at_their_length(hill):
    result = run(hill, 1, 'eight', budget_s=50.0, allocation='rr', sampling='random')
    way = sum(math.dist((a.x, a.y), (b.x, b.y)) for robot in range(3)
              for points in [[p for p in result.waypoints if p.robot == robot]]
              for a, b in zip(points, points[1:]))
    assert result.metrics.distance_m == pytest.approx(way)
    assert all(event.time_ns % S == 0 for event in result.events)


def test_agents_show_where_the_robots_are_and_the_collector_has_a_row_a_step(hill):
    model = SoilMappingModel(TrialConfig(field='hill', cell_m=2, budget_s=10.0), 1, hill)
    model.step()
    model.step()
    assert model.now_ns == 2 * S
    driven = [math.dist(robot.pos, place) for robot, place in zip(model.agents, model.coordinator.start_places)]
    assert any(1.9 < metres < 2.1 for metres in driven)  # a second of driving after a second of sampling
    frame = model.datacollector.get_model_vars_dataframe()
    assert frame['samples'].tolist() == [3, 3]


def test_a_mission_that_runs_out_of_tasks_ends_before_its_budget(hill):
    result = run(hill, sampling='dynamic', coarse_m=200.0, budget_s=2000.0)
    assert result.metrics.samples == 3 + 4  # 324 x 220 m has four squares of 200 m
    assert result.simulated_s < 500.0
    assert result.events[-1].time_ns == result.events[-2].time_ns


@pytest.mark.parametrize('motion, options, complaint', [
    ('hop', {}, "motion must be one of eight, euclidean, got 'hop'"),
    ('eight', {'cell_m': 1}, "motion 'eight' needs cell_m 2"),
    ('eight', {'dwell_s': 0.5}, "motion 'eight' needs dwells of whole steps of 1 s"),
])
def test_a_motion_that_does_not_fit_is_refused(hill, motion, options, complaint):
    with pytest.raises(ConfigurationError, match=complaint):
        run(hill, 1, motion, **options)


def test_the_stopwatch_adds_up_each_phase():
    ticks = iter([0.0, 1.0, 3.0, 10.0, 10.5, 20.0])
    stopwatch = Stopwatch(lambda: next(ticks))
    with stopwatch.phase('mission'), stopwatch.phase('kriging'):
        pass
    with stopwatch.phase('kriging'):
        pass
    assert stopwatch.seconds == {'kriging': 11.5, 'mission': 10.0}
