#include "service/edge/cli/manual.h"

#include <functional>
#include <sstream>

namespace soffit {
namespace {

using Visit = std::function<void(const CLI::App& command, const std::string& path)>;

/// The program and its subcommands, each with the words that lead to it.
void ForEachCommand(const CLI::App& command, const std::string& path, const Visit& visit) {
  visit(command, path);
  for (const CLI::App* sub : command.get_subcommands([](const CLI::App*) { return true; }))
    ForEachCommand(*sub, path + " " + sub->get_name(), visit);
}

/// Text as troff takes it.
std::string Escape(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '\\')
      escaped += "\\e";
    else if (c == '-')
      escaped += "\\-";
    else if (c == '\n')
      escaped += "\n.br\n";
    else if ((c == '.' || c == '\'') && (escaped.empty() || escaped.back() == '\n'))
      escaped += std::string("\\&") + c;
    else
      escaped += c;
  }
  return escaped;
}

std::string Join(const std::vector<std::string>& words) {
  std::string joined;
  for (const std::string& word : words) joined += (joined.empty() ? "" : " ") + word;
  return joined;
}

std::vector<std::string> FlagsOf(const CLI::Option& option) {
  std::vector<std::string> flags;
  for (const std::string& name : option.get_snames()) flags.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) flags.push_back("--" + name);
  return flags;
}

/// "{bt,ot}" in the name of the type: what CLI::IsMember allows.
std::vector<std::string> ValuesOf(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t open = type.find('{');
  const std::size_t close = type.find('}', open);
  if (open == std::string::npos || close == std::string::npos) return {};
  std::vector<std::string> values;
  std::istringstream list(type.substr(open + 1, close - open - 1));
  for (std::string value; std::getline(list, value, ',');) values.push_back(value);
  return values;
}

void WriteOption(std::ostream& text, const CLI::Option& option) {
  const std::vector<std::string> flags = FlagsOf(option);
  text << ".TP\n";
  if (flags.empty()) {
    text << ".I " << Escape(option.get_name(true)) << '\n';
  } else {
    text << ".B " << Escape(Join(flags)) << '\n';
  }
  text << Escape(option.get_description());
  if (option.get_required()) text << " (required)";
  text << '\n';
}

}  // namespace

std::string WriteManual(const CLI::App& app) {
  std::ostringstream text;
  text << ".TH " << app.get_name() << " 1\n.SH NAME\n"
       << app.get_name() << " \\- " << Escape(app.get_description()) << "\n.SH COMMANDS\n";
  ForEachCommand(app, app.get_name(), [&](const CLI::App& command, const std::string& path) {
    const bool is_leaf = command.get_subcommands([](const CLI::App*) { return true; }).empty();
    if (!is_leaf) return;
    text << ".SS " << Escape(path) << '\n' << Escape(command.get_description()) << '\n';
    for (const CLI::Option* option : command.get_options()) {
      if (option->get_name() != "--help") WriteOption(text, *option);
    }
  });
  return text.str();
}

std::string WriteBashCompletion(const CLI::App& app) {
  const std::string function = "_" + app.get_name();
  std::ostringstream text;
  text << "# Completion of " << app.get_name() << " for bash: source this file.\n"
       << function << "() {\n"
       << "  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} path=" << app.get_name()
       << " i\n"
       << "  for ((i = 1; i < COMP_CWORD; i++)); do\n"
       << "    case \"$path ${COMP_WORDS[i]}\" in\n      ";
  std::string alternatives;
  ForEachCommand(app, app.get_name(), [&](const CLI::App& command, const std::string& path) {
    if (&command != &app) alternatives += (alternatives.empty() ? "\"" : "|\"") + path + "\"";
  });
  text << alternatives << ") path=\"$path ${COMP_WORDS[i]}\" ;;\n    esac\n  done\n"
       << "  case \"$path $before\" in\n";
  ForEachCommand(app, app.get_name(), [&](const CLI::App& command, const std::string& path) {
    for (const CLI::Option* option : command.get_options()) {
      const std::vector<std::string> values = ValuesOf(*option);
      if (values.empty()) continue;
      for (const std::string& flag : FlagsOf(*option)) {
        text << "    \"" << path << ' ' << flag << "\") COMPREPLY=($(compgen -W \"" << Join(values)
             << "\" -- \"$word\")); return ;;\n";
      }
    }
  });
  text << "  esac\n  case \"$path\" in\n";
  ForEachCommand(app, app.get_name(), [&](const CLI::App& command, const std::string& path) {
    std::vector<std::string> words;
    for (const CLI::App* sub : command.get_subcommands([](const CLI::App*) { return true; }))
      words.push_back(sub->get_name());
    for (const CLI::Option* option : command.get_options()) {
      for (const std::string& flag : FlagsOf(*option)) words.push_back(flag);
    }
    text << "    \"" << path << "\") COMPREPLY=($(compgen -W \"" << Join(words) << "\" -- \"$word\")) ;;\n";
  });
  text << "  esac\n}\ncomplete -o default -F " << function << ' ' << app.get_name() << '\n';
  return text.str();
}

}  // namespace soffit
