"""What a shell offers after `rosrun` or `roslaunch move_base_abstract <tab>`, and what the pages say."""
import re
import subprocess
from pathlib import Path

PAGE = Path(__file__).resolve().parents[1] / 'docs' / 'what_there_is.md'
ROSBASH = '/usr/share/bash-completion/completions/rosbash'
ROSBASH_OF_NOETIC = '/opt/ros/noetic/share/rosbash/rosbash'
# `complete -p` prints the function that completes the words of a command.
ASK = r"""
if [ -n "$2" ]; then . "$2"; else for file in "$3" "$4"; do [ ! -e "$file" ] || { . "$file"; break; }; done; fi
COMP_WORDS=("$1" move_base_abstract '') COMP_CWORD=2
$(complete -p "$1" | sed 's/.*-F \([^ ]*\).*/\1/')
printf '%s\n' "${COMPREPLY[@]}"
"""


def offered(command, env, setup=''):
    """Return the names that bash offers as the second word of rosrun or roslaunch, in order, each once.

    ``setup``: a file that the shell sources; otherwise it has rosbash alone.
    """
    done = subprocess.run(['bash', '-c', ASK, 'bash', command, setup, ROSBASH, ROSBASH_OF_NOETIC], env=env, check=True,
                          stdout=subprocess.PIPE, stdin=subprocess.DEVNULL, text=True)
    return sorted(set(done.stdout.split()))


def documented(section):
    """Return the names in the first column of a section's table, in order."""
    text = PAGE.read_text().split(f'\n## {section}\n')[1].split('\n## ')[0]
    cells = [line.split('|')[1] for line in text.splitlines() if line.startswith('|')]
    return sorted(name for cell in cells for name in re.findall('`([^`]+)`', cell))
