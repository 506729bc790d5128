#!/usr/bin/env python3
"""Holds all texts to plain technical English: language.py ROOT [SAMPLES]

Prints file, line and a suggestion for each private term and each sentence of more than 40 words, in the pages of docs/, in the
comments and string literals of the code, and in the descriptions of the schemas. Code, quoted program output and tables of
pages are not checked for length; text in backticks is not checked at all. With SAMPLES, a file of faulty sentences, one per line:
whether the check finds a fault in each.
"""
import json
import pathlib
import re
import sys

# Terms of our own, and the field's.
TERMS = {
    r'in the house': 'in the repository',
    r'map of the house': 'repository layout',
    r'(?:is|are) a shell of': 'is behind',
    r'\bmend(?:s|ed|ing)?\b': 'correct',
    r'\bforgiv(?:e|es|ing)\b': 'heavy tails',
    r'\bvouch(?:es|ed)?\b': 'name what the diagnosis covers',
    r'\bleans? on\b': 'is dominated by, piles up at a bound',
    r'\bstands? still\b': 'dropout',
    r'\bstands? off zero\b': 'DC offset',
    r'\bforet(?:ell|ells|old|elling)\b': 'predict',
    r'\bits own image\b': 'symmetric',
    r'\basked of\b': 'requested',
    r'\b(?:un)?said unasked\b': 'reported automatically',
    r'\bdear(?:er|est)?\b': 'expensive',
    r'\bwithout a word\b': 'silently',
    r'\bwhat it costs\b': 'run time and memory',
    r'\bis refused\b': 'Wheeltap rejects (who does what)',
    r'\bare refused\b': 'Wheeltap rejects (who does what)',
    r'\bis said\b': 'state who reports it',
    r'\bare told\b': 'state who reports it',
    r'\bnever entered\b': 'not evaluated',
    r'\bsomeone else\'s\b': 'external',
    r'\bother people\'s\b': 'external',
    r'\bof (?:its|one\'s|your) own (?:worth|devising)\b': 'name it',
    r'\bhonest (?:numbers|probabilities)\b': 'calibrated probabilities',
    r'\bhow bad\b': 'severity',
    r'\bquick look\b': 'quick run',
    r'\bpoor(?:er|est)? (?:model|rig|man)\b': 'inaccurate',
    r'\bwalks? home\b': 'say what happens',
    r'\bhearsay\b': 'say what happens',
    # Sentences that do not name their subject (rule 4), and figures of speech (rule 5).
    r'^What (?!if\b|is\b.*\?)': 'begin with the noun that the sentence is about',
    r'^(?:That|Which) (?:a|the|it|there|sensors|is)\b(?!.*\?)': 'begin with the noun that the sentence is about',
    r'^(?:Of|For|From) (?:them|these|those|which|each|more|this)\b(?!.* (?:see|it follows))': 'begin with the noun that the sentence is about',
    r'^Of (?:an?|the|two|three|four|five|six|seven|eight|nine|ten|several|all|some) ': 'begin with the noun that the sentence is about',
    r'\bwhere there (?:is|are) none\b': 'name the thing that is missing',
    r'\bthat which\b': 'name the thing',
    r'\bwherever that goes\b': 'name the destination',
    r'\b(?:had|have|has) a glance\b': 'evaluate briefly',
    r'\blooks? (?:is|was|are) taken\b': 'quick run',
    r'\b(?:nobody|nothing|no one|never) (?:has )?looked at\b': 'not evaluated',
    r'\b(?:is|are|was) spoken of\b': 'name who reports it',
    r'\b(?:and|that|it|has) said so\b': 'reports this',
    r'\bsays so\b': 'reports this',
    r'\bit is said\b': 'name who reports it',
    r'\b(?:says?|saying|say) (?:nothing|something|little|much) of\b': 'has no information about',
    r'\bgo(?:es)? on(?: with| from| where| bit|[.,;:]|$)': 'continue, resume',
    r'\b(?:one|once|an?) (?:\w+ )?an? (?:mode|frequency|line|run|draw|sensor|row|case|variable|record|damage|value|element|'
    r'parameter|chain|model|channel|state|site|window|column)\b': 'one … per …',
    r'\bprints a line each\b': 'one line per …',
    r'\blikeliest\b': 'most probable',
    r'\bits own worth\b': 'its reliability',
    r'\bshun(?:s|ned|ning)?\b': 'avoid',
    r'\binnocent\b': 'without effect',
    r'\bstands? nowhere\b': 'is not used',
    r'\bas many \w+ as you like\b': 'any number of',
    r'\bcome less often\b': 'write less often',
    r'\bwalks? the same path\b': 'use the same path',
    r'\bmeans the same in every\b': 'name the thing',
    r'\b(?:nobody|no one) (?:asked|asks)\b': 'not requested',
    r'(?<!there )\bis no (?:frequency|model|cubic|number|mode|shape|record|file)\b': 'is not a',
    r'\bnot settled\b': 'not converged',
    r'\bcannot tell\b(?! (?:them|the|two|it|a|which|x|these|mirror)\b)': 'cannot distinguish',
}
LONGEST = 40  # words
CODE = ['base', 'io', 'signals', 'fem', 'dynamics', 'emulator', 'inference', 'identification', 'apps', 'python', 'tests']
# Where a term is quoted from the program, which still says so: (file, term).
QUOTED = {}


def prose(text):
    """(line, paragraph) of what is no code, table or quotation."""
    fence, start, lines = False, 0, []
    for number, line in enumerate(text.splitlines() + [''], 1):
        if line.startswith('```'):
            fence = not fence
        block = fence or line.startswith(('```', '    ', '|', '#', '>', '![', ': '))
        item = re.match(r' {0,3}(?:[-*]|\d+\.) ', line)
        if lines and (block or not line.strip() or item):
            yield start, ' '.join(lines)
            lines = []
        if block or not line.strip():
            continue
        if not lines:
            start = number
        lines.append(line.strip())


def plain(text):
    text = re.sub(r'`[^`]*`', 'x', text)
    text = re.sub(r'\[([^\]]*)\]\([^)]*\)', r'\1', text)
    return re.sub(r'"[^"]*"', '"x"', text)


def terms(name, number, text, whole=True):
    """Faults of TEXT; if it is not WHOLE, but may begin within a sentence, its beginning counts only with a capital letter."""
    for term, better in TERMS.items():
        if term.startswith('^') and not whole and text[:1].islower():
            continue
        if found := re.search(term, text, re.I):
            if (name, found[0].lower()) not in QUOTED:
                yield f'{name}:{number}: "{found[0]}": write {better}'


def long_sentences(name, number, text):
    for sentence in re.split(r'(?<=[.!?:;])\s+(?=[A-Z*])', text):
        words = [w for w in sentence.split() if re.search(r'[A-Za-z]{2}', w)]
        if len(words) > LONGEST:
            yield f'{name}:{number}: a sentence of {len(words)} words: split it ("{" ".join(words[:6])} …")'


def page_faults(name, text):
    fence = False
    for number, line in enumerate(text.splitlines(), 1):
        if line.startswith('```'):
            fence = not fence
        if not fence and not line.startswith('    '):
            yield from terms(name, number, plain(line), whole=False)
    for number, paragraph in prose(text):
        yield from long_sentences(name, number, plain(paragraph))


COMMENT = re.compile(r'\s*//+[!<]?(?: |$)(.*)')
LITERAL = re.compile(r'"((?:[^"\\\n]|\\.)*)"')


# Literals on either side of a comma are different texts, unless the comma is within the arguments of a call.
SEPARATED, NESTED = re.compile(r'[,;{}]'), re.compile(r'\([^()]*\)')


def code_texts(text):
    """(line, text, whole) of each paragraph of comments and of each string literal, adjacent ones joined.

    Literals are not whole: they may begin within a sentence. Neither are indented lines of comments: formulas and grammars.
    """
    start, lines, literal, literal_start = 0, [], [], 0
    for number, line in enumerate(text.splitlines() + [''], 1):
        comment = COMMENT.match(line)
        words = comment[1].strip() if comment else ''
        item = bool(re.match(r'(?:-|\d+\.|\\|@) ?', words))
        indented = bool(comment) and comment[1].startswith('  ') and not (lines and re.match(r'(?:-|\d+\.) ', lines[0]))
        if lines and (not words or item or indented):
            yield start, ' '.join(lines), True
            lines = []
        if indented:
            yield number, words, False
        elif words:
            start = start if lines else number
            lines.append(words)
        elif not comment:
            code, trailing = (re.split(r'\s//+[!<]? ', line, maxsplit=1) + [''])[:2]
            if trailing:
                yield number, trailing, True
            if not code.lstrip().startswith('#include'):
                if literal and not code.lstrip().startswith('"'):
                    yield literal_start, ' '.join(literal), False
                    literal = []
                rest = code
                while found := LITERAL.search(rest):
                    if literal and SEPARATED.search(NESTED.sub('', rest[:found.start()])):
                        yield literal_start, ' '.join(literal), False
                        literal = []
                    literal_start = literal_start if literal else number
                    literal.append(found[1])
                    rest = rest[found.end():]
                if literal and SEPARATED.search(NESTED.sub('', rest)):
                    yield literal_start, ' '.join(literal), False
                    literal = []


def descriptions(node):
    if isinstance(node, dict):
        for key in ('title', 'description'):
            if isinstance(node.get(key), str):
                yield node[key]
        for value in node.values():
            yield from descriptions(value)
    elif isinstance(node, list):
        for value in node:
            yield from descriptions(value)


def faults(root):
    for path in sorted([*root.glob('docs/*.md'), root / 'README.md', root / 'data/README.md']):
        if path.name != 'laws.md':  # written by the program
            yield from page_faults(path.relative_to(root).as_posix(), path.read_text())
    for path in sorted(root.glob('apps/schema/*.json')):
        name = path.relative_to(root).as_posix()
        lines = path.read_text().splitlines()
        for text in descriptions(json.loads('\n'.join(lines))):
            number = next((n for n, line in enumerate(lines, 1) if json.dumps(text, ensure_ascii=False) in line), 1)
            yield from terms(name, number, plain(text))
            yield from long_sentences(name, number, plain(text))
    for folder in CODE:
        for path in sorted([*root.glob(f'{folder}/**/*.hpp'), *root.glob(f'{folder}/**/*.cpp')]):
            name = path.relative_to(root).as_posix()
            for number, text, whole in code_texts(path.read_text()):
                yield from terms(name, number, plain(text), whole)
                yield from long_sentences(name, number, plain(text))


def missed_samples(path):
    """Sentences of PATH, all of them faulty, in which nothing is found."""
    for number, line in enumerate(path.read_text().splitlines(), 1):
        if not list(terms(path.name, number, plain(line))):
            yield f'{path.name}:{number}: the check passes over "{line}"'


def main():
    if len(sys.argv) == 3:
        found = list(missed_samples(pathlib.Path(sys.argv[2])))
        print('\n'.join(found) or 'every sample is found')
        sys.exit(1 if found else 0)
    found = list(faults(pathlib.Path(sys.argv[1])))
    print('\n'.join(found) or 'no private terms, no long sentences', f'\n{len(found)} faults' if found else '')
    sys.exit(1 if found else 0)


if __name__ == '__main__':
    main()
