"""Frames in tf: publishing, looking up, and a watch for other nodes that publish the same frames."""
