"""Programs that look after others outlive those who read what they say."""
import os
import subprocess
import sys
from pathlib import Path

PROGRAM = """
import sys
from move_base_abstract.common.lasting_output import outlive_readers
if {lasts}:
    outlive_readers()
print('first', flush=True)
sys.stdin.readline()  # nobody reads any more
for _ in range(3):
    print('said to nobody', flush=True)
print('to nobody', file=sys.stderr, flush=True)
with open(sys.argv[1], 'w') as stream:
    stream.write('finished')
"""


def run(tmp_path, lasts):
    path = tmp_path / 'result'
    sources = str(Path(__file__).resolve().parents[2] / 'src')
    program = subprocess.Popen([sys.executable, '-c', PROGRAM.format(lasts=lasts), str(path)], stdin=subprocess.PIPE,
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                               env=dict(os.environ, PYTHONPATH=sources))
    assert program.stdout.readline() == 'first\n'
    program.stdout.close()
    program.stderr.close()
    program.stdin.write('\n')
    program.stdin.close()
    return program.wait(20), path.exists()


def test_a_program_goes_on_to_its_end_when_nobody_reads_it_any_more(tmp_path):
    assert run(tmp_path, True) == (0, True)


def test_without_it_the_program_breaks_off(tmp_path):
    code, is_finished = run(tmp_path, False)
    assert code != 0
    assert not is_finished
