"""The nodes and programs of orders: the dispatcher, the report of a fleet."""
