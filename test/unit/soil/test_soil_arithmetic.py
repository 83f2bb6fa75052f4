"""What decides a trial is the same on every processor: other kernels of BLAS, other instructions of numpy and libm."""

import os
import platform
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from soil_mapping.interpolation import arithmetic
from soil_mapping.results.provenance import blas_kernels

SOURCE = Path(__file__).resolve().parents[3] / 'src'
WIDE = 'AVX512F AVX512CD AVX512_SKX AVX512_CLX AVX512_CNL AVX512_ICL'
# Name: the flags of /proc/cpuinfo that it needs, and what makes libraries take this processor for one of its kind.
PROCESSORS = {
    'SSE3': (('pni',), {'OPENBLAS_CORETYPE': 'Prescott', 'NPY_DISABLE_CPU_FEATURES': f'AVX2 FMA3 {WIDE}',
                        'GLIBC_TUNABLES': 'glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX512F'}),
    'AVX2': (('avx2', 'fma'), {'OPENBLAS_CORETYPE': 'Haswell', 'NPY_DISABLE_CPU_FEATURES': WIDE}),
    'AVX512': (('avx512f', 'avx512dq', 'avx512cd', 'avx512bw', 'avx512vl'), {'OPENBLAS_CORETYPE': 'SkylakeX'}),
}
TRIALS = """
import hashlib, sys
from soil_mapping.config import TrialConfig
from soil_mapping.ground_truth.field import load_field
from soil_mapping.mesa_models.mesa_model import run_mesa_trial
for source, crs in (('synthetic', 'degrees'), ('csv:' + sys.argv[1], 'metres'), ('csv:' + sys.argv[2], 'degrees')):
    truth = load_field(source, crs=crs)
    for allocation, sampling in (('ssi', 'dynamic'), ('rr', 'random')):
        config = TrialConfig(field=source, crs=crs, allocation=allocation, sampling=sampling, budget_s=100.0)
        result = run_mesa_trial(config, 1, truth=truth)
        maps = hashlib.sha256(truth.values.tobytes() + result.prediction.tobytes() + result.variance.tobytes())
        print(maps.hexdigest(), result.metrics, *result.events, sep=chr(10))
"""


def runs_here(flags):
    """Return whether this processor has the flags; one that is no x86 has none."""
    if platform.machine() != 'x86_64':
        return False
    lines = Path('/proc/cpuinfo').read_text(encoding='utf-8').splitlines()
    return set(flags) <= set(next(line for line in lines if line.startswith('flags')).split())


def output_on(changes, script, *words):
    environment = {name: value for name, value in os.environ.items() if name not in (
        'OPENBLAS_CORETYPE', 'NPY_DISABLE_CPU_FEATURES', 'GLIBC_TUNABLES')}
    environment.update(changes, PYTHONPATH=str(SOURCE), PYTHONWARNINGS='ignore', OPENBLAS_NUM_THREADS='1')
    return subprocess.run([sys.executable, '-c', script, *map(str, words)], env=environment, capture_output=True,
                          text=True, check=True, stdin=subprocess.DEVNULL, timeout=600).stdout


@pytest.fixture(scope='module')
def readings(tmp_path_factory):
    """Two files of noisy readings: in metres, and in degrees."""
    folder, chance = tmp_path_factory.mktemp('readings'), np.random.default_rng(5)
    places = chance.uniform(0.0, (300.0, 200.0), size=(90, 2)).round(2)
    values = (800.0 + 0.1 * places[:, 0] - 0.001 * places[:, 1] ** 2 + chance.uniform(-5.0, 5.0, 90)).round(1)
    for name, header, scale in (('metres.csv', 'x,y,v', 1.0), ('degrees.csv', 'lon,lat,v', 1e-5)):
        rows = [f'{x * scale:.7f},{y * scale + 50.0:.7f},{v}' for (x, y), v in zip(places, values)]
        (folder / name).write_text('\n'.join([header, *rows, '']))
    return folder / 'metres.csv', folder / 'degrees.csv'


@pytest.mark.night  # a process for each kind
def test_trials_are_identical_on_every_kind_of_processor(readings):
    pytest.importorskip('mesa', reason='Mesa is not installed; it needs Python 3.11')
    here = output_on({}, TRIALS, *readings).splitlines()
    assert len(here) > 100
    for name, (flags, changes) in PROCESSORS.items():
        if runs_here(flags):
            assert output_on(changes, TRIALS, *readings).splitlines() == here, name


def test_sums_products_exp_and_log_are_exact_enough():
    chance = np.random.default_rng(1)
    x = -chance.uniform(0.0, 300.0, 10000)
    np.testing.assert_allclose(arithmetic.exp(x), np.exp(x), rtol=4e-16)
    assert arithmetic.exp(np.array([0.0, -1e9, -np.inf])).tolist() == [1.0, *[arithmetic.exp(-300.0)] * 2]
    y = np.exp(chance.uniform(-700.0, 700.0, 10000))
    np.testing.assert_allclose(arithmetic.log(y), np.log(y), rtol=1e-15, atol=1e-15)
    assert arithmetic.log(np.array([1.0])) == 0.0
    for count in (1, 2, 3, 1000, 1001):
        assert arithmetic.mean(y[:count]) == pytest.approx(y[:count].mean(), rel=1e-14)
    left, right = chance.uniform(-1.0, 1.0, (3, 512)), chance.uniform(0.0, 1.0, (512, 40))
    found = arithmetic.product(arithmetic.slices(left), arithmetic.slices(right))
    np.testing.assert_allclose(found, left @ right, rtol=0.0, atol=512 * 2.0**-43)


def test_nothing_is_rounded_in_what_blas_sums():
    """The greatest numbers that may come, all of one sign: every partial sum is a whole number below 2^53."""
    ones = np.ones((1, arithmetic.MOST_TERMS))
    high, low = arithmetic.slices(ones * (1.0 - 2.0**-23))
    high, low = high * arithmetic.SLICE, low * arithmetic.SLICE ** 2
    assert (high, low) == (pytest.approx(arithmetic.SLICE), pytest.approx(-arithmetic.SLICE / 2.0))
    greatest = float(np.abs(high).max())
    assert arithmetic.MOST_TERMS * greatest * greatest <= 2.0**53
    assert 2 * arithmetic.MOST_TERMS * greatest * float(np.abs(low).max()) <= 2.0**53


def test_the_kernel_of_blas_is_told():
    kernels = blas_kernels()
    libraries = {line.split()[-1].rpartition('/')[2] for line in Path('/proc/self/maps').read_text().splitlines()
                 if line.endswith('.so') or '.so.' in line}
    assert len(kernels) == sum(name.startswith(('libopenblas', 'libscipy_openblas')) for name in libraries)
    assert all(len(kernel.split()) == 2 for kernel in kernels)
