"""What recordings of a real robot say of how long its legs take: read, fitted, checked, written for the simulator."""
