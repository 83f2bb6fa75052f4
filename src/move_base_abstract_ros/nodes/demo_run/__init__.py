"""The parts of the program demo: its nodes, its mission, its output."""
