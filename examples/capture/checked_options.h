#ifndef PLANEFOLD_CAPTURE_CHECKED_OPTIONS_H
#define PLANEFOLD_CAPTURE_CHECKED_OPTIONS_H

#include <CLI/CLI.hpp>
#include <sstream>
#include <string>
#include <vector>

namespace pf::capture {

/// CLI::Range for double, but NaN, which CLI::Range accepts, is refused.
inline CLI::Validator number_in(double low, double high) {
  return CLI::Validator(
      [low, high](std::string& text) {
        double value = 0.0;
        if (CLI::detail::lexical_cast(text, value) && value >= low && value <= high) {
          return std::string();
        }
        std::ostringstream wrong;
        wrong << "'" << text << "' is not a number from " << low << " to " << high;
        return wrong.str();
      },
      CLI::Range(low, high).get_description());
}

/// CLI::Range for whole numbers says neither that it wants one, nor the number that it was given.
inline CLI::Validator whole_number_in(int low, int high) {
  return CLI::Validator(
      [low, high](std::string& text) {
        int value = 0;
        if (CLI::detail::lexical_cast(text, value) && value >= low && value <= high) return std::string();
        return "'" + text + "' is not a whole number from " + std::to_string(low) + " to " + std::to_string(high);
      },
      "INT in [" + std::to_string(low) + " - " + std::to_string(high) + "]");
}

/// What is wrong with a command line. Of what it does not know CLI11 says all words, the last one first.
inline std::string what_is_wrong(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<std::string> unknown = app.remaining();
  return unknown.empty() ? error.what() : "'" + unknown.front() + "' is no option that is known here";
}

/// A name that is empty is one that a variable of the shell should have held; without the option would be something else.
inline CLI::Validator not_empty() {
  return CLI::Validator(
      [](std::string& text) { return text.empty() ? std::string("is empty; name a file, or leave it away") : ""; }, "");
}

}  // namespace pf::capture

#endif
