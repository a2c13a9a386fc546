#include "studies/cli/man_page.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <string_view>
#include <vector>

#include "studies/cli/command_tree.h"
#include "studies/version.h"

namespace marti::studies::cli {

namespace {

// Text as roff shows it unchanged: '-' is a hyphen that can be copied, and no line begins with a request.
std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '\\') {
      result += "\\e";
    } else if (c == '-') {
      result += "\\-";
    } else {
      if ((c == '.' || c == '\'') && (result.empty() || result.back() == '\n')) {
        result += "\\&";
      }
      result += c;
    }
  }
  return result;
}

std::string bold(std::string_view text) { return "\\fB" + escaped(text) + "\\fR"; }
std::string italic(std::string_view text) { return "\\fI" + escaped(text) + "\\fR"; }

// "-o DIR, --output DIR" in roff.
std::string names_of(const CLI::Option& option) {
  std::string text;
  const auto add = [&](const std::string& name) {
    text += text.empty() ? "" : ", ";
    text += bold(name);
    if (takes_value(option)) {
      text += " " + italic(option.get_type_name());
    }
  };
  for (const std::string& name : option.get_snames()) {
    add("-" + name);
  }
  for (const std::string& name : option.get_lnames()) {
    add("--" + name);
  }
  return text;
}

// Every command has --help: it is named once, for the program.
std::string options_of(const CLI::App& command) {
  std::string text;
  for (const CLI::Option* option : command.get_options()) {
    if (option == command.get_help_ptr() && command.get_parent() != nullptr) {
      continue;
    }
    const std::string name = option->nonpositional() ? names_of(*option) : italic(option->get_name());
    text += ".TP\n" + name + "\n" + escaped(option->get_description()) + "\n";
  }
  return text;
}

// A command without subcommands, under the words that lead to it.
std::string section_of(const CLI::App& command, const std::string& words) {
  std::string synopsis = words;
  for (const CLI::Option* option : command.get_options()) {
    if (!option->nonpositional()) {
      const std::string name = option->get_name();
      synopsis += option->get_required() ? " " + name : " [" + name + "]";
    }
  }
  return ".SS \"" + escaped(synopsis) + " [options]\"\n" + escaped(command.get_description()) + ".\n" +
         options_of(command);
}

void add_sections(const CLI::App& app, const std::string& words, std::string& text) {
  for (const CLI::App* command : subcommands_of(app)) {
    const std::string longer = words + " " + command->get_name();
    if (subcommands_of(*command).empty()) {
      text += section_of(*command, longer);
    } else {
      add_sections(*command, longer, text);
    }
  }
}

constexpr std::string_view description = R"(.SH DESCRIPTION
.B marti
renders a scene once with a real ray tracer, records every step of it, and says from that record how long the
frame takes on a machine that a configuration describes: processor nodes with caches, an interconnect, memory
banks, a parallel scheme.
It says where the nodes' time goes, what would make the frame shorter, and what another cache, bus or octree would change.
.PP
A configuration is a TOML file; any of its keys can be given as
.BR \-\-set " " \fIkey=value\fR .
.B marti config
explains every key.
)";

constexpr std::string_view endings = R"(.SH "EXIT STATUS"
.TP
0
done
.TP
1
a fault of the program
.TP
2
the input is wrong; the message says what, where, and what would be right
.TP
128 + signal
a signal has ended it; the same sweep command does the rest
.SH FILES
.TP
.I result.json
with the option
.BR \-o :
all figures of one run, beside
.IR image.exr " and " image.png
.TP
.I results.sqlite
all figures of a sweep or a study
.SH EXAMPLES
.TP
marti run configs/marti.toml
the default machine
.TP
marti run configs/marti.toml \-\-set machine.nodes=64 \-o out
the same with 64 nodes; writes image and figures
.TP
marti sweep configs/sweep\-small.toml \-o out \-\-best end \-\-budget 10
many machines, and the fastest for a price of 10
.SH "SEE ALSO"
The tutorial, the timing model and the reference of all keys are in the folder
.I docs
of the source.
)";

}  // namespace

std::string man_page(const CLI::App& app) {
  std::string text = fmt::format(".TH MARTI 1 \"\" \"marti {}\" \"User Commands\"\n", escaped(version)) +
                     ".SH NAME\nmarti \\- simulates multiprocessor ray\\-tracing machines\n.SH SYNOPSIS\n";
  text += ".B marti\n.I command\n.RI [ argument \" ...]\"\n";
  text += description;
  text += ".SH OPTIONS\n" + options_of(app);
  text += ".SH COMMANDS\n";
  add_sections(app, "marti", text);
  text += endings;
  return text;
}

}  // namespace marti::studies::cli
