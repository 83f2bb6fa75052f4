"""Debug a run in lockstep: stop it anywhere, look into it, go on and go back."""
#: the name of the note, in the folder of notes of a debugged run, with the address of its ROS master
MASTER_NOTE = 'master'
#: the time master's parameters in a debugged run; it keeps messages of each topic
PARAMETERS = {'start_stopped': True, 'keep_messages': 20}
