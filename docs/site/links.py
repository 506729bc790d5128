"""Links and headings of the pages in Markdown, as GitHub reads them."""
import re

# [text](target), not in code; the text may hold code and pictures.
LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^()\s]+)\)")


def outside_code(text, change):
    """The text with `change` made to every paragraph that is no code; code within one is hidden from it."""
    made, paragraph, fenced, code_may_start = [], [], False, True

    def close():
        words = "".join(paragraph)
        codes = re.findall(r"`[^`]*`", words)
        made.append(re.sub("\x00", lambda _: codes.pop(0), change(re.sub(r"`[^`]*`", "\x00", words))))
        paragraph.clear()

    for line in text.splitlines(keepends=True):
        fence = line.lstrip().startswith("```")
        if fence or fenced or (line.startswith("    ") and code_may_start):
            close()
            made.append(line)
            fenced = fenced != fence
            continue
        paragraph.append(line)
        code_may_start = not line.strip()
        if code_may_start:
            close()
    close()
    return "".join(made)


def links(text):
    """The target of each link and picture."""
    found = []

    def note(words):
        found.extend(match[3] for match in LINK.finditer(words))
        return words

    outside_code(text, note)
    return found


def slug(heading):
    """The anchor that GitHub makes of a heading."""
    heading = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).replace("`", "").strip().lower()
    return re.sub(r"[^\w\- ]", "", heading).replace(" ", "-")


def anchors(text):
    """Anchors of headings, and those that a page sets itself."""
    found, fenced, seen = [], False, {}
    for line in text.splitlines():
        if line.lstrip().startswith("```"):
            fenced = not fenced
        match = re.match(r"#{1,6} +(.*)", line)
        if match and not fenced:
            name = slug(match[1])
            count = seen.get(name, 0)
            seen[name] = count + 1
            found.append(name if count == 0 else f"{name}-{count}")
    return set(found), set(re.findall(r'<a id="([^"]+)">', text))
