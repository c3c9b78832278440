#!/usr/bin/env python3
"""loop_operator.py TARGET: an operator who knows the truth, for tests of `pitviper run --fly ROW --sight operator`: presses the key
until there are frames in the ring $PITVIPER_MEMORY (publish.memory_record=truth), then holds the line of sight of each to TARGET
(site:application:entity), by UDP to $PITVIPER_PORT; between them some garbage, and what is old."""
import math
import os
import pathlib
import socket
import sys
import threading

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / 'etc' / 'examples'))
from read_memory import Ring

target = tuple(map(int, sys.argv[1].split(':')))
port = int(os.environ['PITVIPER_PORT'])
seen = threading.Event()
with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as to:
    def say(text):
        to.sendto(text.encode(), ('127.0.0.1', port))

    def press():
        number = 0
        while not seen.wait(0.2):
            say(f'aim {number} 0 0 launch\n')
            number += 1

    key = threading.Thread(target=press, daemon=True)
    key.start()
    for frame in Ring(os.environ['PITVIPER_MEMORY'], 60).frames(in_order=True):
        seen.set()
        key.join()
        for t in frame.targets:
            if (t.site, t.application, t.entity) == target:
                number = 100000 + frame.record.frame
                say(f'aim {number} {math.degrees(t.los_az_rad):.6f} {math.degrees(t.los_el_rad):.6f}')
                say(f'aim {number} 5 5')  # old
                say('aim up')             # garbage
