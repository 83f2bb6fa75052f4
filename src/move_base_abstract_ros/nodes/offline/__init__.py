"""Programs that are no nodes, and live in packages of their own."""
