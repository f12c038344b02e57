#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/scalar.h"
#include "suite.h"

namespace bench {
namespace {

const Suite*& head() {
  static const Suite* suites = nullptr;
  return suites;
}

}  // namespace

Suite::Suite(const char* suite_name, const char* what, int (*entry)(const SuiteOptions&), Input takes_input)
    : name(suite_name), description(what), run(entry), input(takes_input), next(head()) {
  head() = this;
}

const Suite* Suite::first() { return head(); }

const char* scalar_name() { return sizeof(pf::Scalar) == 8 ? "double" : "float"; }

void Report::add(const Row& row) {
  if (rows_.empty()) {
    std::printf("%-34s %-6s %4s %4s %10s  %-24s %6s\n", "name", "scalar", "n", "m", "us", "peer", "ratio");
  }
  std::printf("%-34s %-6s %4d %4d %10.2f", row.name.c_str(), row.scalar.c_str(), row.n, row.m, row.us);
  if (row.peer.empty()) {
    std::printf("\n");
  } else {
    std::printf("  %-24s %6.2f\n", row.peer.c_str(), row.ratio);
  }
  for (const auto& [name, value] : row.figures) std::printf("%34s %-24s %10.4f\n", "", name.c_str(), value);
  std::fflush(stdout);
  rows_.push_back(row);
}

void Report::note(const std::string& key, const std::string& value) {
  std::printf("%-20s %s\n", key.c_str(), value.c_str());
  notes_.emplace_back(key, value);
}

int Report::finish() const {
  if (options_.json.empty()) return 0;
  nlohmann::json document;
  for (const auto& [key, value] : notes_) document["notes"][key] = value;
  document["rows"] = nlohmann::json::array();
  for (const Row& r : rows_) {
    nlohmann::json row = {{"suite", r.suite}, {"name", r.name}, {"scalar", r.scalar},
                          {"n", r.n},         {"m", r.m},       {"us", r.us}};
    row["peer"] = r.peer.empty() ? nlohmann::json() : nlohmann::json(r.peer);
    row["ratio"] = r.peer.empty() ? nlohmann::json() : nlohmann::json(r.ratio);
    for (const auto& [name, value] : r.figures) row[name] = value;
    document["rows"].push_back(row);
  }
  document["written_by"] = "pf-bench";  // so that a later run may take its place (command_line.h)
  std::error_code error;                // that the file cannot be opened says enough
  std::filesystem::create_directories(std::filesystem::path(options_.json).parent_path(), error);
  std::ofstream file(options_.json);
  file << document.dump(1) << '\n';
  if (file) return 0;
  std::fprintf(stderr, "pf-bench: cannot write %s\n", options_.json.c_str());
  return 1;
}

}  // namespace bench
