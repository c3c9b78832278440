#!/usr/bin/env python3
"""Reads the frames that a Pitviper node puts into shared memory, as numpy arrays. No build step.

    pitviper run --memory seeker ...                 in one terminal
    etc/examples/read_memory.py seeker               in another

As a module:

    from read_memory import Ring
    for frame in Ring('seeker').frames():
        lwir = frame.planes['lwir/Y']                # a numpy array [height, width]
        print(frame.record.frame, lwir.max(), [t.class_name for t in frame.targets])

The structures are those of etc/include/pitviper_memory.h, described in etc/reference/memory.md. The memory is mapped
read-only: nothing here can disturb the node."""
import argparse
import ctypes
import errno
import fcntl
import json
import mmap
import os
import socket
import struct
import sys
import time

import numpy

u8, u16, u32, i32, u64, i64 = (ctypes.c_uint8, ctypes.c_uint16, ctypes.c_uint32, ctypes.c_int32, ctypes.c_uint64,
                               ctypes.c_int64)
f32, f64, text = ctypes.c_float, ctypes.c_double, ctypes.c_char
BYTE_ORDER, VERSION, RUNNING, FLOAT32, UINT16 = 0x01020304, 1, 1, 1, 2
TYPE = {FLOAT32: numpy.dtype(numpy.float32), UINT16: numpy.dtype(numpy.uint16)}


class Header(ctypes.Structure):
    _fields_ = [('magic', text * 8), ('byte_order', u32), ('version', u16), ('revision', u16), ('header_size', u32),
                ('plane_entry_size', u32), ('record_size', u32), ('target_size', u32), ('segment_size', u64),
                ('plane_offset', u64), ('slot_offset', u64), ('slot_size', u64), ('target_offset', u64),
                ('slot_count', u32), ('plane_count', u32), ('target_room', u32), ('kind', u32), ('epoch', u64),
                ('writer_pid', i32), ('detections_port', u32), ('host', text * 24), ('program', text * 24),
                ('config_sha256', text * 72), ('detections_version', u32), ('reserved', u8 * 28), ('newest', u64),
                ('wake', u32), ('state', u32), ('changed_ns', i64), ('reserved_changing', u8 * 40)]


class Plane(ctypes.Structure):
    _fields_ = [('band', u32), ('type', u32), ('width', u32), ('height', u32), ('offset', u64), ('bits', u32),
                ('reserved', u32), ('band_name', text * 16), ('name', text * 16), ('unit', text * 16),
                ('reserved_end', u8 * 16)]


class Record(ctypes.Structure):
    _fields_ = [('lock', u64), ('sequence', u64), ('frame', i32), ('flags', u32), ('time_s', f64), ('unix_us', i64),
                ('p_ecef', f64 * 3), ('v_ecef', f64 * 3), ('r_ecef_from_cam', f64 * 9), ('r_ecef_from_body', f64 * 9),
                ('boresight_ecef', f64 * 3), ('hfov_rad', f64), ('vfov_rad', f64), ('focal_px', f64),
                ('distortion', f64 * 5), ('scene_rate_px_s', f64 * 2), ('arrived_ns', i64), ('begun_ns', i64),
                ('posed_ns', i64), ('rendered_ns', i64), ('written_ns', i64), ('seed', i64), ('datagrams', u64),
                ('target_count', u32), ('targets_left_out', u32), ('host', text * 24), ('config_sha256', text * 72),
                ('reserved', u8 * 16)]


class TargetBand(ctypes.Structure):
    _fields_ = [('contrast_k', f64), ('dt_rss_k', f64), ('contrast', f64), ('snr', f64), ('intensity_w_sr', f64),
                ('smoke_transmittance', f64), ('reserved', f64 * 2)]


class Target(ctypes.Structure):
    _fields_ = [('site', u16), ('application', u16), ('entity', u16), ('class_number', u16), ('plane_value', u32),
                ('flags', u32), ('class_name', text * 24), ('marking', text * 16), ('type', text * 32),
                ('box', i32 * 4), ('amodal_box', f64 * 4), ('range_m', f64), ('closing_mps', f64), ('aspect_rad', f64),
                ('depression_rad', f64), ('los_az_rad', f64), ('los_el_rad', f64), ('los_rate_rps', f64 * 2),
                ('boresight_error_rad', f64 * 2), ('pixels', f64), ('visible_fraction', f64), ('p_ecef', f64 * 3),
                ('v_ecef', f64 * 3), ('age_s', f64), ('position_error_m', f64), ('reserved', u8 * 24),
                ('band', TargetBand * 4)]


for structure, octets in ((Header, 320), (Plane, 96), (Record, 512), (TargetBand, 64), (Target, 576)):
    assert ctypes.sizeof(structure) == octets, structure


class Refused(Exception):
    """Not a ring of frames that this reader understands."""


class Frame:
    """A copy: record, planes {'lwir/Y': array}, targets (publish.memory_record: truth)."""

    def __init__(self, record, planes, targets):
        self.record, self.planes, self.targets = record, planes, targets


class Ring:
    """A ring of frames, /dev/shm/NAME. wait_s: how long to wait for the node to start."""

    def __init__(self, name, wait_s=60.0):
        end = time.monotonic() + wait_s
        while True:
            try:
                self._open(name)
                if self.is_alive():
                    break
                self.close()
            except FileNotFoundError:
                pass
            if time.monotonic() > end:
                raise FileNotFoundError(errno.ENOENT, 'no node writes this ring', f'/dev/shm/{name}')
            time.sleep(0.01)
        newest = self._newest()
        self.taken, self.missed, self.torn = max(newest - self.header.slot_count, 0), 0, 0
        self.begun = False

    def _open(self, name):
        self.file = os.open(f'/dev/shm/{name}', os.O_RDONLY | os.O_CLOEXEC | os.O_NOFOLLOW)
        try:
            self.size = os.fstat(self.file).st_size
            if self.size < ctypes.sizeof(Header):
                raise Refused(name)
            self.memory = mmap.mmap(self.file, self.size, mmap.MAP_SHARED, mmap.PROT_READ)
            self.octets = numpy.frombuffer(self.memory, numpy.uint8)
            self.header = Header.from_buffer_copy(self.memory)
            self._check(name)
        except BaseException:
            os.close(self.file)
            raise

    def _check(self, name):
        h = self.header
        if (h.magic != b'PVMEMORY' or h.byte_order != BYTE_ORDER or h.version != VERSION or h.segment_size > self.size
                or h.header_size < 320 or h.plane_entry_size < 96 or h.record_size < 512 or h.target_size < 576):
            raise Refused(name)
        if (not 1 <= h.slot_count <= 1024 or not 1 <= h.plane_count <= 16 or h.target_room > 65536
                or h.slot_offset % 8 or h.slot_size % 8 or h.record_size > h.slot_size
                or h.target_offset + h.target_room * h.target_size > h.slot_size
                or h.slot_offset + h.slot_count * h.slot_size > h.segment_size
                or h.plane_offset + h.plane_count * h.plane_entry_size > h.segment_size):
            raise Refused(name)
        self.planes = [Plane.from_buffer_copy(self.memory, h.plane_offset + i * h.plane_entry_size)
                       for i in range(h.plane_count)]
        for p in self.planes:
            if p.type not in TYPE or p.offset % 8 or p.offset + self._plane_octets(p) > h.slot_size:
                raise Refused(name)

    @staticmethod
    def _plane_octets(p):
        return p.width * p.height * TYPE[p.type].itemsize

    def _word(self, offset):
        """8 octets at once: an aligned load."""
        return int(self.octets[offset:offset + 8].view(numpy.uint64)[0])

    def _newest(self):
        return self._word(Header.newest.offset)

    def is_alive(self):
        """Whether the node lives and has not closed the ring: it holds a lock on the file until it ends."""
        state = int(self.octets[Header.state.offset:Header.state.offset + 4].view(numpy.uint32)[0])
        lock = fcntl.fcntl(self.file, fcntl.F_OFD_GETLK, struct.pack('hhqqi4x', fcntl.F_RDLCK, 0, 0, 0, 0))
        return state == RUNNING and struct.unpack('hhqqi4x', lock)[0] != fcntl.F_UNLCK

    def wait(self, timeout_s=None):
        """True: there is a frame that was not taken; False: not in time. EOFError: the node has ended."""
        end = None if timeout_s is None else time.monotonic() + timeout_s
        address = self.octets.ctypes.data + Header.wake.offset
        while True:
            wake = int(self.octets[Header.wake.offset:Header.wake.offset + 4].view(numpy.uint32)[0])
            if self._newest() > self.taken:
                return True
            if not self.is_alive():
                if self._newest() > self.taken:
                    return True
                raise EOFError('the node has ended')
            left = 0.2 if end is None else min(0.2, end - time.monotonic())
            if left <= 0:
                return False
            self._futex(address, wake, left)

    _libc = ctypes.CDLL(None, use_errno=True)
    _futex_number = {'x86_64': 202, 'aarch64': 98}.get(os.uname().machine)

    def _futex(self, address, wake, seconds):
        """Sleeps until `wake` changes; where the system has no such call, for a moment."""
        limit = struct.pack('qq', int(seconds), int(seconds % 1 * 1e9))
        if self._futex_number is None:
            time.sleep(min(seconds, 0.0005))
        elif (self._libc.syscall(self._futex_number, ctypes.c_void_p(address), 0, u32(wake), limit, None, 0) != 0
                and ctypes.get_errno() not in (errno.EAGAIN, errno.EINTR, errno.ETIMEDOUT)):
            time.sleep(min(seconds, 0.0005))

    def _copy(self, n):
        """Frame n, or None: it is not there, or was overwritten meanwhile."""
        h = self.header
        slot = h.slot_offset + (n - 1) % h.slot_count * h.slot_size
        if self._word(slot) != 2 * n:
            return None
        record = Record.from_buffer_copy(self.memory, slot)
        record.target_count = min(record.target_count, h.target_room)
        targets = [Target.from_buffer_copy(self.memory, slot + h.target_offset + i * h.target_size)
                   for i in range(record.target_count)]
        planes = {}
        for p in self.planes:
            at = slot + p.offset
            values = self.octets[at:at + self._plane_octets(p)].view(TYPE[p.type]).reshape(p.height, p.width)
            planes[f'{p.band_name.decode()}/{p.name.decode()}'] = values.copy()
        if self._word(slot) != 2 * n:
            self.torn += 1
            return None
        return Frame(record, planes, targets)

    def take(self, in_order=False):
        """The newest frame, or in order from the oldest that the ring holds; None: there is none not taken before."""
        least = self.taken + 1
        for _ in range(16):
            newest = self._newest()
            if newest < least:
                return None
            least = newest if not in_order else max(least, newest - self.header.slot_count + 1)
            frame = self._copy(least)
            if frame:
                self.missed += least - self.taken - 1 if self.begun else 0
                self.taken, self.begun = least, True
                return frame
            if in_order:
                least += 1
        return None

    def frames(self, in_order=False):
        """Frame after frame, until the node ends."""
        try:
            while self.wait():
                frame = self.take(in_order)
                if frame:
                    yield frame
        except EOFError:
            return

    def close(self):
        self.octets = None  # the mapping goes with the last array that refers to it
        os.close(self.file)


def send_answer(to, port, frame, band, detections):
    """One datagram of JSON. A detection: class, score, box_px or los_deg (or both), track, range_m: etc/reference/answers.md."""
    to.sendto(json.dumps({'frame': frame, 'band': band, 'detections': detections}).encode(), ('127.0.0.1', port))


def brightest(plane):
    row, column = numpy.unravel_index(numpy.argmax(plane), plane.shape)
    return int(row), int(column)


def show(frame):
    r, now_ns = frame.record, time.clock_gettime_ns(time.CLOCK_MONOTONIC)
    print(f'frame {r.frame}  {r.time_s:.3f} s  {1e-6 * (now_ns - r.written_ns):.3f} ms since written, '
          f'{1e-6 * (now_ns - r.rendered_ns):.3f} ms since rendered', end='')
    for name, plane in frame.planes.items():
        row, column = brightest(plane)
        print(f'  {name} {plane[row, column]:.9g} at {column},{row}', end='')
    for t in frame.targets:
        print(f'  {t.class_name.decode()} {t.site}:{t.application}:{t.entity} box {" ".join(map(str, t.box))} '
              f'range {t.range_m:.1f} m', end='')
    print(flush=True)


def detect(to, ring, frame):
    """The brightest spot of each band, with a box of 9 x 9 pixels about it."""
    done = set()
    for p, plane in zip(ring.planes, frame.planes.values()):
        if p.band in done:
            continue
        done.add(p.band)
        row, column = brightest(plane)
        box = max(column - 4, 0), max(row - 4, 0), min(column + 5, p.width), min(row + 5, p.height)
        found = {'class': 'bright', 'score': 0.5, 'box_px': box, 'track': 1}
        send_answer(to, ring.header.detections_port, frame.record.frame, p.band_name.decode(), [found])


def main():
    options = argparse.ArgumentParser(description='Shows the frames of a Pitviper node in shared memory.')
    options.add_argument('name')
    options.add_argument('--in-order', action='store_true', help='every frame that the ring still holds, in order')
    options.add_argument('--frames', type=int, default=0, help='ends after so many')
    options.add_argument('--wait', type=float, default=60, help='gives up when there is no node after so many seconds')
    options.add_argument('--raw', metavar='FOLDER', help='each plane as FOLDER/FRAME_BAND_NAME.raw')
    options.add_argument('--slow', type=float, default=0, metavar='MS', help='waits so long after each frame')
    options.add_argument('--detect', action='store_true', help='sends the brightest spot of each band back')
    o = options.parse_args()
    try:
        ring = Ring(o.name, o.wait)
    except (OSError, Refused) as reason:
        sys.exit(f'read_memory.py: {reason}')
    to = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    if o.detect and not ring.header.detections_port:
        print('read_memory.py: the node takes no answers; set publish.detections_port', file=sys.stderr)
    count = 0
    for frame in ring.frames(o.in_order):
        show(frame)
        if o.raw:
            for name, plane in frame.planes.items():
                plane.tofile(f'{o.raw}/{frame.record.frame:06d}_{name.replace("/", "_")}.raw')
        if o.detect and ring.header.detections_port:
            detect(to, ring, frame)
        time.sleep(o.slow / 1000)
        count += 1
        if count == o.frames:
            break
    print(f'{count} frames read, {ring.missed} missed, {ring.torn} copies torn')


if __name__ == '__main__':
    main()
