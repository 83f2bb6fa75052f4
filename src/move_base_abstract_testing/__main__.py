"""A test that is debugged: python3 -m move_base_abstract_testing. The program `debug` starts it."""
from .debugged import main

main()
