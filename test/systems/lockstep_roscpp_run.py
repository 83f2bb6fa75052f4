"""Runs of unmodified roscpp binaries in lockstep, for the tests of the shim: the event log has every message.

    run = Runs().run([Program('rate', own('shim_rate'), frequency=7.0), recorder('/ticks')])
    run.printed(1)                                    # the std_msgs/String messages, with their times
"""

import os
import signal

import rosgraph
from in_lockstep import Logged
from lockstep_library_run import assert_heard, look_on
from scenarios import Condition, repeated
from waiting import GUARD, ask_why, read, wait_for_end
from warm import Loopback

from move_base_abstract_ros.loopback import find_executable

# the tests read the programs' logs while they run
os.environ['ROSCONSOLE_STDOUT_LINE_BUFFERED'] = '1'


def own(name):
    """Return the path of a node of test/cpp_nodes."""
    return find_executable(name)


class Program:
    """A binary, its node name, its arguments and its private parameters."""

    def __init__(self, name, path, *arguments, options=(), remaps=(), launcher=(), ends_by=signal.SIGINT,
                 **parameters):
        self.name = name
        self.ends_by = ends_by  # a signal; SIGINT, as from Ctrl-C and roslaunch, needs a thread that spins
        self.path = path
        self.arguments = list(arguments)
        self.launcher = list(launcher)  # instead of ours
        self.options = list(options)  # options of the launcher
        self.remaps = list(remaps)
        self.parameters = parameters


def recorder(*topics):
    """Return a program that prints the std_msgs/String messages on the topics, with the time."""
    return Program('recorder', own('shim_recorder'), topics=list(topics))


class Run(Logged):
    """The results of a run: its messages and calls, its labels, and the output of the programs."""

    def __init__(self, path, code, outputs, parameters, why):
        self.read_log(path)
        self.events = [event for event in self.events if event[2] in ('message', 'call', 'response')]
        self.labels = self.end['not_repeatable_because']
        self.reason = self.end['reason']
        self.code = code
        self.outputs = outputs
        self.parameters = parameters  # of the first program, after its end
        self.why = why  # output of `why` at that time, if it was asked

    def until(self, seconds):
        """Return the messages and calls before a simulated time [s]."""
        return [event for event in self.events if event[0] < seconds * 1e9]

    def printed(self, program):
        """Return the lines that a recorder has printed; program: its index in the list."""
        return [line for line in self.outputs[program].splitlines() if line and '\x1b' not in line]


class Runs:
    """Runs one after the other, each under a ROS master of its own."""

    def __init__(self):
        self.ros = None

    def parameters(self, program):
        master = rosgraph.Master('/run', master_uri=self.ros.uri)
        return master.getParam('/' + program.name) if master.hasParam('/' + program.name) else {}

    def scenario(self, programs, until=1e9):
        """Run programs as a scenario; return the runs, whose events must be the same before ``until`` [s]."""
        name = ', '.join(' '.join([program.name, *map(str, program.parameters.values())]) for program in programs)
        return repeated(name, lambda condition: self.run(programs, condition=condition),
                        lambda run: repr(run.until(until)).encode())

    def run(self, programs, condition=Condition(), ask_why=False, onlook=(), **parameters):
        """Run until the first program has ended by itself; then end the others.

        onlook: topics to which onlookers listen; they come during the run, and each must hear a message.
        condition: what else happens meanwhile; parameters: of the time master.
        """
        with Loopback(is_warm=condition.is_warm) as self.ros:
            path = os.path.join(self.ros.log_dir, 'events.jsonl')
            master = self.ros.run('time_master', 'time_master', parameters={
                'mode': 'lockstep', 'participants': [f'/{program.name}' for program in programs], 'event_log': path,
                'log_messages': True, **condition.clock, **parameters})
            with condition.around():
                children = [self.start(program) for program in programs]
                onlookers = [look_on(self.ros, topic) for topic in onlook]
                code = wait_for_end(children[0], {child.name: child for child in children})
                for onlooker in onlookers:
                    assert_heard(onlooker)
                values = self.parameters(programs[0])
                why = self.ask_why() if ask_why else ''
            for child, program in zip(children, programs):
                child.signal(program.ends_by)
            for child in children:
                child.process.wait(GUARD)
            self.ros.end(master)
            return Run(path, code, [read(child) for child in children], values, why)

    def ask_why(self):
        return ask_why(self.ros)

    def start(self, program):
        for key, value in program.parameters.items():
            self.ros.set_param(f'/{program.name}/{key}', value(self.ros) if callable(value) else value)
        space, _, name = program.name.rpartition('/')
        return self.ros.spawn('/' + program.name, [
            *(program.launcher or [find_executable('lockstep')]), *program.options, program.path, *program.arguments,
            *program.remaps, f'__name:={name}', *([f'__ns:=/{space}'] if space else [])])


def take_name(ros, name):
    """Register another node of this name at the ROS master, and unregister it at once."""
    master = rosgraph.Master(name, master_uri=ros.uri)
    newcomer = 'http://127.0.0.1:1/'
    master.registerPublisher('/elsewhere', 'std_msgs/String', newcomer)
    master.unregisterPublisher('/elsewhere', newcomer)
