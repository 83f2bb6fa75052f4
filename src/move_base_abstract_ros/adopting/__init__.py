"""Launch files of others, as they are read where not all that they name is installed: robots, start poses, kinds."""
