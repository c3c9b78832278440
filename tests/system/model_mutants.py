"""tests/system/model_mutants.py PITVIPER FOLDER COUNT [strace]: model files with octets, numbers and words of their headers
spoilt, COUNT of each kind, read by `pitviper model info`. Each ends with 0 or 1 and, at 1, one error line; no process takes more
than its limit of memory; none hangs; and nobody connects to the port that the files name. With strace: no socket is made and no
program started."""
import os
import random
import re
import resource
import socket
import struct
import subprocess
import sys

import model_files as files

COUNT, STRACE = int(sys.argv[3]), sys.argv[4:] == ['strace']
MOST_MEMORY_KB = 2_600_000  # import_max_memory, the program and the scene that it hands over
NUMBERS = [b'0', b'-1', b'1', b'255', b'65535', b'65536', b'2147483647', b'4294967295', b'4294967296', b'-2147483648', b'1e30', b'-1e-30',
           b'nan', b'1.5', b'99999999999999999999', b'0.', b'.5']

listener = socket.socket()
listener.bind(('127.0.0.1', 0))
listener.listen(64)
listener.setblocking(False)
NET = f'http://127.0.0.1:{listener.getsockname()[1]}/'


def seeds():
    up, forward = files.axis(2, 1), files.axis(1, -1)
    tree = files.fbx_tree(list(files.parts(forward, up, 0.01)), files.settings_of(forward, up, 1))
    tree[-2][2].append(('Texture', [files.Long(3000), 'Texture::t', ''], [('FileName', [NET + 't.png'], []), ('RelativeFilename', [NET + 't.png'], [])]))
    tree[-1][2].append(('C', ['OO', files.Long(3000), files.Long(2000)], []))
    yield 'fbx', files.fbx_text(tree).encode()
    yield 'fbx', files.fbx_binary(tree)
    g = files.plain(5122, True, steps=32767, stride=8)
    g.doc.update({'images': [{'uri': NET + 'i.png'}], 'textures': [{'source': 0}], 'materials': [{'normalTexture': {'index': 0}}],
                  'skins': [{'joints': [0, 1]}]})
    g.doc['accessors'][0]['sparse'] = {'count': 2, 'indices': {'bufferView': g.view(struct.pack('<2H', 1, 6)), 'componentType': 5123},
                                   'values': {'bufferView': g.view(struct.pack('<6h', *range(6)))}}
    g.doc['nodes'][2]['extensions'] = {'EXT_mesh_gpu_instancing': {'attributes': {'TRANSLATION': 2}}}
    g.doc['meshes'][3].update({'weights': [0.5]})
    g.doc['meshes'][3]['primitives'][0]['targets'] = [{'POSITION': 6}]
    yield 'gltf', g.text().encode()
    yield 'gltf', g.text(NET + 'b.bin').encode()
    yield 'glb', g.binary()
    corners = ''.join('v %g %g %g\n' % c for c in files.THING[0][1])
    yield 'obj', (f'mtllib {NET}a.mtl\nmtllib a.mtl\no hull\n' + corners + 'vn .6 -1 0\nvt 1 1\n' +
                  ''.join('f %s\n' % ' '.join(f'{v + 1}/1/1' for v in t) for t in files.THING[0][2])).encode()


def spoil(data, kind, chance):
    data = bytearray(data)
    for _ in range(chance.choice((1, 1, 2, 4))):
        how = chance.randrange(6) if chance.random() < 0.5 else 5
        head = chance.choice((len(data), min(len(data), 400)))  # as often in the header as anywhere
        at = chance.randrange(max(head, 1))
        if how == 0:
            data[at:at + 1] = bytes([chance.randrange(256)])
        elif how == 1:
            del data[at:at + chance.choice((1, 4, 60))]
        elif how == 2:
            data[at:at] = data[at:at + chance.choice((1, 8, 200))]
        elif how == 3 and chance.random() < 0.3:
            del data[at:]
        elif how == 4 and kind in ('fbx', 'glb'):  # a word of four octets
            data[at:at + 4] = chance.choice((b'\xff\xff\xff\xff', b'\0\0\0\0', b'\xff\xff\xff\x7f', b'\0\0\0\x80', b'\0\0\1\0'))
        else:
            found = [m for m in re.finditer(rb'-?\d+\.?\d*', bytes(data[:4000]))]
            if found:
                m = chance.choice(found)
                data[m.start():m.end()] = chance.choice(NUMBERS)
    return bytes(data)


def main():
    chance = random.Random(34)
    read = refused = 0
    with open(os.path.join(files.FOLDER, 'a.mtl'), 'w') as file:
        file.write(f'newmtl a\nKd .5 .5 .5\nmap_Kd {NET}m.png\n')
    trace = os.path.join(files.FOLDER, 'trace.txt')
    for kind, data in seeds():
        for i in range(COUNT):
            path = files.put('mutant.' + kind, spoil(data, kind, chance) if i else data)
            before = ['strace', '-f', '-qq', '-e', 'trace=%network,execve', '-o', trace] if STRACE else []
            ran = subprocess.run([*before, files.PITVIPER, 'model', 'info', path], stdin=subprocess.DEVNULL, capture_output=True, timeout=400)
            lines = [line for line in ran.stderr.decode().splitlines() if not line.startswith('pitviper: warning: ')]
            fine = ran.returncode == 0 and not lines or (ran.returncode == 1 and len(lines) == 1 and not ran.stdout and
                                                         lines[0].startswith('pitviper: error: '))
            files.check(f'{kind} {i}', fine or keep(path, kind, i), ran.returncode, lines[:3])
            files.check(f'{kind}: as it was', i or ran.returncode == 0 or NET.encode() + b'b.bin' in data, lines[:1])
            read += ran.returncode == 0
            refused += ran.returncode == 1
            if STRACE:
                with open(trace) as file:
                    calls = [line for line in file if '(' in line and '--- ' not in line and not ('execve' in line and files.PITVIPER in line)]
                files.check(f'{kind} {i}: no socket, no program', not calls or keep(path, kind, i), calls[:2])
    try:
        listener.accept()
        files.check('nobody connects', False)
    except BlockingIOError:
        files.check('nobody connects', True)
    most = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
    files.check(f'memory: {most} kB', most < MOST_MEMORY_KB)
    files.check('some are read and some are not', read > 6 and refused > 6 or COUNT < 4)
    print(f'{read} read, {refused} refused, at most {most} kB; {files.checks} checks, {files.failures} failed')
    return files.failures > 0


def keep(path, kind, i):
    """What broke, for whoever looks."""
    os.replace(path, os.path.join('/tmp', f'pitviper-mutant-{i}.{kind}'))
    return False


sys.exit(main())
