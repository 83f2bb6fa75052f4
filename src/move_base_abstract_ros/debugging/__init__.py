"""Debug a run in lockstep: stop it anywhere, look into it, go on and go back."""
#: the name of the note, in the folder of notes of a debugged run, with the address of its ROS master
MASTER_NOTE = 'master'
