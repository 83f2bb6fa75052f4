# shellcheck shell=bash disable=SC1090
# Sourced by .ws/setup.sh in bash: rosrun offers the programs of this package, too. rosbash looks into no folder that begins
# with a dot, and all that is built here is in .ws.
_move_base_abstract_rosrun() {
  local file programs
  for file in /usr/share/bash-completion/completions/rosbash /opt/ros/*/share/rosbash/rosbash; do
    declare -F _roscomplete_exe >/dev/null || [ ! -e "$file" ] || . "$file"
  done
  complete -F _move_base_abstract_rosrun rosrun
  _roscomplete_exe "$@"
  if [ "$COMP_CWORD:${COMP_WORDS[1]}" = 2:move_base_abstract ]; then
    programs=$(ls "$(catkin_find --first-only --without-underlays --libexec move_base_abstract)")
    mapfile -t -O "${#COMPREPLY[@]}" COMPREPLY < <(compgen -W "$programs" -- "${COMP_WORDS[2]}")
  fi
}
complete -F _move_base_abstract_rosrun rosrun
