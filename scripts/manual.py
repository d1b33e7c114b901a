#!/usr/bin/env python3
"""Writes man pages and bash completion of the program lte, from what it says about itself.

usage: scripts/manual.py LTE OUT    # OUT/man/man1/*.1.gz, OUT/bash-completion/completions/*
"""
import gzip
import pathlib
import re
import subprocess
import sys
from typing import NamedTuple


class Option(NamedTuple):
    names: str  # as in "-h,--help", or the name of a positional or of a subcommand
    value: str  # "TEXT:{y,z}=y Excludes: --time", or ""
    about: list[str]  # lines

    def choices(self):
        found = re.search(r"\{([^}]*)\}", self.value)
        return found[1].split(",") if found else []


class Help(NamedTuple):
    summary: str
    usage: str
    sections: dict[str, list[Option]]
    examples: list[str]


def read_help(command):
    text = subprocess.run([*command, "--help"], check=True, capture_output=True, text=True).stdout
    lines = text.split("\n")
    usage = next(i for i, line in enumerate(lines) if line.startswith("Usage: "))
    found = Help(" ".join(lines[:usage]).strip(), lines[usage].removeprefix("Usage: "), {}, [])
    section = None
    for line in lines[usage + 1:]:
        entry = re.fullmatch(r"  (\S+)((?: \S+)*)(?:  +(.*))?", line)
        if line == "Examples:":
            section = found.examples
        elif line and not line.startswith(" "):
            if line.endswith(":"):
                section = found.sections.setdefault(line[:-1], [])
            else:
                section = None
        elif section is found.examples:
            section.append(line.strip())
        elif section is not None and entry:
            section.append(Option(entry[1], entry[2].strip(), [entry[3]] if entry[3] else []))
        elif section and line.strip():
            section[-1].about.append(line.strip())
    found.examples[:] = [line for line in found.examples if line]
    return found


def troff(text):
    text = text.replace("\\", "\\e").replace("-", "\\-")
    return "\\&" + text if text[:1] in (".", "'") else text


def man_page(name, version, found, commands):
    summary = found.summary.rstrip(".")
    out = [f'.TH {name.upper()} 1 "" "lte {version}" "User Commands"', ".SH NAME",
           f"{name} \\- {troff(summary[:1].lower() + summary[1:])}",
           ".SH SYNOPSIS", ".B " + troff(found.usage), *sections(found, ".SH")]
    for command, its in commands.items():
        out += [f'.SH "{command.upper()}"', troff(its.summary), ".PP",
                ".B " + troff(its.usage), *sections(its, ".SS")]
    return "\n".join(out) + "\n"


def sections(found, heading):
    out = []
    for title, options in found.sections.items():
        out.append(f'{heading} "{title.upper() if heading == ".SH" else title}"')
        for option in options:
            out += [".TP", f"\\fB{troff(option.names)}\\fR {troff(option.value)}".rstrip()]
            out += [line for i, text in enumerate(option.about)
                    for line in ([".br"] if i else []) + [troff(text)]]
    if found.examples:
        out += [f"{heading} {'EXAMPLES' if heading == '.SH' else 'Examples'}", ".nf",
                *map(troff, found.examples), ".fi"]
    return out


def flags(found):
    return [name for options in found.sections.values() for option in options
            for name in option.names.split(",") if name.startswith("--")]


def completion(name, found, commands):
    """A function that offers flags, choices of the flag before, subcommands, and files."""
    chosen = {}
    for its in (found, *commands.values()):
        for options in its.sections.values():
            chosen |= {option.names.split(",")[-1]: option.choices() for option in options
                       if option.choices() and option.names.startswith("-")}
    lines = [f"_{name}() {{", '  local word=${COMP_WORDS[COMP_CWORD]} flags', "  COMPREPLY=()",
             "  case ${COMP_WORDS[COMP_CWORD - 1]} in"]
    lines += [f"    {flag}) COMPREPLY=($(compgen -W '{' '.join(words)}' -- \"$word\")); return ;;"
              for flag, words in chosen.items()]
    lines += ["  esac", f"  flags='{' '.join(flags(found))}'"]
    if commands:
        lines.append("  case ${COMP_WORDS[1]} in")
        lines += [f"    {command}) flags='{' '.join(flags(its))}' ;;"
                  for command, its in commands.items()]
        lines += ["  esac", "  if [ \"$COMP_CWORD\" -eq 1 ]; then flags=\"$flags "
                  f"{' '.join(commands)}\"; fi"]
        lines.append("  if [[ $word == -* || $COMP_CWORD -eq 1 ]]; then")
    else:
        lines.append("  if [[ $word == -* ]]; then")
    lines += ["    COMPREPLY=($(compgen -W \"$flags\" -- \"$word\"))", "  fi", "}",
              f"complete -o default -F _{name} {name}"]
    return "\n".join(lines) + "\n"


# `lte render` is completed as lte_render is; info is a command of lte_datagen, and demo is a scene.
LTE_COMPLETION = """_lte() {
  COMPREPLY=()
  if [ "$COMP_CWORD" -eq 1 ]; then
    COMPREPLY=($(compgen -W '@COMMANDS@ --help --version' -- "$2"))
    return
  fi
  local tool=lte_${COMP_WORDS[1]}
  case ${COMP_WORDS[1]} in
    data) tool=lte_datagen ;;
    info) tool=lte_datagen COMP_WORDS=(lte "${COMP_WORDS[@]}") COMP_CWORD=$((COMP_CWORD + 1)) ;;
    demo) tool=lte_render ;;
  esac
  declare -F "_$tool" >/dev/null || _completion_loader "$tool" 2>/dev/null
  COMP_WORDS=("$tool" "${COMP_WORDS[@]:2}") COMP_CWORD=$((COMP_CWORD - 1))
  if declare -F "_$tool" >/dev/null; then "_$tool"; fi
}
complete -o default -F _lte lte
"""
# Commands that are tools, where the names differ; those that are another tool's.
TOOLS, WITHIN = {"data": "lte_datagen"}, ("info", "demo")


def lte_page(version, lines, tools):
    return "\n".join([
        f'.TH LTE 1 "" "lte {version}" "User Commands"', ".SH NAME",
        "lte \\- global illumination of scenes", ".SH SYNOPSIS", ".B lte COMMAND ...",
        ".SH COMMANDS", ".nf", *map(troff, lines), ".fi", ".SH SEE ALSO",
        ", ".join(f"{tool}(1)" for tool in tools), ""])


def write_page(path, page):
    with gzip.GzipFile(path, "wb", mtime=0) as file:
        file.write(page.encode())


def said(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def main():
    if len(sys.argv) != 3 or sys.argv[1].startswith("-"):
        print(__doc__.strip().split("\n\n")[1], file=sys.stderr)
        return 2
    program, out = sys.argv[1], pathlib.Path(sys.argv[2])
    pages, words = out / "man" / "man1", out / "bash-completion" / "completions"
    for folder in (pages, words):
        folder.mkdir(parents=True, exist_ok=True)
    version = said(program, "--version").split()[-1]
    lines = [line.strip() for line in said(program, "--help").splitlines()[1:]]
    names = [line.split()[1] for line in lines]
    tools = {TOOLS.get(name, f"lte_{name}"): name for name in names if name not in WITHIN}
    for tool, name in tools.items():
        found = read_help([program, name])
        commands = {option.names: read_help([program, name, option.names])
                    for option in found.sections.get("Subcommands", [])}
        write_page(pages / f"{tool}.1.gz", man_page(tool, version, found, commands))
        (words / tool).write_text(completion(tool, found, commands))
    write_page(pages / "lte.1.gz", lte_page(version, lines, tools))
    (words / "lte").write_text(LTE_COMPLETION.replace("@COMMANDS@", " ".join(names)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
