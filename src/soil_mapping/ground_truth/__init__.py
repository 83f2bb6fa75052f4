"""What the robots measure: readings from files, drawn fields, and the grid that both are known on."""
