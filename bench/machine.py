"""Describes the machine and the versions from which the figures come."""

import os
import platform
import subprocess

import actionlib
import psutil
import rospkg


def describe():
    """Return the machine's description as a JSON-able dictionary."""
    return {'kind': 'machine', 'cpu': _cpu_model(), 'cores': psutil.cpu_count(), 'load_1min': os.getloadavg()[0],
            'memory_gib': round(psutil.virtual_memory().total / 2 ** 30, 1), 'kernel': platform.release(),
            'system': _system(), 'python': platform.python_version(), 'rospy': _version('rospy'),
            'actionlib': _version('actionlib') or _debian_version(actionlib), 'package': _version('move_base_abstract')}


def _cpu_model():
    with open('/proc/cpuinfo', encoding='utf-8') as info:
        for line in info:
            if line.startswith('model name'):
                return line.partition(':')[2].strip()
    return platform.machine()


def _system():
    with open('/etc/os-release', encoding='utf-8') as release:
        names = dict(line.rstrip('\n').partition('=')[::2] for line in release if '=' in line)
    return names.get('PRETTY_NAME', 'unknown').strip('"')


def _version(package):
    try:
        return rospkg.RosPack().get_manifest(package).version
    except rospkg.ResourceNotFound:
        return None


def _debian_version(module):
    """Return the version of the Debian package that holds the module, or None."""
    try:
        owner = subprocess.run(['dpkg', '-S', module.__file__], capture_output=True, text=True, check=True).stdout
        return subprocess.run(['dpkg-query', '-W', '-f', '${Version}', owner.partition(':')[0]], capture_output=True,
                              text=True, check=True).stdout
    except (OSError, subprocess.CalledProcessError):
        return None
