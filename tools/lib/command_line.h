#ifndef PLANEFOLD_TOOLS_COMMAND_LINE_H
#define PLANEFOLD_TOOLS_COMMAND_LINE_H

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "../../examples/capture/checked_options.h"

namespace pf::tools {

/// What holds a path, or will hold it: the nearest folder, or file, above it that is there.
inline std::filesystem::path nearest_above(const std::filesystem::path& path) {
  std::error_code error;
  std::filesystem::path there = std::filesystem::absolute(path, error).lexically_normal();
  while (!std::filesystem::exists(there, error) && there.has_relative_path()) {
    there = there.parent_path();
  }
  return there;
}

inline bool is_writable_folder(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::is_directory(path, error) && access(path.c_str(), W_OK) == 0;
}

/// Whether a file holds what no program of this project wrote: neither a report with written_by, nor nothing.
inline bool is_foreign_report(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error) || std::filesystem::file_size(path, error) == 0) return false;
  std::ifstream file(path, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  return text.find("\"written_by\": \"pf-") == std::string::npos;
}

/// Of a report that is written after a long run, whose folder is made where it is missing: that it can be written, and that no file of the
/// user's is in its place, is known before.
inline CLI::Validator writable_file() {
  return CLI::Validator(
      [](std::string& text) {
        std::error_code error;
        const bool exists = std::filesystem::exists(text, error);
        const bool can = exists ? !std::filesystem::is_directory(text, error) && access(text.c_str(), W_OK) == 0
                                : !text.empty() && is_writable_folder(nearest_above(text));
        if (can && is_foreign_report(text)) return "'" + text + "' is there and is no earlier report; name another";
        return can ? std::string() : "'" + text + "' is no file that can be written; name another";
      },
      "");
}

/// The same of a folder.
inline CLI::Validator writable_folder() {
  return CLI::Validator(
      [](std::string& text) {
        const bool can = !text.empty() && is_writable_folder(nearest_above(text));
        return can ? std::string() : "'" + text + "' is no folder that can be written; name another";
      },
      "");
}

/// Rejects numbers that CLI11 accepts and no option means: NaN, infinity, and below zero all but those of the options in with_sign (such as
/// "--turn"). Of the options of an app and of its commands that have been added so far.
inline void check_numbers(CLI::App& app, const std::vector<std::string>& with_sign = {}) {
  for (CLI::Option* option : app.get_options()) {
    const std::string type = option->get_type_name();
    const bool is_whole = type.rfind("INT", 0) == 0 || type.rfind("UINT", 0) == 0;
    if (!is_whole && type.rfind("FLOAT", 0) != 0) continue;
    const std::string name = "--" + option->get_single_name();
    const bool has_sign = std::find(with_sign.begin(), with_sign.end(), name) != with_sign.end();
    option->check(CLI::Validator(
        [is_whole, has_sign](std::string& text) {
          double value = 0.0;
          const bool is_number = CLI::detail::lexical_cast(text, value) && std::isfinite(value) &&
                                 (!is_whole || value == std::floor(value));
          if (is_number && (has_sign || value >= 0.0)) return std::string();
          return "'" + text + "' is not a " + (is_whole ? "whole " : "") + "number" +
                 (has_sign ? "" : " of at least 0");
        },
        ""));
  }
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) check_numbers(*command, with_sign);
}

/// Parses the command line of a program of this name. False where it must end, with code: 0 after --help or --version, else 2, after
/// one line that says what is wrong.
inline bool parse_command_line(CLI::App& app, const std::string& name, int argc, char** argv, int& code) {
  try {
    app.parse(argc, argv);
    return true;
  } catch (const CLI::Success& done) {
    code = app.exit(done);
  } catch (const CLI::ParseError& error) {
    const std::string what = pf::capture::what_is_wrong(app, error);
    const bool commands = !app.get_subcommands([](CLI::App*) { return true; }).empty();
    std::fprintf(stderr, "%s: %s; see %s --help%s\n", name.c_str(), what.c_str(), name.c_str(),
                 commands ? (", and " + name + " COMMAND --help").c_str() : "");
    code = 2;
  }
  return false;
}

}  // namespace pf::tools

#endif
