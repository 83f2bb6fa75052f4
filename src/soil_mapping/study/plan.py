"""Which trials a study is made of."""

from dataclasses import replace

from soil_mapping.config import PUBLISHED_CONFIGURATIONS, Allocation, Sampling

from .spec import TrialSpec

SCALED_FACTORS = (10.0, 15.0, 100.0)
LIMIT = 20.0  # simulated s per wall s


def plan(config, seeds, scaled_seeds, cores, with_1x=False, clusters=True):
    """Return the TrialSpecs of a study, those first that much depends on.

    config: a TrialConfig; allocation and sampling are replaced by each of the four published configurations.
    clusters: whether the field is the published one's size, so that eight directions can have its coarse cells.
    seeds, scaled_seeds: how many seeds, from 0; the second one for the scaled clock, which takes its time.
    """
    configs = [replace(config, allocation=Allocation(allocation), sampling=Sampling(sampling))
               for allocation, sampling in PUBLISHED_CONFIGURATIONS]
    mesa = [TrialSpec(config=each, seed=seed, engine='mesa') for seed in range(seeds) for each in configs]
    lockstep = [replace(spec, engine='ros') for spec in mesa]
    coarse = 'clusters' if clusters else 'squares'
    eight = [replace(spec, motion='eight', config=replace(spec.config, cell_m=2, coarse_cells=coarse))
             for spec in mesa]
    factors = ((1.0,) if with_1x else ()) + SCALED_FACTORS
    scaled = [TrialSpec(config=each, seed=seed, clock='scaled', factor=factor)
              for factor in reversed(factors) for seed in range(scaled_seeds) for each in configs]
    return mesa + eight + lockstep + repetitions(configs, cores) + scaled


def repetitions(configs, cores):
    """Return trials that are to be the same as those at full speed: once more, limited, under load, and both."""
    return [TrialSpec(config=config, again=again, limit=limit, load=load) for config in configs
            for again, limit, load in ((1, 0.0, 0), (0, LIMIT, 0), (0, 0.0, cores), (0, LIMIT, cores))]
