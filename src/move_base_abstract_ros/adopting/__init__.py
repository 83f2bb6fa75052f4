"""Read launch files of others, if not everything that they name is installed: robots, start poses, kinds of nodes."""
