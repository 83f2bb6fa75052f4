"""The nodes and programs that send a fleet to work: the dispatcher, the driver of MAPF plans, the report of a fleet."""
