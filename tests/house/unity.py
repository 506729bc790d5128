"""unity.py BUILD: of files that are compiled as one, no two have a function of their own by the same name.

Types and constants the compiler refuses; of functions it may take the other file's, if that fits the arguments better.
"""
import collections
import pathlib
import re
import sys

OWN = re.compile(r'^namespace \{\n(.*?)^\}  // namespace\n', re.M | re.S)
FUNCTION = re.compile(r'^(?![ /}#])[\w:<>,&*\[\] .]+?[ &*>](\w+)\(', re.M)


def own_functions(path):
    bodies = OWN.findall(pathlib.Path(path).read_text())
    return {name for body in bodies for name in FUNCTION.findall(body)} - {'decltype'}


files = sorted(pathlib.Path(sys.argv[1]).glob('**/Unity/*.cxx'))
if not files:
    print('no files are compiled as one here')
    sys.exit(77)
wrong = 0
for unity in files:
    where = collections.defaultdict(list)
    for path in re.findall(r'#include "(.*)"', unity.read_text()):
        for name in own_functions(path):
            where[name].append(path)
    for name, paths in sorted(where.items()):
        if len(paths) > 1:
            wrong += 1
            print(f'{name}() is a function of their own in {" and ".join(paths)}: rename it, or name one after ALONE')
sys.exit(1 if wrong else print(f'{len(files)} groups, nothing to complain about'))
