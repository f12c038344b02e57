/// A C structure as a Python class: its fields are attributes, described by a table, so that one function reads any of them.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <planefold/planefold.h>
#include <planefold/planefold_research.h>
#include <planefold_platform/sim.h>

#include <cstddef>
#include <cstdint>
#include <new>
#include <string>
#include <type_traits>
#include <vector>

namespace pf::python {

namespace nb = nanobind;

enum class Kind { kInt32, kUint32, kInt64, kUint64, kUint8, kDouble, kRecord };

struct Field {
  std::string name;
  std::string doc;
  size_t offset = 0;
  size_t bytes = 0;
  Kind kind = Kind::kInt32;
  std::vector<size_t> shape;  ///< of an array, as Python shows it; empty for a single number
  size_t min_rows = 0;        ///< of an array that may be given with fewer rows, the others then zero
  std::string type;           ///< name of the enum, or of the structure
};

struct RecordTable {
  std::string name;
  nb::handle type;
  nb::handle module;
  std::vector<Field> fields;
};

/// Attribute of a structure at `base`; `owner` is the Python object that holds the memory.
nb::object get_field(const RecordTable& table, const Field& field, void* base, nb::handle owner);
void set_field(const RecordTable& table, const Field& field, void* base, nb::handle value);
void set_fields(const RecordTable& table, void* base, const nb::kwargs& values);

/// "Pose(t_ns=0, q_WC=[1, 0, 0, 0], ...)"
std::string describe(const RecordTable& table, nb::handle self);

/// Adds the attributes and __init__'s signature.
void add_attributes(RecordTable& table);
std::string init_signature(const RecordTable& table);

/// What a structure holds before anything is given: the library's own defaults, where it has them.
template <class T>
void initialise(T&) {}
template <>
void initialise(pf_config_t& config);
template <>
void initialise(pf_research_t& research);
template <>
void initialise(pf_pose_t& pose);
template <>
void initialise(pf_imu_model_t& imu);
template <>
void initialise(pf_sim_options_t& options);
template <>
void initialise(pf_sim_imu_options_t& options);

template <class Element>
constexpr Kind kind_of() {
  if constexpr (std::is_same_v<Element, int32_t>) return Kind::kInt32;
  if constexpr (std::is_same_v<Element, uint32_t>) return Kind::kUint32;
  if constexpr (std::is_same_v<Element, int64_t>) return Kind::kInt64;
  if constexpr (std::is_same_v<Element, uint64_t>) return Kind::kUint64;
  if constexpr (std::is_same_v<Element, uint8_t>) return Kind::kUint8;
  if constexpr (std::is_same_v<Element, double>) return Kind::kDouble;
  return Kind::kRecord;
}

/// Matrices that the header keeps row by row get their shape back.
std::vector<size_t> shape_of(const std::string& name, std::vector<size_t> extents);

template <class T>
class Record {
 public:
  Record(nb::module_& module, const char* name, const char* doc)
      : class_(module, name, doc), table_(new RecordTable{name, class_, module, {}}) {}

  template <class Type>
  void add(const char* name, size_t offset, const char* doc, const char* enum_name) {
    using Element = std::remove_all_extents_t<Type>;
    Field field{name, doc, offset, sizeof(Type), kind_of<Element>(), {}, 0, enum_name != nullptr ? enum_name : ""};
    std::vector<size_t> extents;
    if constexpr (std::rank_v < Type >> 0) extents.push_back(std::extent_v<Type, 0>);
    if constexpr (std::rank_v < Type >> 1) extents.push_back(std::extent_v<Type, 1>);
    field.shape = shape_of(name, extents);
    if (field.shape == extents && !extents.empty() && extents[0] >= 8) field.min_rows = 1;
    if constexpr (kind_of<Element>() == Kind::kRecord)
      field.type = nb::cast<std::string>(nb::type<Type>().attr("__name__"));
    table_->fields.push_back(field);
  }

  void finish() {
    add_attributes(*table_);
    const RecordTable* table = table_;
    const std::string signature = init_signature(*table);
    class_.def(
        "__init__",
        [table](T* self, const nb::kwargs& values) {
          T* made = new (self) T{};
          initialise(*made);
          set_fields(*table, made, values);
        },
        nb::sig(signature.c_str()));
    class_.def("__repr__", [table](nb::handle self) { return describe(*table, self); });
    class_.def(
        "copy", [](const T& self) { return T(self); }, "A structure of its own with the same contents.");
    class_.def("__copy__", [](const T& self) { return T(self); });
    class_.def("__deepcopy__", [](const T& self, nb::handle) { return T(self); });
  }

 private:
  nb::class_<T> class_;
  RecordTable* table_;  ///< lives as long as the module, which is as long as the process
};

}  // namespace pf::python
