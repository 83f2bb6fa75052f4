"""Maps from topics, the map of one robot, and the topics of costmaps and plans."""
