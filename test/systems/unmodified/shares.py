#!/usr/bin/env python3
"""Write files in all the ways that programs have, or read them: shares.py writes|reads FOLDER."""
import json
import logging
import os
import shutil
import sqlite3
import sys

import numpy
import rospy


def note(path):
    with open(path, 'a') as stream:
        stream.write('1\n')


def create(path):
    os.close(os.open(path, os.O_CREAT | os.O_WRONLY))


def replace(path):
    own = path + '.of_%s' % sys.argv[1]
    with open(own, 'w') as stream:
        json.dump([1], stream)
    os.replace(own, path)


def claim(path):
    os.rename(path, path + '.of_%s' % sys.argv[1])


def store(path):
    sqlite3.connect(path).execute('create table if not exists goals (x)')


def log(path):
    logger = logging.Logger('own')
    logger.addHandler(logging.FileHandler(path))
    logger.error('so it is')


WAYS = {'note': note, 'asked': note, 'create': create, 'replace': replace, 'claim': claim, 'store': store, 'log': log,
        'save': lambda path: numpy.savetxt(path, [1.0]), 'copy': lambda path: shutil.copyfile(__file__, path),
        '/dev/null': note, '__pycache__/kept': note}


def look(path):
    if path == 'asked':
        return os.path.exists(path) and os.access(path, os.R_OK)
    try:
        with open(path, 'rb') as stream:
            return stream.read(1)
    except OSError:
        return b''


def main():
    what, folder = sys.argv[1:3]
    os.chdir(folder)
    look('settings')
    look(__file__)
    os.path.exists('note')
    WAYS['note']('of_' + what)
    for name, way in WAYS.items():
        (way if what == 'writes' else look)(name)
        rospy.init_node('shares')  # files that were used before it are reported, too
    (note if what == 'writes' else look)(b'odd \xff')


main()
