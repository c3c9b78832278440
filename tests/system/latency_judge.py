#!/usr/bin/env python3
"""When the last octet of each frame's video arrived, judged outside the node.

    latency_judge.py NAME PORT OUT NODE [--frames N]

Receives the MPEG-TS stream of one band on 127.0.0.1 and notes the kernel's stamp of every datagram; meanwhile the frames' end of
rendering is read from the ring /dev/shm/NAME. A frame is known in both by its time: the PTS of its packets, unix_us of its record.
It ends when the ring or the process NODE does, or N frames arrived. Prints p50, p99 and the largest time from the end of rendering to the last octet's
arrival; and, of the frames in OUT/truth.jsonl (all written when the node has ended), how much later than that the node's own ledger
is. The ledger's stamp is taken after the send, so it is never the earlier one; a frame for which it is fails."""
import argparse
import json
import mmap
import os
import socket
import struct
import sys
import threading
import time

SO_TIMESTAMPNS = 35
CLOSED, WRAP = 2, 1 << 33
SLACK_NS = 1_000_000  # of the difference of two clocks, which a daemon may turn while this runs


def ring_frames(name, out, over, node):
    """Fills out: PTS -> (rendered_ns, frame), until the ring is closed or the node has ended; then sets over."""
    path = f'/dev/shm/{name}'
    while not os.path.exists(path):
        time.sleep(0.01)
        if not os.path.exists(f'/proc/{node}'):
            over.set()
            return
    time.sleep(0.1)  # its header
    with open(path, 'rb') as file:
        m = mmap.mmap(file.fileno(), 0, mmap.MAP_SHARED, mmap.PROT_READ)
    offset, size = struct.unpack_from('<QQ', m, 48)
    slots, = struct.unpack_from('<I', m, 72)
    taken = 0
    while True:
        newest, = struct.unpack_from('<Q', m, 256)
        state, = struct.unpack_from('<I', m, 268)
        for n in range(max(taken, newest - slots) + 1, newest + 1):
            at = offset + (n - 1) % slots * size
            lock, = struct.unpack_from('<Q', m, at)
            frame, = struct.unpack_from('<i', m, at + 16)
            unix_us, = struct.unpack_from('<q', m, at + 32)
            rendered_ns, = struct.unpack_from('<q', m, at + 360)
            if lock == 2 * n == struct.unpack_from('<Q', m, at)[0]:
                out[round(unix_us * 0.09) % WRAP] = rendered_ns, frame
        taken = newest
        if state == CLOSED or not os.path.exists(f'/proc/{node}'):
            break
        time.sleep(0.004)
    over.set()


def video_pts(packet):
    """PTS of a packet of PID 0x100 that begins a frame, None of one that continues it, False of another."""
    if (packet[1] & 0x1F) << 8 | packet[2] != 0x100:
        return False
    if not packet[1] & 0x40:
        return None
    at = 4 + (1 + packet[4] if packet[3] & 0x20 else 0)
    p = packet[at + 9:at + 14]
    return (p[0] >> 1 & 7) << 30 | p[1] << 22 | p[2] >> 1 << 15 | p[3] << 7 | p[4] >> 1


def monotonic_less_real():
    """Difference of the two clocks, ns: of several readings the one that was interrupted least."""
    readings = []
    for _ in range(20):
        before, real, after = time.monotonic_ns(), time.time_ns(), time.monotonic_ns()
        readings.append((after - before, (before + after) // 2 - real))
        if after - before < 20_000:
            break
    return min(readings)[1]


def receive(sock, over, frames):
    """PTS -> stamp of its last datagram, CLOCK_MONOTONIC ns."""
    last, pts = {}, None
    sock.settimeout(0.2)
    while not (over.is_set() or frames and len(last) > frames):
        try:
            data, extra, _, _ = sock.recvmsg(2048, 64)
        except socket.timeout:
            continue
        stamp = next(struct.unpack('<qq', d[:16]) for _, kind, d in extra if kind == SO_TIMESTAMPNS)
        arrived_ns = stamp[0] * 10**9 + stamp[1] + monotonic_less_real()
        for k in range(0, len(data), 188):
            begun = video_pts(data[k:k + 188])
            if begun is False:
                continue
            pts = pts if begun is None else begun
            if pts is not None:
                last[pts] = arrived_ns
    return last


def ledger(out):
    """Frame -> ms from rendering to video sent, of the node's own ledger."""
    with open(f'{out}/truth.jsonl', encoding='ascii') as lines:
        of = {f['frame']: f['latency_ms']['consumers'] for f in map(json.loads, lines)}
    return {frame: ms['video'] for frame, ms in of.items() if 'video' in ms}


def share(values, part):
    return sorted(values)[min(len(values) - 1, int(part * len(values)))]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('name')
    parser.add_argument('port', type=int)
    parser.add_argument('out')
    parser.add_argument('node', type=int)
    parser.add_argument('--frames', type=int, default=0)
    args = parser.parse_args()
    sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 8 << 20)
    sock.setsockopt(socket.SOL_SOCKET, SO_TIMESTAMPNS, 1)
    sock.bind(('127.0.0.1', args.port))
    print('ready', flush=True)
    rendered, over = {}, threading.Event()
    ring = threading.Thread(target=ring_frames, args=(args.name, rendered, over, args.node), daemon=True)
    ring.start()
    last = receive(sock, over, args.frames)
    over.wait()
    while os.path.exists(f'/proc/{args.node}'):
        time.sleep(0.05)
    ms, near = {}, {p + d: p for p in rendered for d in (-1, 0, 1)}
    for pts, arrived in last.items():
        if pts in near:
            begun, frame = rendered[near[pts]]
            ms[frame] = 1e-6 * (arrived - begun)
    if not ms:
        sys.exit(f'no frame is in both the ring ({len(rendered)}) and the stream ({len(last)})')
    values = list(ms.values())
    print(f'judge: {len(ms)} frames of {len(rendered)}: last octet after rendering p50 {share(values, .5):.2f} '
          f'p95 {share(values, .95):.2f} p99 {share(values, .99):.2f} max {max(values):.2f} ms')
    if min(values) < -1e-6 * SLACK_NS:
        sys.exit('a frame arrived before it was rendered')
    if not os.path.exists(f'{args.out}/truth.jsonl'):
        return
    offsets = [done - ms[frame] for frame, done in ledger(args.out).items() if frame in ms]
    if not offsets:
        sys.exit('no frame of the ledger is in the stream')
    print(f'ledger: {len(offsets)} frames: later than the arrival by p50 {share(offsets, .5):.3f} '
          f'p99 {share(offsets, .99):.3f} max {max(offsets):.3f} least {min(offsets):.3f} ms')
    if min(offsets) < -1e-6 * SLACK_NS:
        sys.exit('the ledger says that a frame was sent before it arrived')


main()
