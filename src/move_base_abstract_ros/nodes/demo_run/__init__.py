"""What the program demo is made of: its nodes, its mission, what it tells."""
