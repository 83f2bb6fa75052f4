"""Exchange with the time master: the connection, topics, services, and foreseen turns."""
