#!/usr/bin/env python3
"""Holds the tree to the house's own rules: house.py RULE ROOT; exit code 1 with a line for each fault.

arrows      a room includes only rooms that it stands on, and a folder in it only folders below
folders     no folder has more than 30 source files, but with a reason in CROWDED
json        JSON is named in io/, apps/ and python/ alone
size        no file has more than 600 lines, but with a reason in its first lines: "Longer than 600 lines: …"
functions   no function has more than 120 lines, but with a reason above it: "Longer than 120 lines: …"
repetition  no 12 or more lines of code stand twice
versions    what names the project's version names that of CMakeLists.txt
"""
import collections
import pathlib
import re
import subprocess
import sys

ROOMS = {
    'base': set(),
    'io': {'base'},
    'signals': {'base', 'io'},
    'fem': {'base'},
    'dynamics': {'base', 'io', 'signals'},
    'emulator': {'base', 'io'},
    'inference': {'base'},
    'identification': {'base', 'io', 'signals', 'fem', 'dynamics', 'emulator', 'inference'},
    'apps': {'base', 'io', 'signals', 'fem', 'dynamics', 'emulator', 'inference', 'identification'},
    # On apps, not on identification alone: cases are parsed, and runs written, in one place.
    'python': {'base', 'io', 'signals', 'inference', 'apps'},
}
# The folders in a room, lowest first; '' is the room's own. A file includes files of its folder and
# of those before it.
FOLDERS = {
    'io': ['', 'text', 'tables', 'netcdf', 'matlab', 'universal', 'drawings', 'formats'],
    'signals': ['', 'modal'],
    'fem': ['', 'beam', 'sections', 'structures', 'structures/modes', 'structures/defects', 'structures/reanalysis'],
    'inference': ['', 'statistics', 'mixtures', 'model', 'search', 'evidence', 'moves', 'moves/between_models',
                  'chains', 'diagnosis', 'exploration', 'engine'],
    'identification': ['', 'findings', 'emulation', 'structural', 'structural/defects', 'structural/likelihood', 'structural/forward',
                       'structural/problem', 'structural/updating', 'structural/damage', 'structural/damage/findings', 'sid/residuals', 'sid', 'sid/findings', 'modal',
                       'monitoring/kernels', 'monitoring', 'monitoring/causes', 'monitoring/charts', 'planning'],
    'apps': ['', 'cases/syntax', 'cases/structures', 'cases/records', 'cases', 'cases/monitoring', 'cases/planning', 'text', 'remote', 'results/measured', 'results', 'results/monitoring', 'results/planning', 'report',
             'runs', 'runs/sid', 'runs/batch', 'application', 'commands', 'cli'],
}
MOST_FILES = 30
CROWDED = {
    'apps/commands': 'a file for each command, and what they share',
}
LONGEST = 600
LONGEST_FUNCTION = 120
REPEATED = 12


def sources(root, rooms):
    """The C++ files of these folders that git knows or would add."""
    listed = subprocess.run(['git', '-C', root, 'ls-files', '-co', '--exclude-standard', *rooms],
                            capture_output=True, text=True)
    if listed.returncode == 0 and listed.stdout:
        names = [pathlib.Path(root, name) for name in listed.stdout.splitlines()]
    else:  # a tarball
        names = [p for room in rooms for p in pathlib.Path(root, room).rglob('*')]
    return sorted({p for p in names if p.suffix in ('.hpp', '.cpp') and p.is_file()})


def arrows(root):
    for path in sources(root, ROOMS):
        name = path.relative_to(root)
        room = name.parts[0]
        for number, line in enumerate(path.read_text().splitlines(), 1):
            included = re.match(r'\s*#\s*include\s*"([a-z]+)/', line)
            if included and included[1] in ROOMS and included[1] not in ROOMS[room] | {room}:
                yield f'{name}:{number}: {room} must not know {included[1]}'
    for path in sources(root, FOLDERS):
        name = path.relative_to(root)
        room, own = name.parts[0], '/'.join(name.parts[1:-1])
        order = FOLDERS[room]
        if own not in order:
            yield f'{name}: the folder {own} has no place in FOLDERS of {pathlib.Path(__file__).name}'
            continue
        for number, line in enumerate(path.read_text().splitlines(), 1):
            included = re.match(rf'\s*#\s*include\s*"{room}/((?:\w+/)*)\w+\.hpp"', line)
            other = included[1].rstrip('/') if included else own
            if other in order and order.index(other) > order.index(own):
                yield f'{name}:{number}: {own or room} must not know {other}, which stands on it'


def folders(root):
    counts = collections.Counter(path.parent.relative_to(root).as_posix() for path in sources(root, ROOMS))
    for folder, n in counts.items():
        if n > MOST_FILES and folder not in CROWDED:
            yield f'{folder}: {n} source files, more than {MOST_FILES}: split it by subject'
        if n <= MOST_FILES and folder in CROWDED:
            yield f'{folder}: {n} source files need no reason in CROWDED'


def json(root):
    for path in sources(root, [room for room in ROOMS if room not in ('io', 'apps', 'python')]):
        for number, line in enumerate(path.read_text().splitlines(), 1):
            if re.search(r'nlohmann|\bJson\b', line):
                yield f'{path.relative_to(root)}:{number}: names JSON'


def size(root):
    for path in sources(root, [*ROOMS, 'tests', 'bench', 'examples']):
        lines = path.read_text().splitlines()
        if len(lines) > LONGEST and not any('Longer than 600 lines:' in line for line in lines[:12]):
            yield f'{path.relative_to(root)}: {len(lines)} lines, and no reason why'


def functions(root):
    """By the layout of clang-format: a function ends where a bracket stands as far left as its first line."""
    for path in sources(root, ROOMS):
        lines = path.read_text().splitlines()
        for first, line in enumerate(lines):
            # Namespaces are not indented, classes indent their functions by two blanks.
            begins = re.match(r'(|  )(?!namespace|struct|class|enum|union|extern|using|if|for|while|switch|else|do\b|'
                              r'return|throw)[\w~[][^=(]*\(', line)
            if not begins or line.endswith(('};', ';')):
                continue
            indent = begins[1]
            # Its signature may take several lines; its body begins with the bracket at the end of one.
            body = next((i for i in range(first, min(first + 12, len(lines))) if lines[i].endswith('{')), None)
            if body is None or any(lines[i].endswith((';', '}', '},', ')')) and i > first for i in range(first, body)):
                continue
            if not all(lines[i].startswith(indent + ' ') for i in range(first + 1, body + 1)):
                continue
            last = next((i for i in range(body + 1, len(lines)) if lines[i].rstrip(';)') == indent + '}'), body)
            above = ' '.join(lines[max(0, first - 6):first])
            if last - first + 1 > LONGEST_FUNCTION and 'Longer than 120 lines:' not in above:
                yield f'{path.relative_to(root)}:{first + 1}: a function of {last - first + 1} lines, and no reason why'


def repetition(root):
    places = collections.defaultdict(list)
    texts = {}
    for path in sources(root, ROOMS):
        # Lines that say something: includes and lone brackets may stand anywhere.
        kept = [(number, line.strip()) for number, line in enumerate(path.read_text().splitlines(), 1)
                if line.strip() and not line.strip().startswith(('#include', '//'))]
        texts[path] = kept
        for i in range(len(kept) - REPEATED + 1):
            places[tuple(line for _, line in kept[i:i + REPEATED])].append((path, i))
    told = set()
    for block, where in places.items():
        if len(where) < 2:
            continue
        (a, i), (b, j) = where[:2]
        # One line for a run, however long: the one before it is not repeated too.
        before = (a, i - 1) in told and (b, j - 1) in told
        told.update([(a, i), (b, j)])
        if not before:
            yield (f'{a.relative_to(root)}:{texts[a][i][0]} and {b.relative_to(root)}:{texts[b][j][0]}: '
                   f'the same {REPEATED} lines or more')


def versions(root):
    text = pathlib.Path(root, 'CMakeLists.txt').read_text()
    version = re.search(r'project\(wheeltap VERSION (\d+\.\d+\.\d+)', text)[1]
    for name, line in {'CITATION.cff': r'^version: (.*)$', 'codemeta.json': r'"version": "([^"]*)"'}.items():
        said = re.search(line, pathlib.Path(root, name).read_text(), re.M)
        if not said or said[1] != version:
            yield f'{name}: version {said[1] if said else "not said"}, but the project is {version}'
    changes = pathlib.Path(root, 'CHANGELOG.md').read_text()
    if f'\n## {version}' not in changes:
        yield f'CHANGELOG.md: nothing of {version}'


def main():
    rule, root = sys.argv[1], sys.argv[2]
    faults = list({'arrows': arrows, 'folders': folders, 'json': json, 'functions': functions, 'size': size, 'repetition': repetition,
                   'versions': versions}[rule](root))
    print('\n'.join(faults) or f'{rule}: nothing to complain about')
    sys.exit(1 if faults else 0)


if __name__ == '__main__':
    main()
