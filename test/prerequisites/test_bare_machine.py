"""What users type on a bare Debian works: the README's two commands, the site, and all tutorials in turn."""
import os
import subprocess

import bare
import pytest

TOOL = str(bare.ROOT / 'tools' / 'bare_machine')
SKIPPED = 77


def on_a_bare_machine(*command, **environment):
    return subprocess.run(['bash', TOOL, *command], env={**os.environ, **environment}, stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)


@pytest.mark.night
@pytest.mark.parametrize('command', [
    ('bash', '-ec', 'make demo; make test'), ('make', 'docs'), ('bash', 'test/prerequisites/in_turn')],
    ids=['demo_and_test', 'docs', 'tutorials_in_turn'])
def test_a_command_succeeds_on_a_bare_debian(command):
    done = on_a_bare_machine(*command)
    if done.returncode == SKIPPED:
        pytest.skip(done.stdout.splitlines()[-1])
    failed = [line for line in done.stdout.splitlines() if line.startswith('FAIL')]  # steps of `make test`
    assert done.returncode == 0, '\n'.join([*failed, done.stdout[-20000:]])


@pytest.mark.parametrize('command, environment, said', [
    ((), {}, 'no command was given'),
    (('true',), {'SUITE': 'sarge'}, 'SUITE=sarge: allowed: bookworm, trixie, bullseye')])
def test_wrong_arguments_are_told(command, environment, said):
    done = on_a_bare_machine(*command, **environment)
    assert done.returncode == 2 and said in done.stdout


def test_without_debootstrap_it_is_skipped_with_a_message(tmp_path):
    done = on_a_bare_machine('true', SUITE='bookworm', PATH=str(programs(tmp_path)))
    wanted = 'it needs root' if os.getuid() else 'debootstrap is not there; to install it: apt-get install debootstrap'
    assert (done.returncode, done.stdout) == (SKIPPED, f'tools/bare_machine: skipped: {wanted}\n')


def programs(folder):
    """Return a folder with the programs that the tool uses first, and no others."""
    for name in ('env', 'bash', 'dirname', 'id'):
        (folder / name).symlink_to(f'/usr/bin/{name}')
    return folder
