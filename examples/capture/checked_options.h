#ifndef PLANEFOLD_CAPTURE_CHECKED_OPTIONS_H
#define PLANEFOLD_CAPTURE_CHECKED_OPTIONS_H

#include <CLI/CLI.hpp>
#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

namespace pf::capture {

/// CLI::Range for double, but NaN, which CLI::Range accepts, is rejected.
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

/// How many letters have to be changed, left out, added or exchanged with their neighbour to make one word of the other.
inline size_t typing_errors(const std::string& a, const std::string& b) {
  std::vector<std::vector<size_t>> cost(a.size() + 1, std::vector<size_t>(b.size() + 1));
  for (size_t i = 0; i <= a.size(); ++i) {
    for (size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        cost[i][j] = i + j;
        continue;
      }
      cost[i][j] =
          std::min({cost[i - 1][j] + 1, cost[i][j - 1] + 1, cost[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        cost[i][j] = std::min(cost[i][j], cost[i - 2][j - 2] + 1);
      }
    }
  }
  return cost[a.size()][b.size()];
}

/// " (is it --frames?)" of the name that is most like a word: at most two typing errors away, or one begins with the other; "": of none.
inline std::string suggestion(const std::string& word, const std::vector<std::string>& names) {
  std::string best;
  size_t least = 3;
  for (const std::string& name : names) {
    const size_t shared = std::min(word.size(), name.size());
    const bool begins = shared > 3 && name.compare(0, shared, word, 0, shared) == 0;
    const size_t errors = begins ? 2 : typing_errors(word, name);
    if (errors < least && 2 * errors < name.size()) {
      best = name;
      least = errors;
    }
  }
  return best.empty() ? "" : " (is it " + best + "?)";
}

/// What is wrong with a command line, in place of CLI11's words. Of what it does not know CLI11 names the last word first.
inline std::string what_is_wrong(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<const CLI::App*> commands = app.get_subcommands([](const CLI::App*) { return true; });
  std::vector<std::string> names;
  std::vector<const CLI::App*> apps = {&app};
  for (const CLI::App* command : commands) {
    if (app.get_subcommands().empty()) names.push_back(command->get_name());
  }
  for (const CLI::App* command : app.get_subcommands()) apps.push_back(command);
  for (const CLI::App* each : apps) {
    for (const CLI::Option* option : each->get_options()) {
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    }
  }
  const std::vector<std::string> unknown = app.remaining(true);
  if (!unknown.empty()) {
    const std::string word = unknown.front().substr(0, unknown.front().find('='));
    return "'" + word + "' is no " + (commands.empty() ? "" : "command or ") + "option that is known here" +
           suggestion(word, names);
  }
  const std::string text = error.what();
  const std::string name = text.substr(0, text.find(':'));
  const auto has = [&](const char* part) { return text.find(part) != std::string::npos; };
  if (error.get_name() == "ArgumentMismatch") {
    if (has("missing")) return name + " needs a value behind it";
    if (has(": At Most 1 required")) return name + " is there more than once; leave one of them away";
    const size_t least = text.find(": At least ");
    if (least != std::string::npos) {
      return name + " needs " + text.substr(least + 11, text.find(' ', least + 11) - least - 11) + " numbers";
    }
  }
  const size_t given = text.find(" = ");
  if (error.get_name() == "ConversionError" && given != std::string::npos && has("Could not convert: ")) {
    return text.substr(19, given - 19) + ": '" + text.substr(given + 3) + "' cannot be read";
  }
  const size_t choices = text.find(" not in {");
  if (choices != std::string::npos && text.find(": ") < choices) {
    const size_t word = text.find(": ") + 2;
    std::string list = text.substr(choices + 9, text.size() - choices - 10);
    for (size_t i = list.find(','); i != std::string::npos; i = list.find(',', i + 1)) list.insert(i + 1, " ");
    return name + ": '" + text.substr(word, choices - word) + "' is none of " + list;
  }
  return commands.empty() || !has("A subcommand is required") ? text : "which command?";
}

/// A name that is empty is one that a variable of the shell should have held; without the option would be something else.
inline CLI::Validator not_empty() {
  return CLI::Validator(
      [](std::string& text) { return text.empty() ? std::string("is empty; name a file, or leave it away") : ""; }, "");
}

}  // namespace pf::capture

#endif
