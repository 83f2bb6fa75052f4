"""Verify: which runs can be compared with each other."""
from types import SimpleNamespace

import pytest

from move_base_abstract_ros.launching.verification import Verification  # noqa: TID251 - it knows no ROS


@pytest.mark.parametrize('output, crashes, can, said', [
    ('lockstep_launch: fleets: /fleet, /b\n', [], True, []), ('x\n', [], False, []),
    ('lockstep_launch: fleets: /fleet\n', ['/fleet_watch crashed at 3.0 s: exit code 1'], True, []),
    ('lockstep_launch: fleets: /a, /fleet\n', ['/fleet crashed at 3.0 s: exit code 1'], False, [
        'split: not run: in two processes a fleet has other names, and /fleet crashed at 3.0 s: exit code 1'])])
def test_a_fleet_that_crashed_is_not_compared_with_one_in_two_processes(tmp_path, output, crashes, can, said):
    (tmp_path / 'output.txt').write_text(output)
    told = []
    verification = Verification([], str(tmp_path), 1.0, told.append)
    verification.runs.append(SimpleNamespace(output=str(tmp_path / 'output.txt'), crashes=crashes))
    assert (verification._can_split(), told) == (can, said)
