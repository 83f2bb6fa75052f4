"""The command replay without ROS: python3 -m move_base_abstract_replay RUN.jsonl -o RUN.html."""
from .command import main

main()
