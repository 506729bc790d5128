#include "apps/commands/program_text.hpp"

#include "apps/failure.hpp"

namespace wheeltap::apps {
namespace {

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
    text.replace(at, what.size(), by);
  return text;
}

/// Quotes a text for a shell.
std::string quoted_argument(const std::string& text) {
  return "'" + replaced(text, "'", "'\\''") + "'";
}

std::string joined(const std::vector<std::string>& words, const std::string& between) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : between) + word;
  return text;
}

std::vector<std::string> options_of(const CommandText& command) {
  std::vector<std::string> names;
  for (const OptionText& option : command.options)
    if (!option.is_argument) names.insert(names.end(), option.names.begin(), option.names.end());
  return names;
}

/// Options with a value. The shell has no list of values and completes file names instead.
std::vector<std::string> taking_values(const CommandText& command) {
  std::vector<std::string> names;
  for (const OptionText& option : command.options)
    if (!option.is_argument && !option.value.empty())
      names.insert(names.end(), option.names.begin(), option.names.end());
  return names;
}

std::string bash(const ProgramText& program) {
  std::vector<std::string> commands;
  for (const CommandText& command : program.commands) commands.push_back(command.name);
  const std::string function = "_" + program.name;
  std::string text = "# bash completion for " + program.name + ": source it, or install it.\n" +
                     function +
                     "() {\n"
                     "  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} "
                     "options='' values=''\n"
                     "  COMPREPLY=()\n"
                     "  if ((COMP_CWORD == 1)); then\n"
                     "    COMPREPLY=($(compgen -W '" +
                     joined(commands, " ") +
                     " --help --version' -- \"$word\"))\n"
                     "    return\n"
                     "  fi\n"
                     "  case ${COMP_WORDS[1]} in\n";
  for (const CommandText& command : program.commands) {
    text += "    " + command.name + ") options='" + joined(options_of(command), " ") +
            "' values=' " + joined(taking_values(command), " ") + " ' ;;\n";
  }
  text +=
      "  esac\n"
      "  if [[ $word == -* ]]; then\n"
      "    COMPREPLY=($(compgen -W \"$options\" -- \"$word\"))\n"
      "  elif [[ $before == --simd && $values == *' --simd '* ]]; then\n"
      "    COMPREPLY=($(compgen -W 'baseline avx2 avx512' -- \"$word\"))\n"
      "  else\n"
      "    compopt -o default 2>/dev/null\n"
      "  fi\n"
      "}\n"
      "complete -F " +
      function + " " + program.name + "\n";
  return text;
}

/// Completion for zsh: '(-o --output)'{-o,--output}'[description]:value:_files'.
std::string zsh(const ProgramText& program) {
  const auto plain = [](const std::string& text) {
    std::string out;
    for (const char c : text) {
      if (c == '[' || c == ']' || c == ':' || c == '\\') out += '\\';
      out += c;
    }
    return replaced(out, "'", "'\\''");
  };
  std::string text = "#compdef " + program.name + "\n# zsh completion for " + program.name +
                     ".\nlocal -a commands=(\n";
  for (const CommandText& command : program.commands)
    text += "  '" + command.name + ":" + plain(command.description) + "'\n";
  text +=
      ")\nif (( CURRENT == 2 )); then\n  _describe command commands\n  return\nfi\n"
      "local command=$words[2]\nshift words\n(( CURRENT-- ))\ncase $command in\n";
  for (const CommandText& command : program.commands) {
    text += "  " + command.name + ") _arguments";
    for (const OptionText& option : command.options) {
      if (option.is_argument) {
        text += " \\\n    '*:" + plain(option.names[0]) + ":_files'";
        continue;
      }
      const std::string names = joined(option.names, " ");
      text += " \\\n    '(" + names + ")'" +
              (option.names.size() > 1 ? "{" + joined(option.names, ",") + "}" : option.names[0]) +
              "'[" + plain(option.description) + "]" +
              (option.value.empty() ? "" : ":value:_files") + "'";
    }
    text += " ;;\n";
  }
  return text + "esac\n";
}

std::string fish(const ProgramText& program) {
  std::string text = "# fish completion for " + program.name + ".\n";
  const std::string begin = "complete -c " + program.name;
  for (const CommandText& command : program.commands) {
    text += begin + " -f -n __fish_use_subcommand -a " + command.name + " -d " +
            quoted_argument(command.description) + "\n";
  }
  for (const CommandText& command : program.commands) {
    for (const OptionText& option : command.options) {
      if (option.is_argument) continue;
      text += begin + " -n '__fish_seen_subcommand_from " + command.name + "'";
      for (const std::string& name : option.names)
        text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
      text += (option.value.empty() ? "" : " -r") + (" -d " + quoted_argument(option.description)) +
              "\n";
    }
  }
  return text;
}

/// Escapes hyphens, and lines that begin like a macro, for man pages.
std::string roff(const std::string& text) {
  std::string out = replaced(replaced(text, "\\", "\\e"), "-", "\\-");
  if (out.starts_with('.') || out.starts_with('\'')) out.insert(0, "\\&");
  return out;
}

}  // namespace

std::string completion(const ProgramText& program, const std::string& shell) {
  if (shell == "bash") return bash(program);
  if (shell == "zsh") return zsh(program);
  if (shell == "fish") return fish(program);
  throw Failure(Exit::usage, shell + ": completion is available for bash, zsh and fish");
}

std::string man_page(const ProgramText& program) {
  std::string text = ".TH WHEELTAP 1 \"\" \"" + roff(program.name + " " + program.version) +
                     "\" \"User Commands\"\n.SH NAME\n" + program.name + " \\- " +
                     roff(program.description) + "\n.SH SYNOPSIS\n.B " + program.name +
                     "\n.I COMMAND\n[\\fIoptions\\fR]\n.SH COMMANDS\n";
  for (const CommandText& command : program.commands) {
    text += ".SS " + program.name + " " + roff(command.name);
    for (const OptionText& option : command.options)
      if (option.is_argument) text += " \\fI" + roff(option.names[0]) + "\\fR";
    text += "\n" + roff(command.description) + "\n";
    for (const OptionText& option : command.options) {
      text += ".TP\n";
      text += (option.is_argument ? ".I " : ".B ") + roff(joined(option.names, ", "));
      if (!option.is_argument && !option.value.empty()) text += " \\fR" + roff(option.value);
      text += "\n" + roff(option.description) + "\n";
    }
  }
  return text +
         ".SH EXIT STATUS\n"
         "Code 0: done (the last line and summary.json state whether a run has converged). Code "
         "64: bad command line. Code 65: invalid case or data. Code 66: missing or unreadable "
         "file. Code 70: internal error. Code 73: output cannot be written. Code 130: "
         "interrupted before there were results.\n"
         ".SH SEE ALSO\n"
         "\\fBwheeltap schema\\fR prints the JSON Schema of a case, \\fBwheeltap explain\\fR "
         "explains a key, \\fBwheeltap init\\fR writes a starter case.\n";
}

}  // namespace wheeltap::apps
