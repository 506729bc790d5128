#!/usr/bin/env python3
"""Holds the documentation to plain technical English: language.py ROOT

Prints file, line and a suggestion for each private term and each sentence of more than 40 words. Code, quoted program
output and tables are not checked for length; text in backticks is not checked at all.
"""
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
}
LONGEST = 40  # words
# Where a term is quoted from the program, which still says so: (file, term).
QUOTED = {
    ('docs/measured-data.md', 'stands off zero'): 'a message',
    ('docs/measured-data.md', 'stands still'): 'a message',
}


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


def faults(root):
    pages = sorted([*root.glob('docs/*.md'), root / 'README.md', root / 'data/README.md'])
    for path in pages:
        if path.name == 'laws.md':  # written by the program
            continue
        name = path.relative_to(root).as_posix()
        text = path.read_text()
        fence = False
        for number, line in enumerate(text.splitlines(), 1):
            if line.startswith('```'):
                fence = not fence
            if fence or line.startswith('    '):
                continue
            shown = plain(line)
            for term, better in TERMS.items():
                if found := re.search(term, shown, re.I):
                    if (name, found[0].lower()) not in QUOTED:
                        yield f'{name}:{number}: "{found[0]}": write {better}'
        for number, paragraph in prose(text):
            for sentence in re.split(r'(?<=[.!?:;])\s+(?=[A-Z*])', plain(paragraph)):
                words = [w for w in sentence.split() if re.search(r'[A-Za-z]{2}', w)]
                if len(words) > LONGEST:
                    yield f'{name}:{number}: a sentence of {len(words)} words: split it ("{" ".join(words[:6])} …")'


def main():
    found = list(faults(pathlib.Path(sys.argv[1])))
    print('\n'.join(found) or 'no private terms, no long sentences')
    sys.exit(1 if found else 0)


if __name__ == '__main__':
    main()
