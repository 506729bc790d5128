"""The reference of the libraries for C++: Doxygen reads the headers, and its XML becomes a page a folder and header."""
import os
import re
import subprocess
import xml.etree.ElementTree as ElementTree

# Folder and what its page says of it.
ROOMS = {
    "inference": "Priors, models, moves, the reversible-jump sampler, evidence, diagnostics.",
    "identification": "A structure or chain, data and priors to findings.",
    "fem": "Beams, frames, modes, reanalysis, cross-sections.",
    "dynamics": "Chains of masses in time, force laws.",
    "signals": "Records and what they say: spectra, residuals, modal identification.",
    "emulator": "Designs of experiments, tables, interpolants.",
    "io": "Bytes to tables and back.",
    "base": "Random numbers, threads, numbers in text.",
}
# Inside of a folder, and no promise to anybody (docs/libraries.md).
INSIDE = ("dynamics/kernel/", *(f"inference/engine/{stage}" for stage in (
    "explore", "follow", "model_probabilities", "run_context", "run_state", "safe_points", "salvage", "sample", "temper",
    "tune", "weigh")))


def words(node):
    """The text of a description, as Markdown."""
    if node is None:
        return ""

    def of(part):
        inner = (part.text or "") + "".join(of(child) + (child.tail or "") for child in part)
        if part.tag == "computeroutput":
            return f"`{inner}`"
        if part.tag == "para":
            return inner.strip() + "\n\n"
        if part.tag == "listitem":
            return "- " + inner.strip() + "\n"
        if part.tag in ("verbatim", "preformatted", "programlisting", "codeline"):
            return "\n```text\n" + inner.strip("\n") + "\n```\n"
        if part.tag == "simplesect":
            return {"return": "Returns: ", "see": "See "}.get(part.get("kind"), "") + inner
        return inner

    return escaped(of(node).strip())


def escaped(text):
    """Formulas in comments are no Markdown."""
    parts = re.split(r"(`[^`]*`|```.*?```)", text, flags=re.S)
    return "".join(part if i % 2 else re.sub(r"([*_<>\[\]#|{}$])", r"\\\1", part) for i, part in enumerate(parts))


def plain(node):
    return re.sub(r"\s+", " ", "".join(node.itertext())).strip() if node is not None else ""


def template(member):
    parameters = member.find("templateparamlist")
    if parameters is None:
        return ""
    said = [plain(p.find("type")) + (" " + plain(p.find("declname")) if p.find("declname") is not None else "")
            for p in parameters]
    return f"template <{', '.join(said)}>\n"


def declaration(member):
    kind, name = member.get("kind"), plain(member.find("name"))
    kind_of = plain(member.find("type"))
    if kind == "function":
        end = plain(member.find("argsstring")).replace("=0", " = 0").replace("=default", " = default")
        return f"{template(member)}{kind_of} {name}{end};".strip()
    if kind == "enum":
        values = ", ".join(plain(v.find("name")) for v in member.findall("enumvalue"))
        return f"enum {'class ' if member.get('strong') == 'yes' else ''}{name} {{ {values} }};"
    if kind == "typedef":
        definition = plain(member.find("definition"))
        return (definition if definition.startswith("using") else f"using {name} = {kind_of}").replace("wheeltap::", "") + ";"
    start = f" {plain(member.find('initializer'))}" if member.find("initializer") is not None else ""
    return f"{template(member)}{kind_of} {name}{plain(member.find('argsstring'))}{start};".strip()


def told(member):
    said = [words(member.find(f"{kind}description")) for kind in ("brief", "detailed", "inbody")]
    return "\n\n".join(dict.fromkeys(text for text in said if text))


def cpp(text):
    return ["```cpp", text, "```", ""]


def of_compound(compound, level):
    """A class or struct with its public members."""
    name = plain(compound.find("compoundname")).split("::", 2)[-1]
    bases = [plain(b) for b in compound.findall("basecompoundref") if b.get("prot") == "public"]
    lines = [f"{'#' * level} {compound.get('kind')} {escaped(name)}", ""]
    if bases:
        lines += ["Derives from " + ", ".join(f"`{b}`" for b in bases) + ".", ""]
    if told(compound):
        lines += [told(compound), ""]
    silent = []

    def flush():
        if silent:
            lines.extend(cpp("\n".join(silent)))
            silent.clear()

    for member in compound.iter("memberdef"):
        if member.get("prot") != "public" or member.get("kind") == "friend":
            continue
        silent.append(declaration(member))
        if told(member):
            flush()
            lines.extend([told(member), ""])
    flush()
    return lines


def opening(path):
    """The comment with which a header begins."""
    lines = []
    with open(path, encoding="utf-8") as f:
        for line in f:
            if not line.startswith("//") or line.startswith("///"):
                break
            lines.append(re.sub(r"^// ?", "", line.rstrip("\n")))
    return "```text\n" + "\n".join(lines) + "\n```" if any(re.search(r"   |[=∝·]", x) for x in lines) else \
        escaped("\n".join(lines))


def written(root, folder):
    """{page: text}: `cpp` leads to a page for each header."""
    os.makedirs(folder, exist_ok=True)
    options = {"INPUT": " ".join(os.path.join(root, room) for room in ROOMS), "FILE_PATTERNS": "*.hpp", "RECURSIVE": "YES",
               "OUTPUT_DIRECTORY": folder, "GENERATE_HTML": "NO", "GENERATE_LATEX": "NO", "GENERATE_XML": "YES",
               "XML_PROGRAMLISTING": "NO", "EXTRACT_ALL": "YES", "STRIP_FROM_PATH": root, "QUIET": "YES", "WARNINGS": "NO",
               "HAVE_DOT": "NO", "MACRO_EXPANSION": "YES", "EXPAND_ONLY_PREDEF": "YES", "MARKDOWN_SUPPORT": "NO"}
    subprocess.run(["doxygen", "-"], input="\n".join(f"{k} = {v}" for k, v in options.items()), text=True, check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    xml = os.path.join(folder, "xml")

    def compound(name):
        return ElementTree.parse(os.path.join(xml, name + ".xml")).getroot().find("compounddef")

    pages, headers = {}, {room: [] for room in ROOMS}
    for entry in ElementTree.parse(os.path.join(xml, "index.xml")).getroot():
        if entry.get("kind") != "file":
            continue
        file = compound(entry.get("refid"))
        path = os.path.relpath(os.path.join(root, file.find("location").get("file")), root)
        if path.startswith(INSIDE):
            continue
        lines = []
        seen = set()
        for inner in file.findall("innerclass"):
            if inner.get("prot") in (None, "public") and "detail" not in plain(inner):
                lines += of_compound(compound(inner.get("refid")), 2)
        members = list(file.iter("memberdef"))
        for namespace in file.findall("innernamespace"):
            # Members of a namespace are told in the namespace's file, with where they stand.
            members += [m for m in compound(namespace.get("refid")).iter("memberdef")
                        if m.find("location").get("file") == file.find("location").get("file")]
        for member in members:
            if member.get("id") in seen or member.get("kind") == "define" or "detail" in member.get("id"):
                continue
            seen.add(member.get("id"))
            name = plain(member.find("name"))
            lines += [f"## {escaped(name)}", "", *cpp(declaration(member))]
            if told(member):
                lines += [told(member), ""]
        if not lines:
            continue
        page = "cpp-" + path[:-4].replace("/", "-")
        headers[path.split("/")[0]].append((path, page))
        pages[page] = "\n".join([f"# {escaped(path)}", "", opening(os.path.join(root, path)), "", "```cpp",
                                 f'#include "{path}"', "```", "", *lines])
    index = ["# The libraries for C++", "", "A page a header; [use the libraries](../libraries.md) says what each target needs "
             "and what stays as it is.", ""]
    for room, about in ROOMS.items():
        index += [f"- [wheeltap::{room}](cpp-{room}.md). {about}"]
        rows = [f"# wheeltap::{room}", "", about, ""] + [f"- [{escaped(path)}]({page}.md)" for path, page in sorted(headers[room])]
        pages[f"cpp-{room}"] = "\n".join(rows + ["", "```{toctree}", ":hidden:", "", *(p for _, p in sorted(headers[room])), "```"])
    pages["cpp"] = "\n".join(index + ["", "```{toctree}", ":hidden:", "", *(f"cpp-{room}" for room in ROOMS), "```"])
    return pages
