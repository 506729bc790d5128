"""Draws 100 random sentences from the manual, the comments of headers and the messages.

    sample_sentences.py ROOT SEED

A reader who has not seen the project marks the sentences that need a second reading (language check
of a release). The files of the sentences follow after the sample, by number.
"""
import pathlib
import random
import re
import subprocess
import sys

SHARES = {"manual": 40, "headers": 30, "messages": 30}


def sentences(text, least=6):
    parts = re.split(r"(?<=[.!?])\s+(?=[A-Z`])", re.sub(r"\s+", " ", text))
    return [part.strip() for part in parts if len(part.split()) >= least]


def of_manual(text):
    text = re.sub(r"```.*?```", "", text, flags=re.S)
    for paragraph in re.split(r"\n\s*\n", text):
        if not paragraph.lstrip().startswith(("|", "#", "<", "!")):
            for item in re.split(r"\n\s*(?:[-*]|\d+\.)\s+", "\n" + paragraph):
                yield from sentences(item)


def of_header(text):
    for block in re.findall(r"(?:^[ \t]*///?[^\n]*\n)+", text, flags=re.M):
        yield from sentences(re.sub(r"^[ \t]*///? ?", "", block, flags=re.M))


def of_source(text):
    literal = r'"((?:[^"\\\n]|\\.)*)"'
    for parts in re.findall(literal + r"(?:\s*\n?\s*" + literal + ")?", text):
        message = "".join(parts)
        if len(message.split()) >= 7 and not re.search(r"[<>{};]", message):
            yield message


def of_schema(text):
    for description in re.findall(r'"description": "((?:[^"\\]|\\.)*)"', text):
        yield from sentences(description)


def population(root):
    found = {kind: [] for kind in SHARES}
    files = subprocess.check_output(["git", "-C", str(root), "ls-files"], text=True).split()
    for name in files:
        path = pathlib.PurePath(name)
        inside = path.parts[0]
        if path.suffix == ".md" and (inside == "docs" or name == "README.md"):
            kind, read = "manual", of_manual
        elif path.suffix == ".hpp" and inside != "tests":
            kind, read = "headers", of_header
        elif path.suffix == ".cpp" and inside not in ("tests", "bench"):
            kind, read = "messages", of_source
        elif path.suffix == ".json" and "schema" in name:
            kind, read = "messages", of_schema
        else:
            continue
        found[kind] += [(name, one) for one in read((root / name).read_text(encoding="utf-8"))]
    return found


def main():
    root, seed = pathlib.Path(sys.argv[1]), int(sys.argv[2])
    draw = random.Random(seed)
    found = population(root)
    sample = [one for kind, share in SHARES.items() for one in draw.sample(found[kind], share)]
    draw.shuffle(sample)
    for number, (_, sentence) in enumerate(sample, 1):
        print(f"{number}. {sentence}")
    print()
    for number, (name, _) in enumerate(sample, 1):
        print(number, name)


if __name__ == "__main__":
    main()
