"""tests/layers/layers.py ROOT [--changed BRANCH]: what a file may include, where a library is known, that includes go in no circle,
that files are opened for writing in one place, that paths named in comments and pages exist, and that a .c file says in its first line what it is. A link alone proves none of it: an object that is already pulled in
satisfies a call backwards.

    base < dis, terrain < entities < render < sensor

With --changed: the tests, as an expression for `ctest -R`, of what differs from where BRANCH was left, committed or not.

A room's folders are its wings. An exception below needs a reason and a circle that it leaves out; best there is
none."""
import collections
import fnmatch
import os
import re
import subprocess
import sys

ROOMS = ('dis', 'terrain', 'entities', 'render', 'sensor')

# Headers of other rooms that a room may include, beside its own.
MAY = {
    'base': (),
    'dis': (),
    'terrain': (),
    'entities': ('dis/*', 'terrain/*'),
    # a Snapshot and the terrain, never a PDU or the table; pdu.h for its ids alone
    'render': ('terrain/*', 'entities/models/model.h', 'entities/models/patches.h', 'entities/traces/effect_puffs.h',
               'entities/import/model_import.h', 'entities/catalog/catalog.h', 'entities/scenery/scenery.h', 'entities/scenery/scenery_lamps.h', 'entities/scenery/scenery_smoke.h', 'entities/scenery/scenery_exhaust.h', 'entities/scenery/scenery_traces.h',
               'entities/table/snapshot.h', 'dis/pdu/pdu.h'),
    'sensor': ('dis/*', 'terrain/*', 'entities/*', 'render/*'),
    'top': ('*',), 'fuzz': ('*',), 'analytic': ('*',),
}
BASE_HEADERS = ('pitviper.h', 'pitviper_cache.h', 'pitviper_channels.h', 'pitviper_confine.h', 'pitviper_file.h', 'pitviper_kept.h', 'pitviper_library.h', 'pitviper_output.h', 'pitviper_response.h',
                'pitviper_settings.h', 'pitviper_sha256.h', 'pitviper_simd.h', 'pitviper_table.h')

# Libraries that one file, or one folder, knows: header, places.
LIBRARIES = (
    ('GeographicLib/*', 'terrain/*.cpp'), ('gdal*', 'terrain/elevation/reader/*'),
    ('cpl_*', 'terrain/elevation/reader/*'), ('ogr_*', 'terrain/elevation/reader/*'), ('erfa.h', 'terrain/*'),
    ('OpenImageIO/*', 'sensor/publish/images/image_module.cpp'), ('OpenEXR/*', 'sensor/publish/images/exr_module.cpp'),
    ('SDL.h', 'sensor/publish/projector/window/*'),
    ('png.h', 'sensor/publish/images/png_file.c'), ('embree*', 'render/*'), ('pcap*', 'dis/*'),
    ('assimp/*', 'entities/import/assimp*.c'), ('fftw3.h', 'sensor/detector/transform.c'),
    ('jansson.h', 'sensor/frame/*'), ('jansson.h', 'sensor/publish/*'), ('jansson.h', 'entities/import/gltf*'), ('yaml.h', 'pitviper_*.c'), ('yaml.h', 'sensor/commands/sweep/sweep_file.c'),
)

# Files are opened for writing, and renamed, by pitviper_output.c alone, which follows no link; shared memory has names of its own; pitviper_confine.c forbids it.
WRITES = re.compile(r'\bf(?:re)?open\s*\([^;]*"[wa]|\bO_CREAT\b|(?<![\w.>])(?:creat|rename|truncate)\s*\(|\bjson_dump_file\b')
WRITERS = ('pitviper_output.c', 'pitviper_confine.c', 'sensor/publish/memory/memory_ring.c')

# CSV is read by the base: pitviper_table.h gives rows as structs. Elsewhere nobody splits a line at its commas, or asks for
# cells one by one.
CELLS = re.compile(r'\b(?:text_split|table_open|table_column|table_number|table_text)\s*\(|'
                   r'\b(?:strtok(?:_r)?|strsep|strchr|strcspn|strpbrk)\s*\([^;()\n]*,\s*(?:"(?:[^"\n\\]|\\.)*,(?:[^"\n\\]|\\.)*"|\',\')\s*[,)]')
# Who else: lines before the header, places instead of names, codes for what is missing (EPW, TMY3); lists of words in one value; rows of any table.
SPLITTERS = ('terrain/weather/weather_file.c', 'entities/import/gltf_document.c', 'sensor/settings/*', 'sensor/verify/regress/record_frame.c', 'sensor/verify/bisect/row_changes.c',
             'terrain/elevation/reader/reader_set.c', 'terrain/import/terrain_*.c')

# Includes from one wing into another that are left out when circles between wings are looked for, with the reason.
WING_EXCEPTIONS = {}
# Circles between files (x.c, x.h and x_private.h are one), each as its sorted members, with the reason.
FILE_EXCEPTIONS = {}


def room_of(path):
    path = path.removeprefix('tests/')
    first = path.split('/')[0]
    if first in ROOMS or first in ('base', 'fuzz', 'analytic'):
        return first if '/' in path else 'top'
    return 'base' if path.startswith('pitviper') else 'top'


def allowed(path, header):
    room = room_of(path)
    if header in BASE_HEADERS or header.startswith('tests/') or room == 'base' and header.startswith('pitviper'):
        return True  # only tests have reason to include tests/, see below
    return header.startswith(room + '/') and room in ROOMS or any(fnmatch.fnmatch(header, h) for h in MAY[room])


def includes(text):
    return re.findall(r'^[ \t]*#[ \t]*include[ \t]*([<"])([^>"]+)[>"]', text, re.M)


def check_rooms(tree):
    for path, text in tree.items():
        for kind, header in includes(text):
            if kind == '<':
                places = [place for library, place in LIBRARIES if fnmatch.fnmatch(header, library)]
                judge = path.startswith('tests/')  # those that test a library's results may ask it
                if places and not judge and not any(fnmatch.fnmatch(path, place) for place in places):
                    yield f'{path}: <{header}> belongs to {" and ".join(places)} alone'
            elif header.startswith('tests/') and not path.startswith('tests/'):
                yield f'{path}: product code includes {header}'
            elif not allowed(path, header):
                yield f'{path}: {room_of(path)} may not include {header}'
            elif (header.endswith('_private.h') and os.path.dirname(header) != os.path.dirname(path)
                  and not path.startswith('tests/')):
                yield f'{path}: {header} is private to {os.path.dirname(header)}/'


def circles(graph):
    """The strongly connected parts of more than one node (Tarjan)."""
    index, low, stack, found = {}, {}, [], []

    def visit(node):
        index[node] = low[node] = len(index)
        stack.append(node)
        for other in sorted(graph[node]):
            if other not in index:
                visit(other)
                low[node] = min(low[node], low[other])
            elif other in stack:
                low[node] = min(low[node], index[other])
        if low[node] == index[node]:
            part = stack[stack.index(node):]
            del stack[stack.index(node):]
            if len(part) > 1:
                found.append(tuple(sorted(part)))

    sys.setrecursionlimit(10000)
    for node in sorted(graph):
        if node not in index:
            visit(node)
    return found


def unit_of(path):
    return re.sub(r'(_private)?\.(c|h|cpp)$', '', path)


def include_graphs(tree):
    """Files and wings as {node: those that it includes}, and of each pair of wings the includes that make it."""
    files, wings, why = collections.defaultdict(set), collections.defaultdict(set), collections.defaultdict(list)
    for path, text in tree.items():
        if path.startswith('tests/'):
            continue
        for kind, header in includes(text):
            if kind == '<' or header not in tree:
                continue
            if unit_of(path) != unit_of(header):
                files[unit_of(path)].add(unit_of(header))
                files[unit_of(header)]  # a node, though it includes nothing
            a, b = os.path.dirname(path), os.path.dirname(header)
            if a != b and a and b and room_of(path) == room_of(header):
                wings[a].add(b)
                wings[b]
                why[a, b].append(f'{path} includes {header}')
    return files, wings, why


def wing_circles(wings, exceptions):
    return circles({a: {b for b in others if (a, b) not in exceptions} for a, others in wings.items()})


def check_circles(tree):
    files, wings, why = include_graphs(tree)
    for part in circles(files):
        if part not in FILE_EXCEPTIONS:
            yield 'files in a circle: ' + ', '.join(part)
    for part in wing_circles(wings, WING_EXCEPTIONS):
        yield 'wings in a circle: ' + ', '.join(part) + ''.join(
            f'\n    {a} -> {b}: {len(lines)}: {lines[0]}' for (a, b), lines in sorted(why.items())
            if a in part and b in part and (a, b) not in WING_EXCEPTIONS)


def needless_exceptions(tree, wing_exceptions, file_exceptions):
    """Of a whole tree: exceptions without which no other circle is found."""
    files, wings, _ = include_graphs(tree)
    found = circles(files)
    for part in file_exceptions:
        if part not in found:
            yield 'an exception that nothing needs: files: ' + ', '.join(part)
    found = wing_circles(wings, wing_exceptions)
    for pair in wing_exceptions:
        if wing_circles(wings, set(wing_exceptions) - {pair}) == found:
            yield 'an exception that nothing needs: wings: ' + ' -> '.join(pair)


def check_first_lines(tree):
    for path, text in tree.items():
        first = text.split('\n', 1)[0]
        if path.endswith('.h'):
            continue
        if path.startswith('tests/') and not re.match(r'/\* \S', first):
            yield f'{path}: the first line does not say what it tests: {first}'
        elif not path.startswith('tests/') and not first.startswith(f'/* {path}: '):
            yield f'{path}: the first line is not `/* {path}: what it is`: {first}'


def check_writers(tree):
    for path, text in tree.items():
        if path.startswith(('tests/', 'etc/')) or path in WRITERS:
            continue
        for found in WRITES.finditer(text):
            yield f'{path}: {found.group(0).split("(")[0].strip()}: pitviper_output.h opens files for writing'


def check_cells(tree):
    for path, text in tree.items():
        if path.startswith(('tests/', 'pitviper')) or any(fnmatch.fnmatch(path, place) for place in SPLITTERS):
            continue
        for found in CELLS.finditer(text):
            yield f'{path}: {found.group(0).split("(")[0].strip()}: pitviper_table.h reads rows of CSV'


# A path of ours in a comment or a document. NAME stands for what a reader fills in, kiosk.c is one's own example.
NAMED = re.compile(r'(?<![\w/.-])((?:dis|terrain|entities|render|sensor|tests)/[\w./-]*\w\.(?:c|h|cpp|sh|py))\b')


def check_named(tree, documents, there):
    """Comments of sources, and documents {path: text}: what they name exists (there: path -> bool)."""
    for path, text in list(tree.items()) + list(documents.items()):
        said = text if path in documents else ' '.join(re.findall(r'/\*.*?\*/', text, re.S))
        for name in sorted(set(NAMED.findall(said))):
            if 'NAME' not in name and 'kiosk' not in name and not there(name):
                yield f'{path}: names {name}, which does not exist'


# Settings (lists of pitviper_settings.h): what is chosen among words is a CHOICE or a SWITCH, an enum or a bool, so that nothing compares
# words. Texts of any content that have a word of their own as well:
ENTRY = re.compile(r'\bROW\((\w+), (\w*)\.?, (\w+),')
WORDS_OF_TEXTS = {'sensor.preset', 'radar.preset', 'sensor.mount', 'exercise.host', 'weather.day', 'terrain.buildings'}


def check_choices(tree):
    keys = {(section, key) for path, text in tree.items() if path.endswith('.h') for kind, section, key in ENTRY.findall(text) if section}
    keys = '|'.join(sorted(rf'{section}\.{key}' for section, key in keys)) or 'no key'
    compared = re.compile(rf"""\bstrn?(?:case)?cmp\([^;"]*?(?:->|\.)({keys})\b, *"|\*[\w>.\[\]-]*(?:->|\.)({keys})\b *[=!]= *'""")
    for path, text in tree.items():
        if path.startswith('tests/'):
            continue
        for found in compared.finditer(text):
            key = found.group(1) or found.group(2)
            if key not in WORDS_OF_TEXTS:
                yield f'{path}: the words of {key} are compared: make it a CHOICE or a SWITCH (etc/ADDING.md)'
        if re.search(r'\{[^{}]*\bSETTING_TEXT\b[^{}]*"[\w-]+(?:\|[\w-]+)+"', text):
            yield f'{path}: a text with choices: make it a CHOICE or a SWITCH (etc/ADDING.md)'


CHECKS = (check_rooms, check_circles, check_first_lines, check_writers, check_choices, check_cells)


def violations(tree):
    return [line for check in CHECKS for line in check(tree)]


# Planted trees: each bad one must be caught, each good one passed. FILE: what it includes, with `first` its first line.
def twins():
    wrong = []

    def plant(bad, **files):
        tree = {}
        for path, headers in files.items():
            path = path.replace('__', '/').replace('_DOT_', '.')
            lines = ''.join(f'#include {h if h[0] == "<" else chr(34) + h + chr(34)}\n' for h in headers.split())
            tree[path] = f'/* {path}: planted. */\n{lines}'
        found = violations(tree)
        if bool(found) != bad:
            wrong.append(f'twin: {"not caught" if bad else "wrongly caught"}: {files} {found}')

    def one(bad, path, header):
        plant(bad, **{path: header})

    for path, header in re.findall(r'(\S+) (\S+)', """
        pitviper_log.c dis/pdu/pdu.h                        pitviper_log.c tests/bench/bench_private.h
        dis/pdu/pdu.c tests/bench/bench_private.h          sensor/commands/run_command.c tests/bench/suites.h
        sensor/publish/files/html_page.c tests/bench/bench.h      dis/pdu/pdu.c terrain/earth/geodesy.h
        dis/pdu/pdu.c entities/models/model.h               terrain/earth/sun.c dis/pdu/pdu.h
        entities/models/model.c render/frame/render.h   render/frame/render.c entities/table/entity_table.h
        render/frame/render.c dis/pdu/decode.h        render/frame/render.c sensor/detector/detector.h
        tests/dis/test_pdu.c entities/models/model.h    tests/render/test_render.c sensor/frame/plane.h
        sensor/node/loop.c render/trace/parts/parts_private.h sensor/node/loop.c loop.h
        dis/pdu/pdu.c tests/check.h                         entities/models/model.c <GeographicLib/Geocentric.hpp>
        sensor/truth/truth.c <jansson.h>                terrain/earth/geoid.c <gdal.h>
        sensor/detector/line_scan.c <fftw3.h>                entities/import/sidecar.c <assimp/scene.h>
        entities/import/sidecar.c <yaml.h>"""):
        one(True, path, header)
    for path, header in re.findall(r'(\S+) (\S+)', """
        tests/bench/bench_command.c tests/bench/bench_private.h tests/bench/render/precision_air.c render/air/air_private.h
        dis/pdu/pdu.c pitviper.h                            dis/pdu/pdu.c dis/pdu/reader_private.h
        render/air/air.c pitviper_simd.h                entities/table/entity_table.c dis/pdu/decode.h
        render/frame/render.c entities/table/snapshot.h sensor/node/loop.c dis/capture/log.h
        sensor/publish/truth.c <jansson.h>              tests/dis/test_pdu.c tests/check.h
        main.c sensor/commands/commands.h"""):
        one(False, path, header)
    # circles: of two files, through a third, of wings by different files; a line of wings, a file and its own headers
    plant(True, **{'dis/a.c': 'dis/a.h dis/b.h', 'dis/a.h': '', 'dis/b.h': '', 'dis/b.c': 'dis/a.h'})
    plant(True, **{'dis/a.h': 'dis/b.h', 'dis/b.h': 'dis/c.h', 'dis/c.h': '', 'dis/c.c': 'dis/a_private.h',
                   'dis/a_private.h': ''})
    plant(True, **{'render/p/a.c': 'render/q/b.h', 'render/q/b.h': '', 'render/q/c.c': 'render/p/d.h',
                   'render/p/d.h': ''})
    plant(False, **{'render/p/a.c': 'render/q/b.h', 'render/q/b.h': '', 'render/q/c.c': 'render/s/d.h',
                    'render/s/d.h': ''})
    plant(False, **{'dis/a.c': 'dis/a.h dis/a_private.h', 'dis/a_private.h': 'dis/a.h', 'dis/a.h': ''})
    # exceptions: one that breaks a circle, one of a pair without an include back, one of wings that are not there
    tree = {'render/p/a.c': '#include "render/q/b.h"\n', 'render/q/b.h': '',
            'render/q/c.c': '#include "render/p/d.h"\n',
            'render/p/d.h': '#include "render/s/e.h"\n', 'render/s/e.h': '#include "render/p/d.h"\n'}
    p_q, p_s, s_p, q_r = (tuple(f'render/{wing}' for wing in pair) for pair in ('pq', 'ps', 'sp', 'qr'))
    circle = ('render/p/d', 'render/s/e')
    for needless, pairs, parts in ((0, (p_q, p_s), (circle,)), (1, (p_q, p_s, q_r), ()), (2, (p_s, s_p), ()),
                                   (1, (p_q, p_s), (('render/p/a', 'render/q/b'),))):
        found = list(needless_exceptions(tree, pairs, parts))
        if len(found) != needless:
            wrong.append(f'twin: {needless} exceptions are not needed of {pairs} {parts}: {found}')
    for path, first in (('dis/a.c', '#include "dis/a.h"'), ('dis/a.c', '/* dis/b.c: another. */'),
                        ('tests/dis/test_a.c', '#include "tests/check.h"'), ('main.c', '')):
        if not violations({path: first + '\n'}):
            wrong.append(f'twin: not caught: {path} begins {first}')
    entries = '#define A(ROW) \\\n ROW(TEXT, lamp., colour, "red", 8, "", "") \\\n ROW(TEXT, sensor., preset, "none", 8, "", "")\n'
    for bad, line in ((True, 'strcmp(config->lamp.colour, "red")'), (True, 'f(1, !strncmp(s->of.config.lamp.colour, "red", 2))'),
                      (True, "if (*c->lamp.colour == 'r')"), (True, '{"lamp.colour", SETTING_TEXT, AT(colour), 0, 0, "red|dark-blue", "", ""}'),
                      (False, 'strcmp(config->lamp.colour, b->lamp.colour)'), (False, 'strcmp(config->sensor.preset, "none")'),
                      (False, 'strcmp(lamp->colour, "red")'), (False, 'if (!*c->lamp.colour)')):
        if bool(violations({'sensor/rows.h': entries, 'sensor/a.c': f'/* sensor/a.c: planted. */\n{line};\n'})) != bad:
            wrong.append(f'twin: {"not caught" if bad else "wrongly caught"}: {line}')
    for bad, line in ((True, '/* see dis/b.h */'), (False, '/* see dis/a.c */'), (False, '/* see dis/NAME.c */'), (False, 'puts("dis/b.h");')):
        if bool(list(check_named({'dis/a.c': line}, {}, lambda name: name == 'dis/a.c'))) != bad:
            wrong.append(f'twin: {"not caught" if bad else "wrongly caught"}: {line}')
    for bad, line in ((True, 'f = fopen(path, "wb");'), (True, 'open(p, O_WRONLY | O_CREAT, 0666);'), (True, 'rename(part, path);'),
                      (False, 'f = fopen(path, "rb");'), (False, 'output_rename(part, path);')):
        if bool(violations({'dis/a.c': f'/* dis/a.c: planted. */\n{line}\n'})) != bad:
            wrong.append(f'twin: {"not caught" if bad else "wrongly caught"}: {line}')
    for bad, line in ((True, 'n = text_split(cell, 9, line);'), (True, 'for (char *at; (at = strsep(&line, ","));) n++;'), (True, 'word = strtok_r(line, ",;", &rest);'),
                      (True, "at = strchr(at, ',');"), (True, 'status = table_number(&x, &table, row, 3, 0, 1);'), (False, 'status = table_rows_get(&row, &rows, 3);'),
                      (False, 'word = strtok_r(line, " ", &rest);')):
        if bool(violations({'dis/a.c': f'/* dis/a.c: planted. */\n{line}\n'})) != bad:
            wrong.append(f'twin: {"not caught" if bad else "wrongly caught"}: {line}')
    return wrong


def rooms_above(room):
    """The room and those that may include something of it."""
    if room == 'base':
        return ('base',) + ROOMS
    return (room,) + tuple(r for r in ROOMS if r != room and any(h.startswith(room + '/') for h in MAY[r]))


def tests_of(path):
    """Expressions of ctest's names for what knows this file."""
    folder, _, name = path.rpartition('/')
    stem = name.split('.')[0]
    if path.startswith('tests/'):
        part = path.split('/')[1]
        if stem.startswith('test_') and name != 'test_rows.sh' and part in ROOMS + ('base', 'bench', 'system', 'layers', 'fuzz'):
            return [('system' if name.endswith('.sh') else part) + '/' + stem + '$']
        if part in ROOMS + ('base', 'fuzz', 'system'):
            return [part + '/']
        return {'mutants': ['system/test_mutants'], 'regress': ['system/test_regress', 'system/test_mutants'],
                'layers': [], 'tools': ['system/'], 'bench': ['bench/', 'system/test_(bench|figures|quality)'],
                'scenes': ['bench/', 'sensor/', 'system/'], 'alloc': ['system/test_alloc']}.get(part, ['.'])
    if folder.startswith('.') or path.startswith('.') or name == 'LICENSE' or path in ('etc/test', 'etc/setup', 'etc/bits'):
        return []
    if name.endswith(('.md', '.svg', '.jpg', '.png')):
        return ['system/test_(adding|figures|reference|man|help)']
    room = room_of(path)
    if room in ROOMS:
        return [r + '/' for r in rooms_above(room)] + ['bench/', 'fuzz/', 'system/']
    return ['.']  # the base, the program, tables, how all is built


def changed_files(root, branch):
    def git(*words):
        ran = subprocess.run(('git', '-C', root) + words, capture_output=True, text=True)
        if ran.returncode:
            sys.exit(f'git {" ".join(words)}: {ran.stderr.strip()}; next: etc/test without --changed, or git fetch origin {branch}')
        return ran.stdout.split('\n')

    start = git('merge-base', branch, 'HEAD')[0]
    return sorted(set(git('diff', '--name-only', start) + git('ls-files', '--others', '--exclude-standard')) - {''})


def changed_tests(paths):
    found = sorted({expression for path in paths for expression in tests_of(path)} | ({'system/test_layers$'} if paths else set()))
    return '.' if '.' in found else '^(' + '|'.join(found) + ')' if found else ''


# Paths, and what their tests are.
def changed_twins():
    wrong = []
    for paths, good, bad in (
            (['dis/pdu/pdu.c'], 'dis/test_pdu entities/test_survey sensor/test_truth system/test_live fuzz/fuzz_pdu', 'terrain/test_sun base/test_log'),
            (['render/air/air.c'], 'render/test_air sensor/test_truth', 'dis/test_pdu entities/test_survey terrain/test_sun'),
            (['sensor/commands/run_command.c'], 'sensor/test_truth system/test_live bench/network', 'render/test_air'),
            (['tests/bench/render/precision_air.c'], 'bench/precision_render bench/test_bench', 'render/test_air'),
            (['tests/dis/test_pdu.c'], 'dis/test_pdu system/test_layers', 'dis/test_data dis/test_pdu_more system/test_live'),
            (['tests/system/test_live.sh'], 'system/test_live', 'system/test_live_network dis/test_pdu'),
            (['pitviper.h'], 'base/test_log dis/test_pdu system/test_live', ''), (['etc/materials.csv'], 'render/test_air', ''),
            (['README.md'], 'system/test_figures', 'dis/test_pdu system/test_live'), ([], '', 'system/test_layers')):
        pattern = changed_tests(paths)
        for names, want in ((good, True), (bad, False)):
            for name in names.split():
                if bool(pattern and re.search(pattern, name)) != want:
                    wrong.append(f'twin: {paths} changed: {name} is {"left out" if want else "run"}: {pattern}')
    return wrong


def read_tree(root):
    tree = {}
    for folder, folders, names in os.walk(root):
        folders[:] = [f for f in folders if not (folder == root and (f.startswith('build') or f[0] == '.'))]
        for name in names:
            if name.endswith(('.c', '.h', '.cpp')):
                path = os.path.join(folder, name)
                with open(path, encoding='utf-8', errors='replace') as file:
                    tree[os.path.relpath(path, root)] = file.read()
    return tree


def read_documents(root):
    """Pages, and comments of tables: what a reader is told."""
    documents = {}
    for folder, folders, names in os.walk(root):
        folders[:] = [f for f in folders if not (folder == root and (f.startswith('build') or f[0] == '.'))]
        for name in names:
            path = os.path.relpath(os.path.join(folder, name), root)
            if name.endswith(('.md', '.csv', '.sheet')) and name != 'CHANGELOG.md':
                with open(os.path.join(folder, name), encoding='utf-8', errors='replace') as file:
                    documents[path] = file.read()
    return documents


def main():
    if len(sys.argv) == 4 and sys.argv[2] == '--changed':
        print(changed_tests(changed_files(sys.argv[1], sys.argv[3])))
        return False
    wrong = twins() + changed_twins()
    tree = read_tree(sys.argv[1])
    wrong += violations(tree)
    wrong += check_named(tree, read_documents(sys.argv[1]), lambda name: os.path.exists(os.path.join(sys.argv[1], name)))
    wrong += needless_exceptions(tree, WING_EXCEPTIONS, FILE_EXCEPTIONS)
    for line in wrong:
        print(line)
    product = sum(not path.startswith('tests/') for path in tree)
    print(f'layers: {product} files in {len({os.path.dirname(p) for p in tree if not p.startswith("tests/")})} folders; '
          f'{len(wrong)} against the rules; {len(WING_EXCEPTIONS)} exceptions between wings, {len(FILE_EXCEPTIONS)} '
          'between files')
    return bool(wrong)


if __name__ == '__main__':
    sys.exit(main())
