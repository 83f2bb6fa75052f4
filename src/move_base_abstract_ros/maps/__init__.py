"""Maps from topics, the map as one robot uses it, and the topics of costmaps and plans."""
