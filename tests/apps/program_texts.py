#!/usr/bin/env python3
"""Completion and the manual page agree with --help, and work in the installed shells and man.

usage: program_texts.py PROGRAM
"""
import re
import shutil
import subprocess
import sys
import tempfile


def output(*command, **options):
    return subprocess.run(command, capture_output=True, text=True, check=True, **options).stdout


def commands(program):
    """{command: options}, from --help."""
    listed = output(program, "--help").split("Subcommands:\n")[1]
    names = re.findall(r"^  ([a-z]+) ", listed, re.M)
    assert "damage" in names and len(names) > 10, names
    found = {}
    for name in names:
        text = output(program, name, "--help")
        found[name] = sorted({word for line in text.splitlines() if line.startswith("  -")
                              for word in re.findall(r"(?<!\S)-{1,2}[a-z][a-z-]*", line.split("  ")[1].replace(",", " "))})
    return found


def completed(script, *words):
    """Completions of bash for the last word."""
    shell = (f"source {script}\nCOMP_WORDS=({' '.join(repr(w) for w in words)})\nCOMP_CWORD={len(words) - 1}\n"
             "_wheeltap 2>/dev/null\nprintf '%s\\n' \"${COMPREPLY[@]}\"\n")
    return [line for line in output("bash", "-c", shell).splitlines() if line]


def main(program):
    wanted = commands(program)
    texts = {shell: output(program, "completion", shell) for shell in ("bash", "zsh", "fish")}
    manual = output(program, "man").replace("\\-", "-")
    with tempfile.NamedTemporaryFile("w", suffix=".bash") as file:
        file.write(texts["bash"])
        file.flush()
        assert set(wanted) <= set(completed(file.name, "wheeltap", "")), completed(file.name, "wheeltap", "")
        assert completed(file.name, "wheeltap", "upd") == ["update"]
        for name, options in wanted.items():
            offered = completed(file.name, "wheeltap", name, "-")
            assert sorted(offered) == options, f"{name}: {sorted(offered)}, --help has {options}"
        assert completed(file.name, "wheeltap", "damage", "--simd", "av") == ["avx2", "avx512"]
    for name, options in wanted.items():
        assert f"\n.SS wheeltap {name}" in manual, name
        part = manual.split(f"\n.SS wheeltap {name}")[1].split("\n.SS")[0]
        for option in options:
            assert option in part, f"man: {name} {option}"
            assert option in texts["zsh"] and re.search(rf" -[ls] {option.lstrip('-')}( |$)", texts["fish"]), option
    for shell, check in (("bash", ["bash", "-n"]), ("zsh", ["zsh", "-n"]), ("fish", ["fish", "-n"])):
        if shutil.which(shell):
            subprocess.run([*check, "/dev/stdin"], input=texts[shell], text=True, check=True)
        else:
            print(f"{shell} is not installed: its completion was not parsed")
    if shutil.which("groff"):
        warned = subprocess.run(["groff", "-man", "-ww", "-z", "-Tutf8"], input=output(program, "man"), text=True,
                                capture_output=True, check=True).stderr
        assert not warned, warned
    refused = subprocess.run([program, "completion", "csh"], capture_output=True, text=True)
    assert refused.returncode == 64 and "bash, zsh and fish" in refused.stderr, refused

    said = output(program, "explain", "count.max")
    assert "/damage/count/max" in said and "the largest number of defects" in said and "<= 20" in said, said
    assert output(program, "explain", "/damage/count/max") in said
    assert "keys: " in output(program, "explain", "data")
    # Separate entries for beams and structures if the meaning differs.
    kinds = output(program, "explain", "damage.kind")
    assert "(damage)" in kinds and "(structure)" in kinds and "storey" in kinds, kinds
    told = subprocess.run([program, "explain", "decay"], capture_output=True, text=True).stderr
    assert "These keys mention the word: " in told, told
    wrong = subprocess.run([program, "explain", "poison"], capture_output=True, text=True)
    assert wrong.returncode == 64 and 'did you mean "poisson"' in wrong.stderr, wrong
    print(f"{len(wanted)} commands")


if __name__ == "__main__":
    try:
        main(sys.argv[1])
    except AssertionError as error:
        sys.exit(str(error))
