"""unity.py BUILD: of files that are compiled as one, no two have a function of their own by the same name, and none has
one by the name of a function of the folder's headers that another of these files calls.

The compiler refuses types and constants of one name. Of functions it may take the other file's, if that fits the arguments
better; and an anonymous namespace hides the functions of the namespace around it, even where those alone would fit.
"""
import collections
import pathlib
import re
import sys

OWN = re.compile(r'^namespace \{\n(.*?)^\}  // namespace\n', re.M | re.S)
FUNCTION = re.compile(r'^(?![ /}#])[\w:<>,&*\[\] .]+?[ &*>](\w+)\(', re.M)


def own_functions(path):
    """Of a file with a namespace of its own, named after it, none: others' functions do not reach into it."""
    text = pathlib.Path(path).read_text()
    bodies = [] if re.search(rf'^namespace (wheeltap::\w+::)?{pathlib.Path(path).stem} \{{', text, re.M) else OWN.findall(text)
    return {name for body in bodies for name in FUNCTION.findall(body)} - {'decltype'}


def public_functions(root, top, cache={}):
    """Names of the functions that the headers of a top-level folder declare outside of classes."""
    if top not in cache:
        names = set()
        for header in (root / top).rglob('*.hpp'):
            names.update(re.findall(r'^(?:\[\[nodiscard\]\] |inline )*[\w:<>,&* ]+?[ &*>](\w+)\(', header.read_text(), re.M))
        cache[top] = names
    return cache[top]


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
    sources = re.findall(r'#include "(.*)"', unity.read_text())
    root = pathlib.Path(__file__).resolve().parent.parent.parent
    for name, paths in sorted(where.items()):
        top = pathlib.Path(paths[0]).resolve().relative_to(root).parts[0]
        if top != 'tests' and name in public_functions(root, top):
            callers = [path for path in sources if path not in paths
                       and any(re.search(rf'(?<![\w.>:]){name}\(', body)
                               for body in OWN.findall(pathlib.Path(path).read_text()))]
            if callers:
                wrong += 1
                print(f'{name}() of {paths[0]} hides the function of the headers from {callers[0]}: rename it')
        if len(paths) > 1:
            wrong += 1
            print(f'{name}() is a function of their own in {" and ".join(paths)}: rename it, or name one after ALONE')
sys.exit(1 if wrong else print(f'{len(files)} groups, nothing to complain about'))
