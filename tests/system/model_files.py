"""tests/system/model_files.py PITVIPER FOLDER WHAT: model files written here by the rules of their formats, of one thing whose
sizes are known: a hull 6 x 3 x 2 m with a nose ahead, a mirror on its right and a fin on top, each 0.5 m (the mirror 0.25 m)
beyond it. Whatever a file's unit, axes and packing, rays from ahead, from the right and from above must meet nose, mirror
and fin where they are. WHAT: fbx, gltf, obj or other."""
import base64
import io
import itertools
import json
import os
import struct
import subprocess
import sys
import zipfile

PITVIPER, FOLDER = os.path.abspath(sys.argv[1]), sys.argv[2]
failures = checks = 0


def check(what, fine, *more):
    global failures, checks
    checks += 1
    if not fine:
        failures += 1
        print('FAILED:', what, *more)


# forward, right, up of each part: low and high, m
PARTS = {'hull': ((-3, -1.5, 0), (3, 1.5, 2)), 'nose': ((3, -0.5, 0.5), (3.5, 0.5, 1.5)),
         'mirror': ((-0.5, 1.5, 0.5), (0.5, 1.75, 1.5)), 'fin': ((-0.5, -0.5, 2), (0.5, 0.5, 2.5))}
SIZE = [6.5, 3.25, 2.5]
QUADS = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
# in body axes (forward, right, down of the base's centre): from where, whither, what is met, after how many m
RAYS = (((20, -0.125, -1), (-1, 0, 0), 'nose', 20 - 3.25), ((-0.25, 20, -1), (0, -1, 0), 'mirror', 20 - 1.625),
        ((-0.25, -0.125, -20), (0, 0, 1), 'fin', 17.5))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def axis(letter, sign):
    return tuple(sign * (letter == k) for k in range(3))


def parts(forward, up, unit_m, right=None):
    """Name, vertices, triangles (outward) of each, in a file's axes and unit."""
    right = right or cross(forward, up)
    for name, (low, high) in PARTS.items():
        corners = [tuple((f * forward[k] + r * right[k] + u * up[k]) / unit_m for k in range(3))
                   for f, r, u in itertools.product(*zip(low, high))]
        middle = [sum(c[k] for c in corners) / 8 for k in range(3)]
        triangles = []
        for a, b, c, d in QUADS:
            for t in ((a, b, c), (a, c, d)):
                p, q, r = (corners[i] for i in t)
                n = cross([q[k] - p[k] for k in range(3)], [r[k] - p[k] for k in range(3)])
                triangles.append(t if dot(n, [p[k] - middle[k] for k in range(3)]) > 0 else t[::-1])
        yield name, corners, triangles


def put(name, data, sidecar=None):
    path = os.path.join(FOLDER, name)
    with open(path, 'wb') as file:
        file.write(data.encode() if isinstance(data, str) else data)
    beside = os.path.splitext(path)[0] + '.yaml'
    if os.path.exists(beside):
        os.remove(beside)
    if sidecar:
        with open(beside, 'w') as file:
            file.write(sidecar)
    return path


def pitviper(*arguments, stdin=None):
    return subprocess.run([PITVIPER, *arguments], input=stdin, capture_output=True, text=True, timeout=300)


def info(path):
    """The JSON object, or None where it is refused; and what was said."""
    ran = pitviper('model', 'info', '--json', path)
    return (json.loads(ran.stdout) if ran.returncode == 0 else None), ran.stderr, ran.returncode


def stands(path):
    """Why the thing is not as it is, or ''."""
    said, complaint, code = info(path)
    if said is None:
        return f'exit code {code}: {complaint}'
    wrong = []
    if any(abs(a - b) > 2e-3 for a, b in zip(said['size_m'], SIZE)):
        wrong.append(f'size {said["size_m"]}')
    if said['edges']['open'] or said['edges']['inside_out_parts']:
        wrong.append(f'edges {said["edges"]}')
    rows = 'ox_m,oy_m,oz_m,dx,dy,dz\n' + ''.join(','.join(map(str, o + d)) + '\n' for o, d, _, _ in RAYS)
    lines = pitviper('probe', 'rays', path, 'body', stdin=rows).stdout.splitlines()[1:]
    for line, (_, _, part, distance_m) in zip(lines, RAYS):
        cell = line.split(',')
        if cell[11].split('~')[0] != part or abs(float(cell[7]) - distance_m) > 2e-3:
            wrong.append(f'{part}: {line}')
    return '; '.join(wrong) + ('' if len(lines) == len(RAYS) else 'no rays')


def reads(what, path):
    wrong = stands(path)
    check(what, not wrong, wrong)


def twin(what, path):
    check(what + ': the twin must fail', stands(path) != '')


def refused(what, path, *words):
    said, complaint, code = info(path)
    check(what, said is None and code == 1 and all(w in complaint for w in words), code, complaint)


def warned(what, path, *words):
    said, complaint, _ = info(path)
    check(what, said is not None and all(w in complaint for w in words), complaint)


# ---- FBX --------------------------------------------------------------------------------------------------------------

class Long(int):
    """An id, of 64 bits in binary files."""


def fbx_tree(shapes, settings):
    """(name, properties, children), as both forms write it."""
    def p(name, kind, value):
        return ('P', [name, kind, {'int': 'Integer', 'double': 'Number'}[kind], '', value], [])
    tree = [('FBXHeaderExtension', [], [('FBXHeaderVersion', [1003], []), ('FBXVersion', [7400], [])])]
    if settings is not None:
        tree.append(('GlobalSettings', [], [('Version', [1000], []), ('Properties70', [], [
            p(k, 'double' if isinstance(v, float) else 'int', v) for k, v in settings.items()])]))
    objects, connections = [], []
    for i, (name, corners, triangles) in enumerate(shapes):
        index = [v for a, b, c in triangles for v in (a, b, -c - 1)]
        objects.append(('Geometry', [Long(1000 + i), 'Geometry::' + name, 'Mesh'], [
            ('Vertices', [[float(x) for c in corners for x in c]], []), ('PolygonVertexIndex', [index], []),
            ('GeometryVersion', [124], [])]))
        objects.append(('Model', [Long(2000 + i), 'Model::' + name, 'Mesh'], [('Version', [232], []), ('Properties70', [], [])]))
        connections += [('C', ['OO', Long(1000 + i), Long(2000 + i)], []), ('C', ['OO', Long(2000 + i), Long(0)], [])]
    return tree + [('Objects', [], objects), ('Connections', [], connections)]


def fbx_text(tree):
    def one(node, depth):
        name, properties, children = node
        tabs = '\t' * depth
        if properties and isinstance(properties[0], list):
            return f'{tabs}{name}: *{len(properties[0])} {{\n{tabs}\ta: {",".join(map(repr, properties[0]))}\n{tabs}}}\n'
        line = tabs + name + ': ' + ', '.join(f'"{v}"' if isinstance(v, str) else repr(v) for v in properties)
        if children or not properties:
            line += ' {\n' + ''.join(one(c, depth + 1) for c in children) + tabs + '}'
        return line + '\n'
    return '; FBX 7.4.0 project file\n' + ''.join(one(n, 0) for n in tree)


def fbx_binary(tree):
    def value(v):
        if isinstance(v, str):  # names are the other way round there
            text = v.split('::')
            data = (text[1] + '\0\1' + text[0] if len(text) == 2 else v).encode('latin-1')
            return b'S' + struct.pack('<I', len(data)) + data
        if isinstance(v, list):
            kind = 'd' if isinstance(v[0], float) else 'i'
            data = struct.pack(f'<{len(v)}{kind}', *v)
            return kind.encode() + struct.pack('<III', len(v), 0, len(data)) + data
        return b'D' + struct.pack('<d', v) if isinstance(v, float) else b'L' + struct.pack('<q', v) if isinstance(v, Long) else b'I' + struct.pack('<i', v)

    def one(node, at):
        name, properties, children = node
        head = 13 + len(name)
        data = b''.join(value(v) for v in properties)
        below = b''
        for child in children:
            below += one(child, at + head + len(data) + len(below))
        if children or not properties:
            below += bytes(13)
        return struct.pack('<IIIB', at + head + len(data) + len(below), len(properties), len(data), len(name)) + name.encode() + data + below
    out = b'Kaydara FBX Binary  \0\x1a\0' + struct.pack('<I', 7400)
    for node in tree:
        out += one(node, len(out))
    return out + bytes(13)


def settings_of(forward, up, factor, right_sign=1):
    """As the format has it: FrontAxis towards who looks, CoordAxis to their right, UnitScaleFactor in cm."""
    right = [right_sign * x for x in cross(up, forward)]
    out = {}
    for name, a in (('UpAxis', up), ('FrontAxis', forward), ('CoordAxis', right)):
        k = next(i for i in range(3) if a[i])
        out[name], out[name + 'Sign'] = k, int(a[k])
    return {**out, 'UnitScaleFactor': float(factor)}


def test_fbx():
    units = {'cm': 1, 'inch': 2.54, 'feet': 30.48, 'm': 100, 'mm': 0.1}
    directions = [axis(k, s) for k in range(3) for s in (1, -1)]
    for i, (up, forward) in enumerate((u, f) for u in directions for f in directions if not dot(u, f)):
        name, factor = list(units.items())[i % 5]
        tree = fbx_tree(list(parts(forward, up, factor / 100)), settings_of(forward, up, factor))
        reads(f'fbx: {name}, up {up}, forward {forward}', put('a.fbx', fbx_text(tree)))
        if i < 5:
            reads(f'fbx, binary: {name}, up {up}, forward {forward}', put('b.fbx', fbx_binary(tree)))
    y_up, z_forward = axis(1, 1), axis(2, 1)
    for name, factor in units.items():
        path = put('a.fbx', fbx_text(fbx_tree(list(parts(z_forward, y_up, factor / 100)), settings_of(z_forward, y_up, factor))))
        reads('fbx: ' + name, path)
        said = info(path)[0]['import']
        check(f'fbx: {name}: the report', abs(said['scale_m'] - factor / 100) < 1e-12 and 'UnitScaleFactor' in said['scale_from'] and
              'UpAxis' in said['axes_from'] and (said['forward'], said['up']) == ('+z', '+y'), said)
    thing = list(parts(axis(1, -1), axis(2, 1), 0.01))
    wrong = fbx_text(fbx_tree(thing, settings_of(z_forward, y_up, 100)))
    twin('fbx: another unit and other axes than it says', put('a.fbx', wrong))
    reads('fbx: the sidecar has the last word', put('a.fbx', wrong, 'scale: 0.01\naxes: -y +z\n'))
    reads('fbx: no settings: centimetres, y up', put('a.fbx', fbx_text(fbx_tree(list(parts(z_forward, y_up, 0.01)), None))))
    check('fbx: no settings: the report says so', 'says none' in info(os.path.join(FOLDER, 'a.fbx'))[0]['import']['scale_from'])
    # left-handed: what is on the right by CoordAxis lies where right-handed axes have the left
    left = list(parts(z_forward, y_up, 0.01, right=axis(0, 1)))
    reads('fbx: left-handed', put('a.fbx', fbx_text(fbx_tree(left, settings_of(z_forward, y_up, 1, right_sign=-1)))))
    twin('fbx: left-handed', put('a.fbx', fbx_text(fbx_tree(left, settings_of(z_forward, y_up, 1)))))
    refused('fbx: UnitScaleFactor 0', put('a.fbx', fbx_text(fbx_tree(thing, settings_of(z_forward, y_up, 0)))), 'UnitScaleFactor')
    for key, value in (('UnitScaleFactor', -3.0), ('UnitScaleFactor', float('1e30')), ('FrontAxis', 1), ('UpAxis', 7)):
        bad = {**settings_of(z_forward, y_up, 1), key: value}
        warned(f'fbx: {key} {value} is said', put('a.fbx', fbx_text(fbx_tree(list(parts(z_forward, y_up, 0.01)), bad))), 'in its sidecar')
        reads(f'fbx: {key} {value}: the default', os.path.join(FOLDER, 'a.fbx'))
    bad = {**settings_of(axis(1, -1), axis(2, 1), 1), 'FrontAxis': 2}
    reads('fbx: z up, FrontAxis too', put('a.fbx', fbx_text(fbx_tree(list(parts(axis(1, -1), axis(2, 1), 0.01)), bad))))


# ---- glTF -------------------------------------------------------------------------------------------------------------

KINDS = {5120: 'b', 5121: 'B', 5122: 'h', 5123: 'H', 5125: 'I', 5126: 'f'}
TOP = {5120: 127, 5121: 255, 5122: 32767, 5123: 65535}


class Gltf:
    """A document under construction; every accessor has a view of its own."""

    def __init__(self):
        self.data = b''
        self.doc = {'asset': {'version': '2.0'}, 'scene': 0, 'scenes': [{'nodes': []}], 'nodes': [], 'meshes': [],
                    'accessors': [], 'bufferViews': []}

    def view(self, data, stride=None):
        self.data += bytes(-len(self.data) % 4)
        self.doc['bufferViews'].append({'buffer': 0, 'byteOffset': len(self.data), 'byteLength': len(data), **({'byteStride': stride} if stride else {})})
        self.data += data
        return len(self.doc['bufferViews']) - 1

    def accessor(self, rows, kind=5126, normalised=False, stride=None, offset=0):
        """rows: tuples, as they are stored."""
        width = len(rows[0])
        size = struct.calcsize('<' + KINDS[kind]) * width
        data = b''.join(bytes(offset if stride else 0) + struct.pack(f'<{width}{KINDS[kind]}', *row) + bytes((stride or size) - size - (offset if stride else 0)) for row in rows)
        self.doc['accessors'].append({'bufferView': self.view(data, stride), 'componentType': kind, 'count': len(rows),
                                      'type': {1: 'SCALAR', 2: 'VEC2', 3: 'VEC3', 4: 'VEC4', 16: 'MAT4'}[width],
                                      **({'normalized': True} if normalised else {}), **({'byteOffset': offset} if offset else {})})
        return len(self.doc['accessors']) - 1

    def mesh(self, primitive, **more):
        self.doc['meshes'].append({'primitives': [primitive], **more})
        return len(self.doc['meshes']) - 1

    def node(self, root=True, **node):
        self.doc['nodes'].append(node)
        if root:
            self.doc['scenes'][0]['nodes'].append(len(self.doc['nodes']) - 1)
        return len(self.doc['nodes']) - 1

    def requires(self, *names):
        self.doc['extensionsUsed'] = self.doc['extensionsRequired'] = list(names)
        return self

    def text(self, uri=None):
        doc = {**self.doc, 'buffers': [{'byteLength': len(self.data), 'uri': uri or 'data:application/octet-stream;base64,' + base64.b64encode(self.data).decode()}]}
        return json.dumps(doc)

    def binary(self):
        text = json.dumps({**self.doc, 'buffers': [{'byteLength': len(self.data)}]}).encode()
        text += b' ' * (-len(text) % 4)
        data = self.data + bytes(-len(self.data) % 4)
        return (b'glTF' + struct.pack('<II', 2, 28 + len(text) + len(data)) + struct.pack('<I4s', len(text), b'JSON') + text +
                struct.pack('<I4s', len(data), b'BIN\0') + data)


THING = list(parts(axis(2, 1), axis(1, 1), 1))


def plain(kind=5126, normalised=False, index=5125, steps=None, stride=None, offset=0):
    """The thing, its positions as steps of the type, one node a part that undoes them."""
    g = Gltf()
    for name, corners, triangles in THING:
        more = {}
        if steps:
            low = [min(c[k] for c in corners) for k in range(3)]
            high = [max(c[k] for c in corners) for k in range(3)]
            least = -steps if KINDS[kind].islower() else 0
            rows = [tuple(round(least + (steps - least) * (c[k] - low[k]) / (high[k] - low[k])) for k in range(3)) for c in corners]
            unit = TOP[kind] if normalised else 1
            scale = [(high[k] - low[k]) / (steps - least) * unit for k in range(3)]
            more = {'scale': scale, 'translation': [low[k] - scale[k] * least / unit for k in range(3)]}
        else:
            rows = corners
        primitive = {'attributes': {'POSITION': g.accessor(rows, kind, normalised, stride, offset)},
                     'indices': g.accessor([(i,) for t in triangles for i in t], index)}
        g.node(mesh=g.mesh(primitive), name=name, **more)
    return g.requires('KHR_mesh_quantization') if steps else g


def test_gltf():
    reads('gltf: floats', put('a.gltf', plain().text()))
    reads('glb: floats', put('a.glb', plain().binary()))
    for kind, normalised, steps in itertools.product((5120, 5121, 5122, 5123), (False, True), (None,)):
        for steps in (TOP[kind], TOP[kind] // 2):
            g = plain(kind, normalised, steps=steps, stride=4 if kind < 5122 else 8)
            what = f'quantised, type {kind}, {"normalised" if normalised else "whole"}, {steps} steps'
            reads('gltf: ' + what, put('a.gltf', g.text()))
            reads('glb: ' + what, put('a.glb', g.binary()))
    g = plain(5123, True, steps=65535, stride=8)
    for a in g.doc['accessors']:
        a.pop('normalized', None)
    twin('gltf: normalised numbers taken as whole ones', put('a.gltf', g.text()))
    for index in (5121, 5123):
        reads(f'gltf: indices of type {index}', put('a.gltf', plain(index=index).text()))
    reads('gltf: interleaved, 16 octets apart', put('a.gltf', plain(stride=16, offset=4).text()))
    with open(os.path.join(FOLDER, 'the data.bin'), 'wb') as file:
        file.write(plain().data)
    reads('gltf: a buffer in a file, its name coded', put('a.gltf', plain().text('the%20data.bin')))
    refused('gltf: a buffer that is not there', put('a.gltf', plain().text('none.bin')), 'none.bin')
    refused('gltf: a buffer outside the folder', put('a.gltf', plain().text('../../etc/passwd')), 'buffer 0')
    refused('gltf: a buffer of the network', put('a.gltf', plain().text('http://127.0.0.1:9/x.bin')), 'no file of its folder')

    # sparse: the nose is stored flat, and drawn out by its sparse numbers; one accessor has no view at all
    g = plain()
    for part, (name, corners, _) in enumerate(THING):
        if name not in ('nose', 'fin'):
            continue
        a = g.doc['accessors'][g.doc['meshes'][part]['primitives'][0]['attributes']['POSITION']]
        if name == 'nose':
            moved = [i for i, c in enumerate(corners) if c[2] > 3.2]
            start = a['bufferView']
            view = g.doc['bufferViews'][start]
            flat = b''.join(struct.pack('<3f', c[0], c[1], min(c[2], 3)) for c in corners)
            g.data = g.data[:view['byteOffset']] + flat + g.data[view['byteOffset'] + len(flat):]
        else:
            moved = list(range(8))
            del a['bufferView']
        a['sparse'] = {'count': len(moved),
                       'indices': {'bufferView': g.view(b''.join(struct.pack('<H', i) for i in moved)), 'componentType': 5123},
                       'values': {'bufferView': g.view(b''.join(struct.pack('<3f', *corners[i]) for i in moved))}}
    reads('gltf: sparse', put('a.gltf', g.text()))
    for a in g.doc['accessors']:
        a.pop('sparse', None)
    twin('gltf: without its sparse numbers', put('a.gltf', g.text()))

    # a strip and a fan: a box as two fans about opposite corners, and as strips of two triangles
    for mode in (5, 6):
        g = Gltf()
        for name, corners, triangles in THING:
            m = []
            for a, b in zip(triangles[::2], triangles[1::2]):  # both of a quad, a corner apart
                quad = [v for v in a]
                d = next(v for v in b if v not in a)
                i = next(k for k in range(3) if a[k] not in b)  # opposite to d
                p, q, r = quad[i], quad[(i + 1) % 3], quad[(i + 2) % 3]
                order = (p, q, r, d) if mode == 5 else (q, d, r, p)
                m.append({'attributes': {'POSITION': g.accessor(corners)}, 'indices': g.accessor([(v,) for v in order], 5123), 'mode': mode})
            g.doc['meshes'].append({'primitives': m})
            g.node(mesh=len(g.doc['meshes']) - 1, name=name)
        said = info(put('a.gltf', g.text()))
        check(f'gltf: mode {mode}', said[0] and said[0]['triangles'] == 48 and [round(x, 6) for x in said[0]['size_m']] == SIZE, said)
        # each side is a part of its own: open, but facing outward as the whole is met
        rows = 'ox_m,oy_m,oz_m,dx,dy,dz\n20,-0.125,-1,-1,0,0\n'
        line = pitviper('probe', 'rays', os.path.join(FOLDER, 'a.gltf'), 'body', stdin=rows).stdout.splitlines()[1].split(',')
        check(f'gltf: mode {mode}: faces outward', line[8] == '1' and line[11].startswith('nose'), line)

    # a matrix, a rotation of a quarter turn, and children: the same place in three ways
    half = 0.5 ** 0.5
    for what, node in (('matrix', {'matrix': [0, 0, -1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 5, 0, 0, 1]}),
                       ('rotation', {'rotation': [0, half, 0, half], 'translation': [5, 0, 0]}),
                       ('long quaternion', {'rotation': [0, 3, 0, 3], 'translation': [5, 0, 0]})):
        g = plain()
        top = g.node(children=list(range(4)), name='top', **node)
        g.doc['scenes'][0]['nodes'] = [top]
        path = put('a.gltf', g.text(), 'axes: +x +y\n')  # a quarter turn about up takes z to x
        reads('gltf: ' + what, path)

    # instances: the thing as one box of a side of 1 m, drawn four times with translation, rotation and scale
    def instanced(kind=5126):
        g = Gltf()
        corners = list(itertools.product((-0.5, 0.5), repeat=3))
        triangles = []
        for a, b, c, d in QUADS:
            for t in ((a, b, c), (a, c, d)):
                p, q, r = (corners[i] for i in t)
                n = cross([q[k] - p[k] for k in range(3)], [r[k] - p[k] for k in range(3)])
                triangles.append(t if dot(n, p) > 0 else t[::-1])
        mesh = g.mesh({'attributes': {'POSITION': g.accessor(corners)}, 'indices': g.accessor([(i,) for t in triangles for i in t], 5123)})
        at, size = [], []
        for low, high in PARTS.values():
            f, r, u = ((a + b) / 2 for a, b in zip(low, high))
            at.append((-r, u, f))
            size.append(tuple(b - a for a, b in zip(low, high)))  # forward, right, up: turned below
        turn = (0, half, 0, half)  # x to -z, z to x
        top = 1 if kind == 5126 else TOP[kind]
        rows = [tuple(round(q * top) if top > 1 else q for q in turn)] * 4
        attributes = {'TRANSLATION': g.accessor(at), 'ROTATION': g.accessor(rows, kind, kind != 5126),
                      'SCALE': g.accessor([(f, u, r) for f, r, u in size])}
        g.node(mesh=mesh, name='thing', extensions={'EXT_mesh_gpu_instancing': {'attributes': attributes}})
        return g.requires('EXT_mesh_gpu_instancing')
    for kind in (5126, 5120, 5122):
        said = info(put('a.gltf', instanced(kind).text()))
        near = 0.05 if kind == 5120 else 2e-3
        check(f'gltf: instances, rotation of type {kind}', said[0] and said[0]['triangles'] == 48 and not said[0]['edges']['inside_out_parts'] and
              all(abs(a - b) < near for a, b in zip(said[0]['size_m'], SIZE)), said)
    g = instanced()
    del g.doc['nodes'][0]['extensions'], g.doc['extensionsRequired'], g.doc['extensionsUsed']
    said = info(put('a.gltf', g.text()))
    check('gltf: without its instances', said[0] and said[0]['size_m'] == [1, 1, 1], said)
    g = instanced()
    g.doc['accessors'][2]['count'] = 3
    refused('gltf: instances of unlike numbers', put('a.gltf', g.text()), 'instances')

    # morph targets: the nose is drawn short, its target by as much forward, at weight 1 of the mesh, of the node, or half twice
    def morphed(mesh_weights, node_weights, normals=False):
        g = plain()
        corners = THING[1][1]
        primitive = g.doc['meshes'][1]['primitives'][0]
        short = [(c[0], c[1], min(c[2], 3.1)) for c in corners]
        delta = [tuple(a - b for a, b in zip(c, s)) for c, s in zip(corners, short)]
        primitive['attributes']['POSITION'] = g.accessor(short)
        primitive['targets'] = [{'POSITION': g.accessor(delta)}] * 2
        if mesh_weights:
            g.doc['meshes'][1]['weights'] = mesh_weights
        if node_weights:
            g.doc['nodes'][1]['weights'] = node_weights
        return g.text()
    for mesh_weights, node_weights in (([1, 0], None), ([0.25, 0.75], None), ([0, 0], [1, 0]), (None, [0.5, 0.5])):
        reads(f'gltf: morphed by {mesh_weights}, {node_weights}', put('a.gltf', morphed(mesh_weights, node_weights)))
        check('gltf: morph targets are counted', info(os.path.join(FOLDER, 'a.gltf'))[0]['import']['lost'].get('morph_targets') == 2)
    twin('gltf: not morphed', put('a.gltf', morphed([0, 0], None)))

    # a skin: the nose hangs on a joint 1 m further forward than where it was bound, drawn 1 m too far back; its own node's place is not used
    def skinned(bound_m):
        g = plain()
        back = [(c[0], c[1], c[2] - 1) for c in THING[1][1]]
        primitive = g.doc['meshes'][1]['primitives'][0]
        bind = (1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -bound_m, 1)
        primitive['attributes'] = {'POSITION': g.accessor(back), 'JOINTS_0': g.accessor([(0, 1, 0, 0)] * 8, 5121),
                                   'WEIGHTS_0': g.accessor([(191, 64, 0, 0)] * 8, 5121, True)}
        joint = g.node(name='bone', translation=[0, 0, 8])
        g.doc['skins'] = [{'joints': [joint, joint], 'inverseBindMatrices': g.accessor([bind] * 2)}]
        g.doc['nodes'][1].update({'skin': 0, 'translation': [7, 7, 7]})
        return g.text()
    reads('gltf: skinned', put('a.gltf', skinned(7)))
    check('gltf: bones are counted', info(os.path.join(FOLDER, 'a.gltf'))[0]['import']['lost'].get('bones') == 2)
    twin('gltf: skinned', put('a.gltf', skinned(8)))

    # extensions
    for name in ('KHR_draco_mesh_compression', 'EXT_meshopt_compression', 'KHR_meshopt_compression', 'ACME_required_thing', 'KHR_materials_unlit',
                 'KHR_animation_pointer', 'KHR_lights_punctual'):
        for ending in ('gltf', 'glb'):
            g = plain().requires('KHR_mesh_quantization', name)
            refused(f'{ending}: requires {name}', put('a.' + ending, g.text() if ending == 'gltf' else g.binary()), name, 'extension')
        g = plain()
        g.doc['extensionsUsed'] = [name]
        reads(f'gltf: uses {name}', put('a.gltf', g.text()))
    for name in ('KHR_texture_basisu', 'KHR_texture_transform', 'EXT_texture_webp'):
        g = plain().requires(name)
        reads(f'gltf: requires {name}, of pictures', put('a.gltf', g.text()))
        warned(f'gltf: {name} is named', os.path.join(FOLDER, 'a.gltf'), name)
    g = plain()
    g.doc['nodes'][1]['extensions'] = {'ACME_bent': {}}
    warned('gltf: an extension of a node', put('a.gltf', g.text()), 'ACME_bent', 'on 1 of its parts')
    g = plain()
    g.doc['meshes'][0]['primitives'][0]['extensions'] = {'KHR_draco_mesh_compression': {'bufferView': 0, 'attributes': {'POSITION': 0}}}
    reads('gltf: draco beside plain numbers', put('a.gltf', g.text()))
    del g.doc['accessors'][0]['bufferView']
    refused('gltf: draco without them', put('a.gltf', g.text()), 'KHR_draco_mesh_compression')
    g = plain()
    g.doc['nodes'][0]['extensions'] = {'KHR_node_visibility': {'visible': False}}
    said = info(put('a.gltf', g.text()))[0]
    check('gltf: a node that is not visible', said and said['import']['lost'].get('switched_off') == 1 and said['triangles'] == 36, said)

    # what is lost
    g = plain()
    g.doc.update({'textures': [{'source': 0}], 'images': [{'uri': 'none.png'}], 'cameras': [{'type': 'perspective'}] * 3, 'animations': [{}],
                  'materials': [{'name': 'skin', 'pbrMetallicRoughness': {'baseColorTexture': {'index': 0}}, 'normalTexture': {'index': 0}}]})
    said = info(put('a.gltf', g.text()))[0]
    check('gltf: what is lost', said and said['import']['lost'] == {'textures': 2, 'cameras': 3, 'animations': 1}, said and said['import']['lost'])
    reads('gltf: a picture that is not there', os.path.join(FOLDER, 'a.gltf'))

    # broken ones, each by what is wrong
    def broken(what, change, *words):
        g = plain()
        change(g)
        refused('gltf: ' + what, put('a.gltf', g.text()), *words)
    broken('an index beyond', lambda g: g.doc['accessors'][0].update(count=5), 'index is beyond')
    broken('a view beyond its buffer', lambda g: g.doc['bufferViews'][0].update(byteLength=10 ** 6), 'POSITION')
    broken('an accessor beyond its view', lambda g: g.doc['accessors'][0].update(count=9), 'POSITION')
    broken('a count of a milliard', lambda g: g.doc['accessors'][0].update(count=10 ** 9), 'POSITION')
    broken('a node that is not there', lambda g: g.doc['scenes'][0]['nodes'].append(99), 'node')
    broken('nodes in a circle', lambda g: g.doc['nodes'][0].update(children=[0]), '256 levels')
    broken('glTF 1.0', lambda g: g.doc['asset'].update(version='1.0'), '2.0 is read')
    broken('a matrix of words', lambda g: g.doc['nodes'][0].update(matrix=['a'] * 16), 'matrix')
    glb = plain().binary()
    for cut in (3, 11, 19, 40, len(glb) - 50):
        refused(f'glb: cut after {cut} octets', put('a.glb', glb[:cut]), 'cannot be read')


# ---- OBJ --------------------------------------------------------------------------------------------------------------

def test_obj():
    lines, base = [], 1
    for name, corners, triangles in THING:
        lines.append('o ' + name)
        lines += ['v %.4f %.4f %.4f' % c for c in corners]
        lines += ['vn %.4f %.4f %.4f' % tuple(x / 0.5 for x in (0, 0.5, 0))] * 8 + ['vt 0.5 0.25'] * 8
        lines += ['f ' + ' '.join(f'{v + base}/{v + base}/{v + base}' for v in t) for t in triangles]
        base += 8
    clean = '\n'.join(lines) + '\n'
    reads('obj: plain', put('plain.obj', clean))
    want = pitviper('model', 'info', put('a.obj', clean)).stdout

    def rewrite(v=lambda x: x, f=lambda i, n: i, sep=' ', end='\n', indent=''):
        out, count = [], 0
        for line in lines:
            key, *words = line.split()
            if key == 'v':
                count += 1
            if key[0] == 'v':
                words = [v(w) for w in words]
            elif key == 'f':
                words = ['/'.join(f(i, count) for i in w.split('/')) for w in words]
            out.append(indent + sep.join([key, *words]))
        return end.join(out) + end

    def no_zero(w):
        return w.replace('0.', '.', 1) if w.startswith(('0.', '-0.')) else w

    def exponent(w):
        return '%.6e' % float(w)
    forms = {'leading point': rewrite(no_zero), 'plus': rewrite(lambda w: w if w[0] == '-' else '+' + w),
             'plus and point': rewrite(lambda w: no_zero(w) if w[0] == '-' else '+' + no_zero(w)),
             'trailing point': rewrite(lambda w: '%d.' % float(w) if float(w) == int(float(w)) else w),
             'exponent': rewrite(exponent), 'E and +': rewrite(lambda w: exponent(w).upper()),
             'point and exponent': rewrite(lambda w: '%d.e-4' % round(float(w) * 1e4)), 'milli': rewrite(lambda w: '%de-4' % round(float(w) * 1e4)),
             'point, digits, exponent': rewrite(lambda w: '%s.%06de2' % ('-' if float(w) < 0 else '', abs(round(float(w) * 1e4)))),
             'zeros before': rewrite(lambda w: '-00' + w[1:] if w[0] == '-' else '00' + w), 'tabs': rewrite(sep='\t'), 'blanks': rewrite(sep='   ', indent='  '),
             'CR LF': rewrite(end='\r\n'), 'CR alone': rewrite(end='\r'), 'negative indices': rewrite(f=lambda i, n: str(int(i) - n - 1)),
             'indices with plus and zeros': rewrite(f=lambda i, n: '+0' + i),
             'continued lines': rewrite(sep=' \\\n'), 'continued, CR LF': rewrite(sep=' \\\r\n', end='\r\n'),
             'comments behind': rewrite(end=' # a comment\n').replace('o hull # a comment', 'o hull').replace('o nose # a comment', 'o nose')
             .replace('o mirror # a comment', 'o mirror').replace('o fin # a comment', 'o fin'),
             'a fourth number': clean.replace('\nvn', ' 1\nvn', 0), 'no line end': clean.rstrip('\n'),
             'vt of one and of three': clean.replace('vt 0.5 0.25', 'vt .5').replace('vt .5', 'vt 1 2 3', 4), 'vt not there': '\n'.join(
                 line for line in lines if not line.startswith('vt')) + '\n'}
    colour = '\n'.join(line + ' .5 .25 1' if line.startswith('v ') else line for line in lines) + '\n'
    forms['colours'], forms['colours with alpha'] = colour, colour.replace(' .5 .25 1', ' .5 .25 1 1')
    forms['five numbers'] = colour.replace(' .5 .25 1', ' 1 2')
    forms['weights'] = colour.replace(' .5 .25 1', ' 1')
    def same(text):  # but for the file's length
        return '\n'.join(line for line in text.splitlines() if not line.startswith('file:'))
    for what, text in forms.items():
        got = pitviper('model', 'info', put('a.obj', text))
        check('obj: ' + what, same(got.stdout) == same(want), got.stderr, got.stdout)
        reads('obj: ' + what, os.path.join(FOLDER, 'a.obj'))
    first = next(line for line in lines if line.startswith('v '))
    twin('obj: a vertex short', put('a.obj', clean.replace(first + '\n', '', 1)))
    for wrong in ('v 1 2', 'v 1 2 x', 'v 1 2 3..4', 'v . 1 2', 'v 1e 2 3', 'f 1 2 a', 'f 0 1 2', 'f 1//x 2 3'):
        refused(f'obj: `{wrong}`', put('a.obj', clean + wrong + '\n'), f'line {len(lines) + 1}', wrong)
    warned('obj: materials that are not there', put('a.obj', 'mtllib none.mtl\n' + clean), 'none.mtl')
    for line, scale in (('# File units = centimeters', '0.01'), ('# This file uses centimeters as units for non-parametric coordinates.', '0.01'),
                        ('# units: mm', '0.001'), ('# Unit: inches', '0.0254')):
        warned('obj: a comment names a unit: ' + line, put('a.obj', line + '\n' + clean), 'scale: ' + scale)
    for line in ('# units: m', '# one unit is one thing', '# 12 vertices'):
        said = info(put('a.obj', line + '\n' + clean))
        check('obj: a comment that names none: ' + line, 'scale:' not in said[1], said[1])


# ---- others -----------------------------------------------------------------------------------------------------------

def test_other():
    def dae(up, forward, unit_m, extra=None):
        def mesh(i, name, corners, triangles):
            numbers = ' '.join(repr(x) for c in corners for x in c)
            index = ' '.join(str(v) for t in triangles for v in t)
            return (f'<geometry id="g{i}" name="{name}"><mesh><source id="p{i}"><float_array id="a{i}" count="24">{numbers}</float_array>'
                    f'<technique_common><accessor source="#a{i}" count="8" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>'
                    f'<param name="Z" type="float"/></accessor></technique_common></source><vertices id="v{i}"><input semantic="POSITION" '
                    f'source="#p{i}"/></vertices><triangles count="12"><input semantic="VERTEX" source="#v{i}" offset="0"/><p>{index}</p></triangles></mesh></geometry>')
        shapes = list(parts(forward, up, unit_m))
        name = 'XYZ'[[i for i in range(3) if up[i]][0]]
        asset = '<asset>' + (f'<unit name="u" meter="{unit_m}"/><up_axis>{name}_UP</up_axis>' if extra is None else extra) + '</asset>'
        nodes = ''.join(f'<node id="{n}" name="{n}"><instance_geometry url="#g{i}"/></node>' for i, (n, _, _) in enumerate(shapes))
        return (f'<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">{asset}<library_geometries>' +
                ''.join(mesh(i, *s) for i, s in enumerate(shapes)) + f'</library_geometries><library_visual_scenes><visual_scene id="s">{nodes}'
                '</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>')
    # the format names up alone; assimp turns -y to z forward where z is up, and x up stands z forward
    for unit_m in (0.01, 0.0254, 1, 0.001):
        reads(f'dae: z up, {unit_m} m', put('a.dae', dae(axis(2, 1), axis(1, -1), unit_m)))
        reads(f'dae: y up, {unit_m} m', put('a.dae', dae(axis(1, 1), axis(2, 1), unit_m)))
    reads('dae: x up', put('a.dae', dae(axis(0, 1), axis(2, 1), 0.01)))
    said = info(put('a.dae', dae(axis(2, 1), axis(1, -1), 0.01)))[0]['import']
    check('dae: the report', 'meter="0.01"' in said['scale_from'].replace('\\', '') and 'Z_UP' in said['axes_from'], said)
    reads('dae: says nothing', put('a.dae', dae(axis(1, 1), axis(2, 1), 1, '')))
    twin('dae: another unit', put('a.dae', dae(axis(1, 1), axis(2, 1), 0.01, '')))

    # scanners' and printers' formats: z up, x forward; a unit in a comment is said
    def ply(comment=''):
        corners, faces = [], []
        for _, c, t in parts(axis(0, 1), axis(2, 1), 1):
            faces += [tuple(v + len(corners) for v in face) for face in t]
            corners += c
        return (f'ply\nformat ascii 1.0\n{comment}element vertex {len(corners)}\nproperty float x\nproperty float y\nproperty float z\nelement face '
                f'{len(faces)}\nproperty list uchar int vertex_indices\nend_header\n' + ''.join('%g %g %g\n' % c for c in corners) + ''.join('3 %d %d %d\n' % f for f in faces))
    said = info(put('a.ply', ply()))[0]
    check('ply: as it is', said and [round(x, 5) for x in said['size_m']] == SIZE, said)
    warned('ply: a comment names a unit', put('a.ply', ply('comment unit: mm\n')), 'scale: 0.001')

    def stl(head='thing'):
        out = f'solid {head}\n'
        for _, c, t in parts(axis(0, 1), axis(2, 1), 1):
            for face in t:
                out += 'facet normal 0 0 0\nouter loop\n' + ''.join('vertex %g %g %g\n' % c[v] for v in face) + 'endloop\nendfacet\n'
        return out + f'endsolid {head}\n'
    said = info(put('a.stl', stl()))[0]
    check('stl: as it is', said and [round(x, 5) for x in said['size_m']] == SIZE, said)
    warned('stl: its name names a unit', put('a.stl', stl('thing units=mm')), 'scale: 0.001')

    # formats of printers say their unit, or mean millimetres: z up, x forward
    def amf(unit_m, unit):
        shapes = list(parts(axis(0, 1), axis(2, 1), unit_m))
        objects = ''.join(f'<object id="{i}"><metadata type="name">{n}</metadata><mesh><vertices>' + ''.join(
            '<vertex><coordinates><x>%r</x><y>%r</y><z>%r</z></coordinates></vertex>' % v for v in c) + '</vertices><volume>' + ''.join(
            '<triangle><v1>%d</v1><v2>%d</v2><v3>%d</v3></triangle>' % f for f in t) + '</volume></mesh></object>' for i, (n, c, t) in enumerate(shapes))
        return f'<?xml version="1.0" encoding="UTF-8"?><amf{unit} version="1.1">{objects}</amf>'

    def three_mf(unit_m, unit, packed):
        shapes = list(parts(axis(0, 1), axis(2, 1), unit_m))
        objects = ''.join(f'<object id="{i + 1}" name="{n}" type="model"><mesh><vertices>' + ''.join('<vertex x="%r" y="%r" z="%r"/>' % v for v in c) +
                          '</vertices><triangles>' + ''.join('<triangle v1="%d" v2="%d" v3="%d"/>' % f for f in t) + '</triangles></mesh></object>'
                          for i, (n, c, t) in enumerate(shapes))
        model = (f'<?xml version="1.0" encoding="UTF-8"?><model{unit} xml:lang="en-US" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">'
                 f'<resources>{objects}</resources><build>' + ''.join(f'<item objectid="{i + 1}"/>' for i in range(4)) + '</build></model>')
        out = io.BytesIO()
        with zipfile.ZipFile(out, 'w', zipfile.ZIP_DEFLATED if packed else zipfile.ZIP_STORED) as archive:
            archive.writestr('[Content_Types].xml', '<?xml version="1.0"?><Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
                             '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
                             '<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>')
            archive.writestr('_rels/.rels', '<?xml version="1.0"?><Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
                             '<Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>')
            archive.writestr('3D/3dmodel.model', model)
        return out.getvalue()
    for unit_m, unit in ((0.0254, 'inch'), (1, 'meter'), (0.001, 'millimeter'), (0.001, ''), (0.01, 'centimeter'), (0.3048, 'foot')):
        named = f' unit="{unit}"' if unit else ''
        for packed in (True, False):
            path = put('a.3mf', three_mf(unit_m, named, packed))
            said = info(path)
            check(f'3mf: {unit or "none"}', said[0] and all(abs(a - b) < 2e-3 for a, b in zip(said[0]['size_m'], SIZE)) and
                  abs(said[0]['import']['scale_m'] - unit_m) < 1e-12, said)
        if unit in ('inch', 'meter', 'millimeter', ''):
            said = info(put('a.amf', amf(unit_m, named)))
            check(f'amf: {unit or "none"}', said[0] and all(abs(a - b) < 2e-3 for a, b in zip(said[0]['size_m'], SIZE)), said)

    def dxf(unit_m, code):
        header = f'  0\nSECTION\n  2\nHEADER\n  9\n$INSUNITS\n 70\n{code:6d}\n  0\nENDSEC\n' if code is not None else ''
        out = header + '  0\nSECTION\n  2\nENTITIES\n'
        for _, c, t in parts(axis(1, -1), axis(2, 1), unit_m):
            for f in t:
                out += '  0\n3DFACE\n  8\nthing\n' + ''.join(f' 1{k}\n{c[v][0]!r}\n 2{k}\n{c[v][1]!r}\n 3{k}\n{c[v][2]!r}\n' for k, v in enumerate((*f, f[2])))
        return out + '  0\nENDSEC\n  0\nEOF\n'
    for unit_m, code in ((0.001, 4), (0.01, 5), (1, 6), (0.0254, 1), (0.3048, 2), (1, 0), (1, None)):
        said = info(put('a.dxf', dxf(unit_m, code)))
        check(f'dxf: $INSUNITS {code}', said[0] and all(abs(a - b) < 2e-3 for a, b in zip(said[0]['size_m'], SIZE)), said)

    # sizes
    def box(side):
        return ''.join(f'v {x * side} {y * side} {z * side}\n' for x, y, z in itertools.product((0, 1), repeat=3)) + ''.join(
            'f %d %d %d %d\n' % tuple(v + 1 for v in q) for q in QUADS)
    warned('a thing of 750 m', put('thing.obj', box(750)), 'catalog.csv', 'scale: 0.01')
    warned('a thing of 2 mm', put('thing.obj', box(0.002)), 'scale: ')
    warned('a tank of 950 m, by its name', put('my_tank.obj', box(950)), '`tank`', 'scale: 0.01')
    for name, side in (('thing.obj', 300), ('thing.obj', 0.06), ('my_tank.obj', 7.5), ('thinktank.obj', 200)):
        said = info(put(name, box(side)))
        check(f'{name} of {side} m: nothing odd', said[0] and 'odd_size' not in said[0] and 'scale' not in said[1], said[1])


if __name__ == '__main__':
    {'fbx': test_fbx, 'gltf': test_gltf, 'obj': test_obj, 'other': test_other}[sys.argv[3]]()
    print(f'{sys.argv[3]}: {checks} checks, {failures} failed')
    sys.exit(failures > 0 or checks == 0)
