#!/usr/bin/env python3
"""Writes the completion of the program's commands and options for bash, zsh and fish.

usage: completion.py PROGRAM FOLDER
Writes FOLDER/stereotlm.bash, FOLDER/_stereotlm and FOLDER/stereotlm.fish from what PROGRAM says about itself:
its --help, the --help of each command, its presets and its keys.
"""
import json
import pathlib
import re
import subprocess
import sys


def said(*words):
    return subprocess.run([str(word) for word in words], check=True, stdout=subprocess.PIPE, text=True).stdout


def entries(text, *sections):
    """(name, what follows it on its line) -> description, of the indented lists below these headings."""
    found, section, name = {}, None, None
    for line in text.splitlines():
        if line and not line.startswith(" "):
            section = line.rstrip(":")
        elif section in sections and (match := re.match(r"  (\S+)((?: \S+)*)(?:\s{2,}(.*))?$", line)):
            name = (match[1], match[2].strip())
            found[name] = match[3] or ""
        elif section in sections and name and line.strip():
            found[name] = (found[name] + " " + line.strip()).strip()
    return found


def options_of(text):
    """Option -> (whether it takes a value, its description)."""
    headings = [line[:-1] for line in text.splitlines() if line.endswith(":") and not line.startswith(" ")]
    lists = entries(text, *(heading for heading in headings if heading not in ("Positionals", "Commands")))
    return {option: (bool(value), description)
            for (names, value), description in lists.items() if names.startswith("-")
            for option in names.split(",") if option.startswith("--")}


def quoted(text):
    return "'" + text.replace("'", "'\\''") + "'"


def bash(commands, presets, keys):
    cases = "\n".join(f"    {name}) options={quoted(' '.join(options))} ;;"
                      for name, (_, options) in commands.items())
    return f"""# Completion of stereotlm for bash.
_stereotlm() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}} options=
  COMPREPLY=()
  if ((COMP_CWORD == 1)); then
    mapfile -t COMPREPLY < <(compgen -W {quoted(' '.join(commands) + ' --help --version')} -- "$word")
    return
  fi
  case ${{COMP_WORDS[1]}} in
{cases}
  esac
  if [[ $before == --set ]]; then
    compopt +o filenames -o nospace
    mapfile -t COMPREPLY < <(compgen -S = -W {quoted(' '.join(keys))} -- "$word")
  elif [[ $word == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$word")
  elif [[ $before == --show ]]; then
    mapfile -t COMPREPLY < <(compgen -W {quoted(' '.join(presets))} -- "$word")
  elif ((COMP_CWORD == 2)); then
    mapfile -t COMPREPLY < <(compgen -W {quoted(' '.join(presets))} -- "$word"; compgen -f -- "$word")
  else
    mapfile -t COMPREPLY < <(compgen -f -- "$word")
  fi
}}
complete -o filenames -F _stereotlm stereotlm
"""


def zsh(commands, presets, keys):
    def text(description):
        return re.sub(r"([\[\]:])", r"\\\1", description)
    described = "\n".join(f"    {quoted(f'{name}:{text(description)}')}"
                          for name, (description, _) in commands.items())
    cases = []
    for name, (_, options) in commands.items():
        words = [quoted(f"*{option}[{text(description)}]" + (
            ":key:_stereotlm_keys" if option == "--set" else
            ":preset:_stereotlm_boards" if option == "--show" else ":value:_files" if value else ""))
            for option, (value, description) in options.items()]
        cases.append(f"    {name}) _arguments -s {' '.join(words)} '*:board or file:_stereotlm_boards' ;;")
    newline = "\n"
    return f"""#compdef stereotlm
# Completion of stereotlm for zsh.
_stereotlm_boards() {{
  _alternative {quoted(f"presets:preset:({' '.join(presets)})")} 'files:file:_files'
}}
_stereotlm_keys() {{ compadd -S = -- {' '.join(keys)} }}
_stereotlm() {{
  local -a commands
  commands=(
{described}
  )
  if ((CURRENT == 2)); then
    _describe command commands
    return
  fi
  local command=$words[2]
  shift words
  ((CURRENT--))
  case $command in
{newline.join(cases)}
  esac
}}
_stereotlm "$@"
"""


def fish(commands, presets, keys):
    lines = ["# Completion of stereotlm for fish."]
    for name, (description, options) in commands.items():
        lines.append(f"complete -c stereotlm -n __fish_use_subcommand -f -a {name} -d {quoted(description)}")
        lines += [f"complete -c stereotlm -n '__fish_seen_subcommand_from {name}' -l {option[2:]}"
                  + (" -r" if value else "") + (f" -a {quoted(' '.join(key + '=' for key in keys))}"
                                               if option == "--set" else "")
                  + f" -d {quoted(text)}" for option, (value, text) in options.items()]
    lines.append(f"complete -c stereotlm -n 'not __fish_use_subcommand' -a {quoted(' '.join(presets))}")
    return "\n".join(lines) + "\n"


def main():
    program, folder = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    commands = {name: (description, options_of(said(program, name, "--help")))
                for (name, _), description in entries(said(program, "--help"), "Commands").items()}
    presets = [board["name"] for board in json.loads(said(program, "boards", "--json"))["boards"]]
    keys = [key["key"] for key in json.loads(said(program, "keys", "--json"))["keys"] if "." in key["key"]]
    for name, text in (("stereotlm.bash", bash(commands, presets, keys)),
                       ("_stereotlm", zsh(commands, presets, keys)),
                       ("stereotlm.fish", fish(commands, presets, keys))):
        (folder / name).write_text(text)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main()
