"""What a shell offers after `rosrun` or `roslaunch move_base_abstract <tab>`, and what the pages say."""
import re
import subprocess
from pathlib import Path

PAGE = Path(__file__).resolve().parents[1] / 'docs' / 'what_there_is.md'
ROSBASH = '/usr/share/bash-completion/completions/rosbash'
ROSBASH_OF_NOETIC = '/opt/ros/noetic/share/rosbash/rosbash'
# `complete -p` prints the function that completes the words of a command.
ASK = r"""
for file in "$2" "$3"; do [ ! -e "$file" ] || { . "$file"; break; }; done
COMP_WORDS=("$1" move_base_abstract '') COMP_CWORD=2
$(complete -p "$1" | sed 's/.*-F \([^ ]*\).*/\1/')
printf '%s\n' "${COMPREPLY[@]}"
"""


def offered(command, env):
    """Return the names that bash offers as the second word of rosrun or roslaunch, in order, each once."""
    done = subprocess.run(['bash', '-c', ASK, 'bash', command, ROSBASH, ROSBASH_OF_NOETIC], env=env, check=True,
                          stdout=subprocess.PIPE, stdin=subprocess.DEVNULL, text=True)
    return sorted(set(done.stdout.split()))


def documented(section):
    """Return the names in the first column of a section's table, in order."""
    text = PAGE.read_text().split(f'\n## {section}\n')[1].split('\n## ')[0]
    cells = [line.split('|')[1] for line in text.splitlines() if line.startswith('|')]
    return sorted(name for cell in cells for name in re.findall('`([^`]+)`', cell))
