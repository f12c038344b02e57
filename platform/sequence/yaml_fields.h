#ifndef PLANEFOLD_PLATFORM_SEQUENCE_YAML_FIELDS_H
#define PLANEFOLD_PLATFORM_SEQUENCE_YAML_FIELDS_H

#include <yaml-cpp/yaml.h>

#include <string>
#include <vector>

namespace pf::sequence {

/// Largest YAML file that is read, and the deepest nesting: calibrations and targets need a thousandth of it.
constexpr size_t kMaxYamlBytes = 1u << 20;
constexpr int kMaxYamlDepth = 32;

/// A YAML map whose fields are asked for by name. Every refusal is a ReadError that begins with the file and names the field.
class Fields {
 public:
  /// Parses text; throws ReadError when it is not YAML or not a map at its top.
  Fields(const std::string& text, const std::string& file);

  bool has(const std::string& key) const;
  bool has_any(const std::vector<std::string>& keys) const;
  /// The map below a key; its fields are named "key.field" in messages.
  Fields below(const std::string& key) const;
  std::string text(const std::string& key) const;
  std::string text_or(const std::string& key, const std::string& otherwise) const;
  double number(const std::string& key) const;
  double number_or(const std::string& key, double otherwise) const;
  int integer(const std::string& key) const;
  /// A list of finite numbers, at most limit of them.
  std::vector<double> numbers(const std::string& key, size_t limit) const;
  /// A list of lists of finite numbers.
  std::vector<std::vector<double>> rows(const std::string& key, size_t limit, size_t columns) const;

  /// What the map may hold: the keys that are read, and others that are known and not used here; of these, one that ends in * stands
  /// for all that begin so.
  struct Known {
    std::vector<std::string> read, unused;
    bool ours = false;  ///< a form of this project, in which any other key is a mistake
  };
  /// Refuses a key that is read and stands there twice, one that looks like a misspelling of one that is read and, in a form of ours,
  /// any that is not known. Returns one line on what else is ignored, or nothing.
  std::string check_keys(const Known& known) const;

  [[noreturn]] void refuse_field(const std::string& key, const std::string& why) const;

 private:
  Fields(const YAML::Node& node, const std::string& file, const std::string& prefix)
      : node_(node), file_(file), prefix_(prefix) {}

  YAML::Node at(const std::string& key) const;
  double to_number(const YAML::Node& node, const std::string& key) const;
  std::vector<double> to_numbers(const YAML::Node& node, const std::string& key, size_t limit) const;

  YAML::Node node_;
  std::string file_;
  std::string prefix_;
};

}  // namespace pf::sequence

#endif
