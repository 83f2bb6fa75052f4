#!/usr/bin/env python3
"""Compares the ranking of coordinators in simulation with their ranking in the same missions on a real stack.

    .ws/bin/python3 examples/ranking/compare_rankings.py REAL.csv SIMULATED.csv [PICTURE.png]

PICTURE.png shows the real and the simulated distributions, quantile by quantile.

Both tables have a row for each mission, with the columns map, robots, policy, tasks, mission_s [s] and ended. The
simulated one also has the column level.
A configuration is a map, a number of robots and a policy; its value is the mean makespan over its task sets.
SRCC is Pearson's correlation of these values (Kadian and others, RA-L 2020), tau is Kendall's. The ceiling is the same
numbers for two halves of the real missions. Intervals are 95 %, by resampling the task sets; if there is only one task
set, by resampling the real missions.
"""
import sys

import numpy as np
import pandas as pd
from scipy.stats import kendalltau, ks_2samp, pearsonr

KEYS = ['map', 'robots', 'policy']
DRAWS, PLACES = 400, 40


def means(rows):
    """Return the mean makespan [s] of each configuration (a row) on each of its task sets (a column)."""
    return rows.pivot_table('mission_s', KEYS, 'tasks')


def agreement(one, other):
    """Return (SRCC, tau) of two tables of the same configurations; each task set counts the same."""
    one, other = np.nanmean(one, axis=1), np.nanmean(other, axis=1)
    return pearsonr(one, other)[0], kendalltau(one, other)[0]


def interval(values):
    """Return the 95 % interval of ``values`` as text."""
    return '{:.2f} to {:.2f}'.format(*np.nanquantile(np.array(values), [0.025, 0.975]))


def with_intervals(real, simulated, chance):
    """Return [(SRCC, its interval), (tau, its interval)]; with only one task set the real missions are resampled."""
    one, other = (table.to_numpy() for table in means(real).align(means(simulated), join='inner'))
    sets = one.shape[1]
    if sets > 1:
        chosen = [chance.integers(0, sets, sets) for _ in range(DRAWS)]
        draws = [agreement(one[:, own], other[:, own]) for own in chosen]
    else:
        groups = real.groupby(KEYS + ['tasks'])
        samples = [groups.sample(frac=1.0, replace=True, random_state=seed) for seed in range(DRAWS)]
        draws = [agreement(*(table.to_numpy() for table in means(own).align(means(simulated), join='inner')))
                 for own in samples]
    return [(value, interval([draw[at] for draw in draws])) for at, value in enumerate(agreement(one, other))]


def ceiling(real, chance):
    """Return (SRCC, tau) between halves of the real missions: the medians over 100 random divisions into halves."""
    halves = []
    cells, size = [real[key] for key in KEYS + ['tasks']], real.groupby(KEYS + ['tasks'])['mission_s'].transform('size')
    for _ in range(100):
        rank = pd.Series(chance.permutation(len(real)), index=real.index).groupby(cells).rank()
        first, second = means(real[rank <= size / 2]).align(means(real[rank > size / 2]), join='inner')
        halves.append(agreement(first.to_numpy(), second.to_numpy()))
    return np.nanmedian(np.array(halves), axis=0)


def pairs(real, simulated, chance):
    """Return (pairs of policies that differ for certain in reality, those of them with the same sign here)."""
    certain = same = 0
    for _, own in real.groupby(KEYS[:2]):
        policies = sorted(own.policy.unique())
        for number, first in enumerate(policies):
            for second in policies[number + 1:]:
                gap, low, high = difference(own, first, second, chance)
                if low <= 0.0 <= high:
                    continue
                certain += 1
                here = simulated[(simulated.map == own.map.iloc[0]) & (simulated.robots == own.robots.iloc[0])]
                same += np.sign(difference(here, first, second, chance)[0]) == np.sign(gap)
    return certain, same


def difference(rows, first, second, chance):
    """Return (mean paired difference over task sets, and the ends of its 95 % interval) [s].

    Both the task sets and the missions of each set are resampled.
    """
    one, other = ([group.mission_s.to_numpy() for _, group in rows[rows.policy == policy].groupby('tasks')]
                  for policy in (first, second))
    gap = np.mean([a.mean() - b.mean() for a, b in zip(one, other)])
    draws = [np.mean([chance.choice(one[at], len(one[at])).mean() - chance.choice(other[at], len(other[at])).mean()
                      for at in chance.integers(0, len(one), len(one))]) for _ in range(200)]
    return (gap, *np.quantile(draws, [0.025, 0.975]))


def distributions(real, simulated):
    """Return (share of real makespans within 90 % of the simulated ones, share of cells that a KS test rejects).

    The 90 % are the middle ones. A cell is a configuration with one task set. The KS test is Kolmogorov and Smirnov's,
    at 5 %.
    """
    inside, told_apart = [], []
    for key, own in real.groupby(KEYS + ['tasks']):
        same = [simulated[name] == value for name, value in zip(KEYS + ['tasks'], key)]
        seeds = simulated[np.logical_and.reduce(same)]
        low, high = np.quantile(seeds.mission_s, [0.05, 0.95])
        inside.extend((own.mission_s >= low) & (own.mission_s <= high))
        told_apart.append(ks_2samp(own.mission_s, seeds.mission_s).pvalue < 0.05)
    return np.mean(inside), np.mean(told_apart)


def told_apart_if_right(real, simulated, chance):
    """Return the share of cells that the KS test would reject if each real cell were one of the simulated missions.

    The real missions of a cell are repetitions of one mission, so they may differ less than simulated ones. Here they
    lie around a simulated makespan, and differ from each other as they do (at most as simulated ones), so that in all
    they vary as simulated ones. Only missions that ended count.
    """
    rejected = []
    for key, own in real[real.ended == 1].groupby(KEYS + ['tasks']):
        same = [simulated[name] == value for name, value in zip(KEYS + ['tasks'], key)]
        seeds = simulated[np.logical_and.reduce(same) & (simulated.ended == 1)].mission_s.to_numpy()
        times, count = own.mission_s.to_numpy(), len(own)
        share = min(1.0, np.var(times, ddof=1) / np.var(seeds)) if count > 1 else 0.0
        apart = (times - times.mean()) * (np.sqrt(share * np.var(seeds) / np.var(times, ddof=1)) if share else 0.0)
        middles = seeds.mean() + (seeds - seeds.mean()) * np.sqrt(1.0 - share * (1.0 - 1.0 / count))
        rejected.append(np.mean([ks_2samp(chance.choice(middles) + apart, seeds).pvalue < 0.05 for _ in range(PLACES)]))
    return np.mean(rejected)


def quantile_plot(real, simulated, path):
    """Plot each real makespan against the simulated one at the same quantile of its cell, a panel for each level."""
    import matplotlib
    matplotlib.use('Agg')
    from matplotlib import pyplot
    levels = list(simulated.level.unique())
    figure, axes = pyplot.subplots(1, len(levels), figsize=(3.0 * len(levels), 3.3), sharex=True, sharey=True)
    cells = KEYS + ['tasks']
    for level, axis in zip(levels, np.atleast_1d(axes)):
        here = dict(list(simulated[simulated.level == level].groupby(cells)['mission_s']))
        for (name, color) in zip(sorted(real.map.unique()), ('tab:blue', 'tab:orange', 'tab:green')):
            pairs = [(value, np.quantile(here[key], (rank + 0.5) / len(own)))
                     for key, own in real[real.map == name].groupby(cells)['mission_s'] if key in here
                     for rank, value in enumerate(sorted(own))]
            axis.plot(*zip(*pairs), '.', color=color, label=name)
        axis.plot([20, 1000], [20, 1000], color='grey', linewidth=0.8)
        axis.set(title=level, xscale='log', yscale='log', xlabel='real makespan [s]')
    np.atleast_1d(axes)[0].set_ylabel('simulated, same quantile [s]')
    np.atleast_1d(axes)[0].legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(path, dpi=110)


def main(real_path, simulated_path, picture=None):
    """Print a table in Markdown, and write a picture if ``picture`` is given."""
    real, simulated = pd.read_csv(real_path), pd.read_csv(simulated_path)
    top = ceiling(real, np.random.default_rng(1))
    print('| level | simulated / real | in 90 % of the seeds | told apart (KS, 5 %) | SRCC | tau | same sign |')
    print('|---|---|---|---|---|---|---|')
    for level, own in simulated.groupby('level', sort=False):
        chance = np.random.default_rng(1)
        srcc, tau = with_intervals(real, own, chance)
        inside, apart = distributions(real, own)
        certain, same = pairs(real, own, chance)
        one, other = means(own).align(means(real), join='inner')  # same configurations and task sets
        print('| {} | {:.3f} | {:.0f} % | {:.0f} % | {:.2f} ({}) | {:.2f} ({}) | {} of {} |'.format(
            level, np.nanmean(one) / np.nanmean(other), 100 * inside, 100 * apart, *srcc, *tau, same, certain))
        right = told_apart_if_right(real, own, chance)
    print('| halves of the real missions | | | | {:.2f} | {:.2f} | |'.format(*top))
    if picture:
        quantile_plot(real, simulated, picture)
    print('\n{} real missions, {} of them ended by the limit.'.format(len(real), int((real.ended == 0).sum())))
    print('If the last level were right, {:.0f} % of the cells would be told apart (missions that ended): repetitions '
          'of a mission differ less than seeds.'.format(100 * right))


if __name__ == '__main__':
    main(*sys.argv[1:])
