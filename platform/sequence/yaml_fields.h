#ifndef PLANEFOLD_PLATFORM_SEQUENCE_YAML_FIELDS_H
#define PLANEFOLD_PLATFORM_SEQUENCE_YAML_FIELDS_H

#include <yaml-cpp/yaml.h>

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "refuse.h"

namespace pf::sequence {

/// Largest YAML file that is read, and the deepest nesting: calibrations and targets need a thousandth of it.
constexpr size_t kMaxYamlBytes = 1u << 20;
constexpr int kMaxYamlDepth = 32;

/// A field that no form of this kind has. What it says is complete without a proposal; read_with_hints adds one that holds.
class UnknownField : public ReadError {
 public:
  UnknownField(const std::string& line, std::vector<std::string> above, std::string key, std::string nearest)
      : ReadError(line), above_(std::move(above)), key_(std::move(key)), nearest_(std::move(nearest)) {}

  const std::vector<std::string>& above() const {
    return above_;
  }  ///< keys of the maps that it lies in, outermost first
  const std::string& key() const { return key_; }
  const std::string& nearest() const { return nearest_; }  ///< the key that it resembles, or ""

 private:
  std::vector<std::string> above_;
  std::string key_, nearest_;
};

/// Text that holds no map.
class NoFields : public ReadError {
 public:
  using ReadError::ReadError;
};

/// A YAML map whose fields are asked for by name. Every refusal is a ReadError that begins with the file and names the field.
class Fields {
 public:
  /// Parses text, of which the first document counts; throws ReadError when it is not YAML or not a map at its top.
  Fields(const std::string& text, const std::string& file);
  /// The same for each document of the text that is not empty; at least one.
  static std::vector<Fields> documents(const std::string& text, const std::string& file);

  /// The map with a key that lies below others renamed, or removed where its new name is "".
  Fields edited(const std::vector<std::string>& above, const std::string& key, const std::string& name) const;

  const std::string& file() const { return file_; }
  std::vector<std::string> keys() const;
  bool is_map(const std::string& key) const;
  bool is_scalar(const std::string& key) const;
  bool has(const std::string& key) const;
  bool has_any(const std::vector<std::string>& keys) const;
  /// The map below a key; its fields are named "key.field" in messages.
  Fields below(const std::string& key) const;
  /// The fields of this map and of the one below a key. One that is in both is refused.
  Fields with_those_below(const std::string& key) const;
  std::string text(const std::string& key) const;
  std::string text_or(const std::string& key, const std::string& otherwise) const;
  double number(const std::string& key) const;
  double number_or(const std::string& key, double otherwise) const;
  int integer(const std::string& key) const;
  /// 0, 1, true, false, yes, no.
  bool flag_or(const std::string& key, bool otherwise) const;
  /// Numbers in one text, cut at blanks, as KITTI has them.
  std::vector<double> numbers_in_text(const std::string& key) const;
  /// rows x columns numbers in rows: a list, a list of rows, or a map with data (OpenCV, ROS), whose rows and cols must be these.
  std::vector<double> matrix(const std::string& key, size_t rows, size_t columns) const;
  /// A row or column of at most limit numbers in the same three forms.
  std::vector<double> vector(const std::string& key, size_t limit) const;
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
  /// Refuses a key that is read and stands there twice, one that looks like a misspelling of one that is read, one that may change
  /// what others mean (meaning.h) and, in a form of ours, any that is not known. The last three are UnknownField.
  /// Adds to notes one line on what else is ignored.
  void check_keys(const Known& known, std::vector<std::string>& notes) const;

  [[noreturn]] void refuse_field(const std::string& key, const std::string& why) const;

 private:
  Fields(const YAML::Node& node, const std::string& file, std::vector<std::string> above)
      : node_(node), file_(file), above_(std::move(above)) {}

  std::string name_of(const std::string& key) const;
  std::string names_of(const std::vector<std::string>& keys) const;
  [[noreturn]] void refuse_unknown(const std::string& key, const Known& known, const char* why) const;

  /// columns  of each row of a list of rows; 0: any
  std::vector<double> flat(const std::string& key, size_t limit, size_t columns) const;
  YAML::Node at(const std::string& key) const;
  double to_number(const YAML::Node& node, const std::string& key) const;
  std::vector<double> to_numbers(const YAML::Node& node, const std::string& key, size_t limit) const;

  YAML::Node node_;
  std::string file_;
  std::vector<std::string> above_;
};

/// Reads the fields. Where one is not known, tries what could be meant by it, and adds to the refusal what would be accepted: another name
/// for the field, or the rest without it.
void read_with_hints(const Fields& fields, const std::function<void(const Fields&)>& read);

}  // namespace pf::sequence

#endif
