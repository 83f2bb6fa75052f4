"""Exchange with the time master: the connection, topics, services, and played output."""
