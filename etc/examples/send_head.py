#!/usr/bin/env python3
"""etc/examples/send_head.py: turns the eye of a node (`pitviper run --head ADDRESS:PORT`) by keys or a gamepad. No module beyond
Python's own.

    send_head.py ADDRESS:PORT [--relative] [--gamepad /dev/input/js0] [--hz 60]

Keys: a d left and right, w s up and down, q e roll, + - zoom, 1 .. 9 buttons, 0 back to the front, x ends it. Gamepad: left stick
turns, the right stick's vertical axis zooms. Layout of a datagram: etc/reference/head.md."""
import argparse
import os
import select
import socket
import struct
import sys
import termios
import time
import tty

RATE_DPS, STEP_DEG = 30.0, 0.5


class Pose:
    def __init__(self):
        self.yaw = self.pitch = self.roll = 0.0
        self.zoom, self.buttons, self.sequence = 1.0, 0, 0

    def turn(self, yaw=0.0, pitch=0.0, roll=0.0, zoom=1.0):
        self.yaw = (self.yaw + yaw + 180) % 360 - 180
        self.pitch = min(90.0, max(-90.0, self.pitch + pitch))
        self.roll = (self.roll + roll + 180) % 360 - 180
        self.zoom = min(100.0, max(0.05, self.zoom * zoom))

    def datagram(self, relative):
        self.sequence = (self.sequence + 1) % 2**32
        return struct.pack('>4sHHIIQ4f', b'PVHD', 1, 2 if relative else 0, self.sequence, self.buttons,
                           time.monotonic_ns() // 1000, self.yaw, self.pitch, self.roll, self.zoom)


def take_key(pose, key):
    """False: it ends."""
    turns = {'a': (-STEP_DEG, 0, 0), 'd': (STEP_DEG, 0, 0), 'w': (0, STEP_DEG, 0), 's': (0, -STEP_DEG, 0),
             'q': (0, 0, -STEP_DEG), 'e': (0, 0, STEP_DEG)}
    if key in turns:
        pose.turn(*turns[key])
    elif key in '+-':
        pose.turn(zoom=1.05 if key == '+' else 1 / 1.05)
    elif key in '123456789':
        pose.buttons ^= 1 << (int(key) - 1)
    elif key == '0':
        pose.yaw = pose.pitch = pose.roll = 0.0
        pose.zoom = 1.0
    return key != 'x'


def take_events(octets, axes, pose):
    """Of Linux's joystick interface: time, value, type (1 button, 2 axis; 128 at the start), number."""
    for at in range(0, len(octets) // 8 * 8, 8):
        _, value, kind, number = struct.unpack('=IhBB', octets[at:at + 8])
        if kind & 127 == 2:
            axes[number] = value / 32767
        elif kind & 127 == 1 and number < 32:
            pose.buttons = pose.buttons & ~(1 << number) | value << number


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument('to')
    options.add_argument('--relative', action='store_true', help='to the body of what carries the eye')
    options.add_argument('--gamepad', help='a joystick device, as /dev/input/js0')
    options.add_argument('--hz', type=float, default=60.0)
    given = options.parse_args()
    address, port = given.to.rsplit(':', 1)
    udp = socket.socket(socket.AF_INET6 if ':' in address else socket.AF_INET, socket.SOCK_DGRAM)
    to = (address.strip('[]'), int(port))
    pose, axes = Pose(), {}
    pad = open(given.gamepad, 'rb', buffering=0) if given.gamepad else None
    before = termios.tcgetattr(sys.stdin) if sys.stdin.isatty() else None
    if before:
        tty.setcbreak(sys.stdin)
    try:
        step_s, due_s = 1 / given.hz, time.monotonic()
        while True:
            due_s = max(due_s + step_s, time.monotonic())
            sources = [source for source in (pad, sys.stdin if before else None) if source]
            while (left_s := due_s - time.monotonic()) > 0:
                for source in select.select(sources, [], [], left_s)[0]:
                    if source is pad:
                        take_events(pad.read(512), axes, pose)
                    elif not take_key(pose, os.read(sys.stdin.fileno(), 1).decode(errors='replace')):
                        return
            stick = {n: v for n, v in axes.items() if abs(v) > 0.08}  # it never rests at 0
            pose.turn(RATE_DPS * step_s * stick.get(0, 0), -RATE_DPS * step_s * stick.get(1, 0),
                      zoom=2.0 ** (-step_s * stick.get(4, 0)))
            udp.sendto(pose.datagram(given.relative), to)
            if before:
                print(f'\ryaw {pose.yaw:8.2f}  pitch {pose.pitch:7.2f}  roll {pose.roll:7.2f}  zoom {pose.zoom:5.2f} ',
                      end='', flush=True)
    except KeyboardInterrupt:
        pass
    finally:
        if before:
            termios.tcsetattr(sys.stdin, termios.TCSADRAIN, before)
            print()


if __name__ == '__main__':
    main()
