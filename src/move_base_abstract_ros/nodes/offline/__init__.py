"""Programs that are not nodes. Their code is in packages of their own."""
