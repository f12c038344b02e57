#ifndef PLANEFOLD_PLATFORM_WALLS_FIELDS_H
#define PLANEFOLD_PLATFORM_WALLS_FIELDS_H

#include <initializer_list>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace pf::walls {

using Json = nlohmann::json;

/// What is wrong with a file, as the one line that the user will read. Thrown inside of this room only.
class ReadError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// JSON of a text. Throws ReadError that names the file, and the wall and the field that it was in.
Json parse_json(const std::string& text, const std::string& file);

/// The fields of one object. Everything throws ReadError that names the file, the object and the field.
class Fields {
 public:
  /// where: what the object is called in messages: "wall 'north'", or "" for the file itself.
  Fields(const Json& object, std::string file, std::string where);

  /// Refuses fields that are neither required nor optional, and required ones that are missing.
  void check_keys(std::initializer_list<const char*> required, std::initializer_list<const char*> optional) const;
  bool has(const char* key) const { return object_.contains(key); }
  const Json& at(const char* key) const { return object_.at(key); }
  double number(const char* key) const;
  /// Above zero, and at most this.
  double positive(const char* key, double largest) const;
  std::vector<double> numbers(const char* key, size_t count) const;
  std::vector<double> numbers_of(const Json& list, const char* key, size_t count) const;
  std::string word(const char* key, std::initializer_list<const char*> known) const;
  [[noreturn]] void refuse(const char* key, const std::string& why) const;

 private:
  double number_of(const Json& value, const char* key) const;

  const Json& object_;
  std::string file_, where_;
};

}  // namespace pf::walls

#endif
