#ifndef PLANEFOLD_TOOLS_COMMAND_LINE_H
#define PLANEFOLD_TOOLS_COMMAND_LINE_H

#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>
#include <vector>

namespace pf::tools {

/// Parses the command line of a program of this name. False where it must end, with code: 0 after --help or --version, else 2, after
/// one line that says what is wrong.
inline bool parse_command_line(CLI::App& app, const std::string& name, int argc, char** argv, int& code) {
  try {
    app.parse(argc, argv);
    return true;
  } catch (const CLI::Success& done) {
    code = app.exit(done);
  } catch (const CLI::ParseError& error) {
    // Where something is missing CLI11 does not say what was given in its place.
    const std::vector<std::string> unknown = app.remaining(true);
    const std::string what =
        unknown.empty() ? error.what() : "'" + unknown.front() + "' is no command or option that is known here";
    const bool commands = !app.get_subcommands([](CLI::App*) { return true; }).empty();
    std::fprintf(stderr, "%s: %s; see %s --help%s\n", name.c_str(), what.c_str(), name.c_str(),
                 commands ? (", and " + name + " COMMAND --help").c_str() : "");
    code = 2;
  }
  return false;
}

}  // namespace pf::tools

#endif
