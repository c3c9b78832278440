"""Compiles one source of a build folder again, and links its programs with that object; used by mutate.py and ran.py."""
import json
import os
import re
import shlex
import shutil
import signal
import subprocess
import time


class Failure(Exception):
    """What the user is told."""


class Programs:
    """A build folder made by CMake and Ninja, read only: how its objects are compiled and its programs linked."""

    def __init__(self, root, build):
        self.root, self.build = os.path.abspath(root), os.path.abspath(build)
        self.compiles = {}  # source -> (library, object in the build folder, arguments without output and input)
        self.members = {}   # library -> its objects, in order
        self.links = {}
        try:
            with open(os.path.join(self.build, 'compile_commands.json'), encoding='utf-8') as stream:
                entries = json.load(stream)
        except OSError as error:
            raise Failure(f'{error.filename}: {error.strerror}; next: cmake --preset release && cmake --build --preset release')
        for entry in entries:
            words = shlex.split(entry['command'])
            out = words[words.index('-o') + 1]
            match = re.match(r'CMakeFiles/([\w-]+)\.dir/', out)
            source = os.path.relpath(entry['file'], self.root)
            if not match or not os.path.exists(os.path.join(self.build, f'lib{match[1]}.a')):
                continue
            self.members.setdefault(match[1], []).append(out)
            while not re.fullmatch(r'(.*/)?(cc|c\+\+|gcc|g\+\+|clang|clang\+\+)(-\d+)?', words[0]):
                words.pop(0)  # ccache
            at = words.index('-o')
            self.compiles[source] = (match[1], out, [w for w in words[:at] + words[at + 4:] if w != '-Werror'])

    def compile(self, source, text, out, folder, extra=()):
        """Compiles text in the place of source; whether that was possible. Its own includes and lines stay as they were."""
        _, _, words = self.compiles[source]
        whole = os.path.join(self.root, source)
        copy = os.path.join(folder, os.path.basename(source))
        with open(copy, 'w', encoding='utf-8') as stream:
            stream.write(f'#line 1 "{whole}"\n{text}')
        done = subprocess.run([*words, '-w', *extra, '-iquote', os.path.dirname(whole), '-c', copy, '-o', out], cwd=self.build,
                              env={**os.environ, 'CCACHE_DISABLE': '1'}, stderr=subprocess.DEVNULL, check=False)
        return done.returncode == 0

    def link_line(self, program):
        if program not in self.links:
            said = subprocess.run(['ninja', '-C', self.build, '-t', 'commands', program], capture_output=True, text=True,
                                  check=False)
            if said.returncode != 0:
                raise Failure(f'ninja knows no {program} in {self.build}; next: cmake --build {self.build} --target {program}')
            self.links[program] = said.stdout.rstrip('\n').split('\n')[-1]
        return self.links[program]

    def has(self, program, library):
        return f' lib{library}.a' in self.link_line(program)

    def link(self, program, out, objects=(), libraries=None, extra=''):
        """Links program anew as out, with objects before all libraries, whose members are then not taken."""
        line = self.link_line(program)
        for name, path in (libraries or {}).items():
            line = line.replace(f' lib{name}.a', ' ' + shlex.quote(path))
        if os.path.lexists(out):
            os.remove(out)  # may be a link into the build folder
        line = line.replace(f' -o {program} ', f' {shlex.join(objects)} {extra} -o {shlex.quote(out)} ', 1)
        done = subprocess.run(line, shell=True, cwd=self.build, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise Failure(f'{program} cannot be linked with {objects}; next: cmake --build {self.build} --target {program}\n' +
                          done.stderr[-1000:])


class Stand:
    """A build folder made of links to another, in which some programs are others. One job works in it."""

    def __init__(self, programs, folder):
        self.programs, self.folder = programs, folder
        self.build = os.path.join(folder, 'build')
        shutil.rmtree(folder, ignore_errors=True)
        os.makedirs(os.path.join(self.build, 'tests'))
        for at in ('', 'tests'):
            for name in os.listdir(os.path.join(programs.build, at)):
                if os.path.join(at, name) != 'tests':
                    os.symlink(os.path.join(programs.build, at, name), os.path.join(self.build, at, name))
        self.other = set()

    def link(self, program, **how):
        if program not in self.other:
            self.other.add(program)
            self.programs.link(program, os.path.join(self.build, program), **how)

    def clean(self):
        for program in self.other:
            path = os.path.join(self.build, program)
            if os.path.lexists(path):
                os.remove(path)
            os.symlink(os.path.join(self.programs.build, program), path)
        self.other = set()
        shutil.rmtree(os.path.join(self.folder, 'cache'), ignore_errors=True)

    def run(self, test, limit_s, environment=()):
        """Runs a test on this folder's programs: (exit status or 'hang', seconds)."""
        words = [w.replace(self.programs.build, self.build) for w in test.command]
        cache = os.path.join(self.folder, 'cache')
        os.makedirs(cache, exist_ok=True)
        begun = time.monotonic()
        child = subprocess.Popen(words, cwd=test.folder, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                 stderr=subprocess.DEVNULL, start_new_session=True,
                                 env={**os.environ, **test.environment, 'XDG_CACHE_HOME': cache, **dict(environment)})
        try:
            code = child.wait(limit_s)
        except subprocess.TimeoutExpired:
            code = 'hang'
        finally:  # also what it left in the background
            try:
                os.killpg(child.pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
            child.wait()
        return code, time.monotonic() - begun


class Test:
    """A test of ctest's list."""

    def __init__(self, entry, build):
        properties = {p['name']: p['value'] for p in entry.get('properties', [])}
        self.name, self.command = entry['name'], entry['command']
        self.labels = set(properties.get('LABELS', []))
        self.folder = properties.get('WORKING_DIRECTORY', build)
        self.environment = dict(e.split('=', 1) for e in properties.get('ENVIRONMENT', []))
        self.skip = properties.get('SKIP_RETURN_CODE', 77)
        path = os.path.relpath(self.command[0], build) if os.path.isabs(self.command[0]) else ''
        self.system = path.startswith('..') or not path
        self.program = 'pitviper' if self.system else path


def tests_of(build):
    said = subprocess.run(['ctest', '--test-dir', build, '--show-only=json-v1'], capture_output=True, text=True, check=False)
    if said.returncode != 0:
        raise Failure(f'ctest lists no tests of {build}; next: cmake --preset release')
    return [Test(e, os.path.abspath(build)) for e in json.loads(said.stdout)['tests'] if 'command' in e]
