#ifndef PLANEFOLD_CAPTURE_CHECKED_OPTIONS_H
#define PLANEFOLD_CAPTURE_CHECKED_OPTIONS_H

#include <CLI/CLI.hpp>
#include <sstream>
#include <string>

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

/// A name that is empty is one that a variable of the shell should have held; without the option would be something else.
inline CLI::Validator not_empty() {
  return CLI::Validator(
      [](std::string& text) { return text.empty() ? std::string("is empty; name a file, or leave it away") : ""; }, "");
}

}  // namespace pf::capture

#endif
