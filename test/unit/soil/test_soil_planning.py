import numpy as np
import pytest

from soil_mapping.config import Allocation, TrialConfig
from soil_mapping.ground_truth.grid import Grid
from soil_mapping.interpolation.kriging import Estimate
from soil_mapping.mission.allocation import Allocator
from soil_mapping.mission.coarse_cells import coarse_cells, compute_clusters, field_clusters, square_labels
from soil_mapping.mission.sampling import Task, make_sampling, start_places

GRID = Grid.of_field(1)


def estimate_of(variance):
    return Estimate(mean=None, variance=variance, variogram=None, rmse=0.0, mean_variance=0.0)


def places(tasks):
    return [(task.x, task.y) for task in tasks]


# ------------------------------------------------------------------------------------------------ coarse cells

def test_squares_of_33_m_cut_the_field_into_ten_by_seven():
    labels = square_labels(GRID, 33.0)
    assert labels.shape == (220, 324)
    assert labels.max() == 69
    assert labels[32, 32] == 0
    assert labels[32, 33] == 1
    assert labels[33, 32] == 10


def test_the_stored_clusters_are_55_and_none_is_wider_than_the_published_limit():
    labels = field_clusters()
    assert labels.shape == (110, 162)
    assert np.array_equal(np.unique(labels), np.arange(55))
    for label in range(55):
        cells = np.argwhere(labels == label)
        widest = np.sqrt(((cells[:, None] - cells) ** 2).sum(axis=2)).max()
        assert widest <= np.sqrt(162 * 110) / 4.0


def test_clusters_partition_a_small_grid_within_the_limit():
    labels = compute_clusters(12, 16)
    for label in np.unique(labels):
        cells = np.argwhere(labels == label)
        assert np.sqrt(((cells[:, None] - cells) ** 2).sum(axis=2)).max() <= np.sqrt(12 * 16) / 4.0


def test_clusters_serve_both_grids():
    config = TrialConfig(coarse_cells='clusters')
    fine, coarse = coarse_cells(config, GRID), coarse_cells(config, Grid.of_field(2))
    assert np.array_equal(fine[1::2, 1::2], coarse)
    assert np.array_equal(coarse, field_clusters())


# ------------------------------------------------------------------------------------------------ samplings

def test_starts_are_middles_of_cells_and_a_further_robot_moves_nobody():
    three, four = start_places(3, 5, GRID), start_places(4, 5, GRID)
    assert four[:3] == three
    assert all(GRID.snap(*place) == place for place in four)
    assert start_places(3, 6, GRID) != three


def test_random_sampling_makes_one_task_per_robot_and_none_twice():
    small = Grid(3, 4, 1.0)
    sampling = make_sampling(TrialConfig(robots=5, sampling='random'), 1, small)
    rounds = [sampling.new_tasks(None) for _ in range(4)]
    assert [len(tasks) for tasks in rounds] == [5, 5, 2, 0]
    made = [task for tasks in rounds for task in tasks]
    assert len(set(places(made))) == 12
    assert [task.number for task in made] == list(range(12))
    assert sampling.exhausted


def test_dynamic_sampling_goes_where_the_mean_variance_is_highest_and_uses_no_coarse_cell_twice():
    variance = np.ones(GRID.shape)
    variance[0:33, 33:66] = 5.0  # label 1
    variance[10, 40] = 6.0
    variance[33:66, 0:33] = 4.0  # label 10
    variance[200, 300] = 99.0  # highest of all, in a coarse cell whose mean is lower
    sampling = make_sampling(TrialConfig(robots=1), 1, GRID)
    first = sampling.new_tasks(estimate_of(variance))
    assert places(first) == [(40.5, 10.5), (0.5, 33.5)]  # a tie within label 10: southern, then western
    assert places(sampling.new_tasks(estimate_of(variance)))[0] == (300.5, 200.5)
    assert [task.number for task in first] == [0, 1]


def test_dynamic_sampling_breaks_ties_by_label_and_ends_when_all_are_used():
    sampling = make_sampling(TrialConfig(robots=20), 1, GRID)
    flat = estimate_of(np.ones(GRID.shape))
    tasks = sampling.new_tasks(flat)
    assert places(tasks)[:3] == [(0.5, 0.5), (33.5, 0.5), (66.5, 0.5)]
    assert len(tasks) == 40
    assert not sampling.exhausted
    assert len(sampling.new_tasks(flat)) == 30
    assert sampling.exhausted
    assert sampling.new_tasks(flat) == []


def test_the_grid_has_a_hundred_points_with_a_margin_of_a_twentieth():
    sampling = make_sampling(TrialConfig(sampling='grid'), 1, GRID)
    tasks = sampling.new_tasks(None)
    assert len(set(places(tasks))) == 100
    assert places(tasks)[0] == (16.5, 11.5)  # 5 % of 324 x 220 m is (16.2, 11)
    assert places(tasks)[-1] == (307.5, 209.5)  # 95 % is (307.8, 209)
    assert sampling.new_tasks(None) == []


# ------------------------------------------------------------------------------------------------ allocation

def test_round_robin_goes_on_in_turn():
    allocator = Allocator(Allocation.ROUND_ROBIN, [(0.0, 0.0)] * 3)
    assert [allocator.allocate(Task(n, 1.0, 1.0)) for n in range(5)] == [0, 1, 2, 0, 1]


def test_the_lowest_bid_wins_and_a_tie_goes_to_the_lower_index():
    allocator = Allocator(Allocation.AUCTION, [(0.0, 0.0), (100.0, 0.0), (100.0, 0.0)])
    assert allocator.allocate(Task(0, 90.0, 0.0)) == 1
    assert allocator.allocate(Task(1, 90.0, 1.0)) == 2  # the bid is the whole queue: 1 has 10 m already
    assert allocator.allocate(Task(2, 1.0, 0.0)) == 0


@pytest.mark.parametrize('allocation', Allocation)
def test_a_task_goes_where_the_way_grows_by_least(allocation):
    allocator = Allocator(allocation, [(0.0, 0.0)])
    for number, x in enumerate((10.0, 30.0, 20.0, 5.0, 40.0)):
        allocator.allocate(Task(number, x, 0.0))
    assert [task.x for task in allocator.queues[0]] == [5.0, 10.0, 20.0, 30.0, 40.0]


def test_a_busy_robot_bids_from_where_it_will_be_free():
    allocator = Allocator(Allocation.AUCTION, [(0.0, 0.0), (200.0, 0.0)])
    allocator.allocate(Task(0, 100.0, 0.0))
    assert allocator.take(0) == Task(0, 100.0, 0.0)
    assert allocator.allocate(Task(1, 120.0, 0.0)) == 0  # 20 m against 80 m
