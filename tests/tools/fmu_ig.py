"""tests/tools/fmu_ig.py ARGUMENTS OF PITVIPER: an image generator for tests of the FMU, in place of pitviper: it answers by
CIGI as PITVIPER_FMU_IG says, and writes every datagram of the host, in hexadecimal, to PITVIPER_FMU_LOG after a line with its
process id.

    good      answers at once
    deaf      sends nothing
    slow      answers frame 2 after a second
    lossy     does not hear what comes first of every frame
    leaves N  ends with status N when frame 3 is asked for
    stubborn  answers, and does not end when it is told to"""
import os
import signal
import socket
import struct
import sys
import time


def sof(ig, host, stamp):
    return struct.pack('>BBBbBBHIIIxxxx', 101, 24, 3, 0, 0, 1 | 1 << 2 | 3 << 4, 0x8000, ig, stamp, host)


def main():
    words = sys.argv[1:]
    way, *more = os.environ.get('PITVIPER_FMU_IG', 'good').split()
    to = words[words.index('--cigi') + 1].split(':')
    port = next(int(w.split('=')[1]) for w in words if w.startswith('exercise.cigi_port='))
    log = open(os.environ['PITVIPER_FMU_LOG'], 'w', encoding='ascii')
    print(os.getpid(), file=log, flush=True)
    print('fmu_ig:', *words, flush=True)
    if way == 'stubborn':
        signal.signal(signal.SIGINT, signal.SIG_IGN)
    udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    udp.bind(('0.0.0.0', port))
    udp.connect((to[0], int(to[1])))
    udp.settimeout(0.1)
    ig = frames = 0
    last = stamp = 0
    missed = set()
    if way != 'deaf':
        ig = 1
        udp.send(b'no CIGI')
        udp.send(sof(ig, 0, 0))
    while True:
        try:
            data = udp.recv(65536)
        except (socket.timeout, ConnectionRefusedError):
            if ig:
                try:
                    udp.send(sof(ig, last, stamp))
                except ConnectionRefusedError:
                    pass
            continue
        print(data.hex(), file=log, flush=True)
        number, time_stamp = struct.unpack('>II', data[8:16])
        if way == 'lossy' and number not in missed:
            missed.add(number)
            continue
        if number == last:
            continue
        frames += 1
        if way == 'leaves' and frames == 3:
            print('fmu_ig: it is enough')
            sys.exit(int(more[0]))
        if way == 'slow' and frames == 2:
            time.sleep(1)
        ig, last, stamp = ig + 1, number, time_stamp
        udp.send(sof(ig, last, stamp))


if __name__ == '__main__':
    main()
