#!/usr/bin/env python3
"""Builds the manual: docs/*.md, tutorials with what they show, reports, and the references, as one static site.

usage: make_site.py ROOT FOLDER [--program WHEELTAP] [--package FOLDER] [--examples FOLDER] [--version V] [--doxygen]

FOLDER/html is the site; FOLDER/source is what Sphinx makes it of. Without --program there are no reports and no pages
that the program writes, without --package no Python, without --doxygen no C++ reference; tutorials are then shown and
not run. Pages are those of the repository, unchanged but for links: what leads to a file of the repository leads to
a page that shows it. Exit code 77 where Sphinx, MyST or furo is missing.
"""
import argparse
import html
import json
import os
import posixpath
import re
import shutil
import subprocess
import sys

import api_pages
import links

HERE = os.path.dirname(os.path.abspath(__file__))
# The manual's order. Every page of docs/ must be in it.
CHAPTERS = {
    "Getting started": ["Overview <readme>", "guide", "system-identification", "application", "priors", "results", "report", "long-runs",
                        "many-cases", "tutorials/index", "gallery", "which-tool"],
    "Structures and damage": ["structures", "sections", "emulators", "updating", "states", "planning"],
    "Measured data": ["measured-data", "file-formats", "modal", "monitoring", "laws"],
    "Integration": ["python", "libraries", "models-of-others", "scale"],
    "Theory and validation": ["theory", "validation", "speed", "comparison", "measured"],
    "Reference": ["glossary", "reference/commands", "reference/keys", "reference/python", "reference/cpp"],
    "Project": ["contributing", "releasing", "changes", "licences"],
}
PAGES = {"README.md": "readme", "CHANGELOG.md": "changes", "docs/README.md": "index", "data/README.md": "data"}
TUTORIALS = [
    ("docs/tutorials/first-answer.sh", "First damage identification on the command line"),
    ("docs/tutorials/plan.sh", "Sensors of a modal test, chosen before the test"),
    ("docs/tutorials/three-span-beam.sh", "Damage of a three-span beam from raw accelerations"),
    ("docs/tutorials/beam.py", "Damage in a beam, with Python"),
    ("docs/tutorials/rig.py", "Equation of motion of a mass on a spring"),
    ("examples/python/accelerations_to_damage.py", "From raw accelerations to damage"),
    ("docs/tutorials/question.py", "User-defined models for the engine"),
    ("examples/damaged_beam.cpp", "The libraries: a damaged beam in C++"),
    ("examples/polynomial_degree.cpp", "The libraries: models of your own in C++"),
    ("examples/mixture_components.cpp", "The libraries: how many groups? A mixture in C++"),
]
# (case, what to look at, what shortens it)
GALLERY = [
    ("data/beam/case-a-fe.json", "One damage in a symmetric beam: a place or its mirror image", []),
    ("data/beam/case-b-fe.json", "Two damages", []),
    ("data/roller-beam/roller-099mm.json", "Measured: where is the roller under a steel cantilever?", []),
    ("data/structures/cracked-portal.json", "A crack in a portal frame", []),
    ("data/structures/storeys-update.json", "Stiffnesses of three storeys from frequencies and shapes", []),
    ("data/sid/c1_duffing.case.json", "A hardening spring", ["--set", "truth.samples=500"]),
    ("data/sid/discover_law.case.json", "Which terms does this spring have?", ["--warmup", "2000", "--draws", "2000"]),
]
KINDS = ["damage", "update", "sid"]
LANGUAGES = {".py": "python", ".cpp": "cpp", ".hpp": "cpp", ".sh": "sh", ".json": "json", ".cmake": "cmake"}


def text_of(path):
    with open(path, encoding="utf-8") as f:
        return f.read()


class Site:
    def __init__(self, arguments):
        self.root, self.folder = os.path.abspath(arguments.root), os.path.abspath(arguments.folder)
        self.source = os.path.join(self.folder, "source")
        self.arguments = arguments
        self.made, self.shown = set(), {}
        shutil.rmtree(self.source, ignore_errors=True)
        os.makedirs(os.path.join(self.source, "_static"))

    def write(self, page, text):
        path = os.path.join(self.source, page + ".md")
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w", encoding="utf-8") as f:
            f.write(text)
        self.made.add(page)

    def page_of(self, path):
        """The page that shows a file of the repository, or None."""
        if path in PAGES:
            return PAGES[path]
        for tutorial, _ in TUTORIALS:
            if path == tutorial:
                return "tutorials/" + os.path.splitext(os.path.basename(path))[0]
        match = re.fullmatch(r"docs/([\w-]+)\.md", path)
        if match:
            return match[1]
        full = os.path.join(self.root, path)
        if os.path.isdir(full):
            return self.page_of(posixpath.join(path, "README.md")) if os.path.exists(full + "/README.md") else None
        if os.path.isfile(full):
            page = "files/" + path.replace("/", "-").replace(".", "-")
            self.shown[page] = path
            return page
        return None

    def adapted(self, text, path, page):
        """The text of a page with its links made to the site's pages."""
        def there(match):
            picture, words, target = match[1], match[2], match[3]
            if re.match(r"[a-z]+:", target) or target.startswith("#"):
                return match[0]
            place, _, anchor = target.partition("#")
            place = posixpath.normpath(posixpath.join(posixpath.dirname(path), place))
            here = posixpath.dirname(page)
            if picture:
                to = "_pictures/" + place.replace("/", "-")
                os.makedirs(os.path.join(self.source, "_pictures"), exist_ok=True)
                shutil.copy(os.path.join(self.root, place), os.path.join(self.source, to))
                return f"![{words}]({posixpath.relpath(to, here or '.')})"
            to = self.page_of(place)
            if to is None:
                return words
            to_here = posixpath.relpath(to, here or ".")
            if anchor and anchor not in links.anchors(text_of(os.path.join(self.root, place)))[0]:
                return f'<a class="reference internal" href="{to_here}.html#{anchor}">{html.escape(words)}</a>'
            return f"[{words}]({to_here}.md{'#' + anchor if anchor else ''})"

        text = links.outside_code(text, lambda part: links.LINK.sub(there, part))
        own = links.anchors(text)[1]
        for name in own:
            text = re.sub(rf"\[([^\]]*)\]\(#{name}\)", rf'<a class="reference internal" href="#{name}">\1</a>', text)
        return text

    def add(self, path, page):
        self.write(page, self.adapted(text_of(os.path.join(self.root, path)), path, page))

    def run(self, *command, **options):
        ran = subprocess.run([str(word) for word in command], capture_output=True, text=True, **options)
        if ran.returncode != 0:
            sys.exit(f"{' '.join(map(str, command))}\n{ran.stdout}{ran.stderr}")
        return ran.stdout

    # ---- what the build makes

    def tutorials(self):
        arguments = self.arguments
        os.makedirs(os.path.join(self.source, "tutorials"), exist_ok=True)
        rows = ["# Tutorials", "", "Each is a file that runs as it is; its page shows what it printed and drew when the "
                "manual was built.", ""]
        for path, title in TUTORIALS:
            stem, extension = os.path.splitext(os.path.basename(path))
            page = "tutorials/" + stem
            compiled = os.path.join(arguments.examples or "", stem)
            runs = {".py": arguments.package, ".sh": arguments.program,
                    ".cpp": arguments.examples and os.path.exists(compiled)}[extension]
            text = text_of(os.path.join(self.root, path))
            if runs:
                to = os.path.join(self.source, page + ".md")
                self.run(sys.executable, os.path.join(HERE, "tutorial.py"), os.path.join(self.root, path), "--page", to,
                         "--title", title, "--root", self.root,
                         *(["--program", arguments.program] if extension == ".sh" else []),
                         *(["--package", arguments.package] if extension == ".py" else []),
                         *(["--compiled", compiled] if extension == ".cpp" else []))
                text = text_of(to)
                pictures = re.findall(r"!\[figure\]\(([^)]+)\)", text)
                text = re.sub(r"!\[figure\]\(", "![figure](figure:", text)
                text = self.adapted(text, path, page).replace("(figure:", "(")
                print(f"{path}: {len(figures)} figures")
            else:
                text = f"# {title}\n\n```{LANGUAGES[extension]}\n{text}\n```\n"
            self.write(page, text)
            rows.append(f"- [{title}]({stem}.md)")
        self.write("tutorials/index", "\n".join(rows) + "\n\n" + toctree([os.path.splitext(os.path.basename(p))[0]
                                                                       for p, _ in TUTORIALS]))

    def gallery(self):
        lines = ["# Gallery of reports", ""]
        if not self.arguments.program:
            self.write("gallery", "\n".join(lines + ["The reports are made where the program is."]))
            return
        lines += ["Cases that ship, and what the program says of them, made when this manual was built. Each "
                  "report is one file, as a run leaves it.", ""]
        folder = os.path.join(self.source, "_static", "gallery")
        for case, title, shorter in GALLERY:
            name = os.path.basename(case).split(".")[0]
            command = json.loads(text_of(os.path.join(self.root, case)))["kind"]
            out = os.path.join(self.folder, "runs", name)
            self.run(self.arguments.program, command, os.path.join(self.root, case), "-o", out, "--seed", 1, "--quiet",
                     *shorter, cwd=self.root)
            os.makedirs(folder, exist_ok=True)
            shutil.copy(os.path.join(out, "report.html"), os.path.join(folder, name + ".html"))
            summary = json.loads(text_of(os.path.join(out, "summary.json")))
            answer = summary.get("answer") or {}
            said = " ".join(answer[key] for key in ("caution", "headline", "detail") if answer.get(key))
            print(f"{case}: {said}")
            shown = self.page_of(case)
            lines += [f"## {title}", "", f"> {said}", "",
                      f'<a href="_static/gallery/{name}.html">The report</a> · the case [`{case}`]({shown}.md)'
                      f" · `{' '.join(['wheeltap', command, case, '-o', f'results/{name}', *shorter])}`", ""]
        self.write("gallery", "\n".join(lines))

    def program_pages(self):
        program = self.arguments.program
        commands, keys = ["# Commands", ""], ["# Keys of a case", ""]
        if not program:
            for page, lines in (("commands", commands), ("keys", keys)):
                self.write(f"reference/{page}", "\n".join(lines + ["The program writes this page."]))
            return
        overview = self.run(program, "--help")
        names = re.findall(r"^  ([a-z]+) {2,}\S", overview[overview.index("Subcommands:"):], re.M)
        commands += ["What `wheeltap --help` says, and `--help` of each command. Exit codes: 0 done, 64 bad command line, 65 "
                     "invalid case or data, 66 file missing or unreadable, 70 internal fault, 73 cannot write.", ""]
        for name in [None, *names]:
            text = self.run(program, *([name] if name else []), "--help").replace(program, "wheeltap")
            commands += [f"## {'wheeltap ' + name if name else 'Overview'}", "", "```text", text.strip(), "```", ""]
        self.write("reference/commands", "\n".join(commands))
        keys += ["What `wheeltap init KIND` writes beside a case; `wheeltap explain KEY` says the same of one key, and "
                 "`wheeltap schema KIND` for programs (JSON Schema).", ""]
        for kind in KINDS:
            folder = os.path.join(self.folder, "init", kind)
            shutil.rmtree(folder, ignore_errors=True)
            self.run(program, "init", kind, "-o", folder)
            [page] = [name for name in os.listdir(folder) if name.endswith(".md")]
            text = re.sub(r"^(#+) ", r"\1# ", text_of(os.path.join(folder, page)), flags=re.M)
            keys += [text, ""]
        self.write("reference/keys", "\n".join(keys))

    def python_page(self):
        lines = ["# The package for Python", "", "What `import wheeltap` holds; [from Python](../python.md) shows it at work.", ""]
        if self.arguments.package:
            groups = {"Runs": "damage update sid modal load Result Draws Modal", "Structures and records":
                      "modes Modes simulate read_record data Record", "Cases, piece by piece":
                      "beam rectangle uniform log_uniform normal log_normal half_normal gamma inverse_gamma beta truncated_normal student_t table schema",
                      "The engine": "sample Model from_quantiles Quantiles Chain Progress", "Errors": "CaseError FileError"}
            for group, names in groups.items():
                lines += [f"## {group}", "", "```{eval-rst}"]
                for name in names.split():
                    kind = "exception" if name.endswith("Error") else "class" if name[0].isupper() else "function"
                    lines += [f".. auto{kind}:: wheeltap.{name}"] + (["   :members:", ""] if kind == "class" else [""])
                lines += ["```", ""]
            lines += ["## Figures", "", "```{eval-rst}", ".. automodule:: wheeltap.plot", "   :members:", "```", ""]
        self.write("reference/python", "\n".join(lines))

    def cpp_pages(self):
        if self.arguments.doxygen:
            pages = api_pages.written(self.root, os.path.join(self.folder, "doxygen"))
        else:
            pages = {"cpp": "# The libraries for C++\n\nDoxygen writes this page.\n"}
        for page, text in pages.items():
            self.write("reference/" + page, text)

    def everything(self):
        for name in sorted(os.listdir(os.path.join(self.root, "docs"))):
            if name.endswith(".md") and name != "README.md":
                self.add("docs/" + name, name[:-3])
        self.add("README.md", "readme")
        self.add("CHANGELOG.md", "changes")
        self.add("data/README.md", "data")
        self.tutorials()
        self.gallery()
        self.program_pages()
        self.python_page()
        self.cpp_pages()
        index = self.adapted(text_of(os.path.join(self.root, "docs/README.md")), "docs/README.md", "index")
        index = index.replace("# Documentation", "# Wheeltap", 1)
        trees = []
        for chapter, pages in CHAPTERS.items():
            missing = [name_of(page) for page in pages if name_of(page) not in self.made]
            assert not missing, f"no page {', '.join(missing)}"
            trees.append(toctree(pages, chapter))
        listed = {name_of(page) for pages in CHAPTERS.values() for page in pages}
        lost = {page for page in self.made if "/" not in page} - listed - {"data"}
        assert not lost, f"docs/site/make_site.py has no chapter for {', '.join(sorted(lost))}"
        self.write("index", "---\nhide-toc: true\n---\n" + index + "\n" + "\n".join(trees))
        # Files that pages lead to; each may lead to more.
        done = set()
        while set(self.shown) - done:
            for page in sorted(set(self.shown) - done):
                done.add(page)
                path = self.shown[page]
                text = text_of(os.path.join(self.root, path))
                if path.endswith(".md"):
                    self.write(page, "---\norphan: true\n---\n" + self.adapted(text, path, page))
                else:
                    language = LANGUAGES.get(os.path.splitext(path)[1], "text")
                    self.write(page, f"---\norphan: true\n---\n# {path}\n\n````{language}\n{text}\n````\n")
        data = os.path.join(self.source, "data.md")
        text = text_of(data)
        self.write("data", "---\norphan: true\n---\n" + text)
        for name in ("conf.py", "scorer.js"):
            shutil.copy(os.path.join(HERE, name), self.source)
        shutil.copy(os.path.join(HERE, "wheeltap.css"), os.path.join(self.source, "_static"))


def mend_theme(static):
    """Debian's furo is not bundled: its script is a module, which no page that is read from a disk may load, its style
    fetches another from the root of a server, and has lost the colours for who prefers dark pages."""
    style = os.path.join(static, "styles/furo.css")
    text = text_of(style)
    fetched = "@import url(/javascript/normalize.css/normalize.css);"
    if fetched in text:
        normal = "/usr/share/javascript/normalize.css/normalize.css"
        text = text.replace(fetched, text_of(normal) if os.path.exists(normal) else "")
    if "prefers-color-scheme" not in text:
        dark = re.search(r'body\[data-theme="dark"\] \{([^}]*--color-background-primary[^}]*)\}', text)
        text += '@media (prefers-color-scheme: dark) {\n  body[data-theme="auto"] {' + dark[1] + "}\n}\n"
    with open(style, "w", encoding="utf-8") as f:
        f.write(text)
    script = os.path.join(static, "scripts/furo.js")
    text = text_of(script)
    if text.startswith("import Gumshoe"):
        with open(script, "w", encoding="utf-8") as f:
            f.write(text_of(os.path.join(static, "scripts/gumshoe-patched.js")) + text.split("\n", 1)[1])


def name_of(entry):
    """The page of a chapter's entry, which may give it another title."""
    return re.sub(r".*<(.*)>", r"\1", entry)


def toctree(pages, caption=None):
    return "\n".join(["```{toctree}", ":hidden:", ":maxdepth: 2"] + ([f":caption: {caption}"] if caption else []) + ["", *pages,
                                                                                                              "```", ""])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("root")
    parser.add_argument("folder")
    for option in ("--program", "--package", "--examples", "--version"):
        parser.add_argument(option)
    parser.add_argument("--doxygen", action="store_true")
    arguments = parser.parse_args()
    for option in ("program", "package", "examples"):
        if getattr(arguments, option):
            setattr(arguments, option, os.path.abspath(getattr(arguments, option)))
    try:
        import furo  # noqa: F401
        import myst_parser  # noqa: F401
        import sphinx  # noqa: F401
    except ImportError as missing:
        print(f"skipped: {missing} (python3-sphinx, python3-myst-parser, furo)")
        sys.exit(77)
    site = Site(arguments)
    site.everything()
    environment = {**os.environ, "WHEELTAP_VERSION": arguments.version or "", "PYTHONDONTWRITEBYTECODE": "1",
                   "PYTHONPATH": arguments.package or "", "MPLBACKEND": "Agg"}
    made = os.path.join(site.folder, "html")
    shutil.rmtree(made, ignore_errors=True)
    # A warning is a fault: a link that leads nowhere, a page in no chapter.
    subprocess.run([sys.executable, "-m", "sphinx", "-b", "html", "-W", "--keep-going", "-q", "-j", "2", "-d",
                    os.path.join(site.folder, "doctrees"), site.source, made], check=True, env=environment)
    mend_theme(os.path.join(made, "_static"))
    for left in ("objects.inv", ".buildinfo", ".doctrees"):
        if os.path.exists(os.path.join(made, left)):
            os.remove(os.path.join(made, left))
    print(f"the manual: {made}/index.html")


if __name__ == "__main__":
    try:
        main()
    except (AssertionError, subprocess.CalledProcessError) as error:
        sys.exit(str(error))
