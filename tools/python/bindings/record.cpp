#include "record.h"

#include <nanobind/ndarray.h>

#include <cmath>
#include <cstring>

namespace pf::python {

namespace {

const char* element_name(Kind kind) {
  switch (kind) {
    case Kind::kDouble:
      return "float64";
    case Kind::kInt32:
      return "int32";
    case Kind::kUint32:
      return "uint32";
    case Kind::kInt64:
      return "int64";
    case Kind::kUint64:
      return "uint64";
    default:
      return "uint8";
  }
}

/// An array in the structure's own memory, which it keeps alive.
template <class Element>
nb::object view(const Field& field, void* at, nb::handle owner) {
  return nb::ndarray<nb::numpy, Element>(static_cast<Element*>(at), field.shape.size(), field.shape.data(), owner)
      .cast();
}

nb::object array(const Field& field, void* at, nb::handle owner) {
  switch (field.kind) {
    case Kind::kDouble:
      return view<double>(field, at, owner);
    case Kind::kInt32:
      return view<int32_t>(field, at, owner);
    case Kind::kUint32:
      return view<uint32_t>(field, at, owner);
    case Kind::kInt64:
      return view<int64_t>(field, at, owner);
    case Kind::kUint64:
      return view<uint64_t>(field, at, owner);
    default:
      return view<uint8_t>(field, at, owner);
  }
}

nb::object number(const Field& field, const void* at) {
  switch (field.kind) {
    case Kind::kDouble:
      return nb::float_(*static_cast<const double*>(at));
    case Kind::kInt32:
      return nb::int_(*static_cast<const int32_t*>(at));
    case Kind::kUint32:
      return nb::int_(*static_cast<const uint32_t*>(at));
    case Kind::kInt64:
      return nb::int_(*static_cast<const int64_t*>(at));
    case Kind::kUint64:
      return nb::int_(*static_cast<const uint64_t*>(at));
    default:
      return nb::int_(*static_cast<const uint8_t*>(at));
  }
}

[[noreturn]] void refuse(const RecordTable& table, const Field& field, nb::handle value, const std::string& takes) {
  const std::string given = nb::str(value.type().attr("__name__")).c_str();
  throw nb::type_error((table.name + "." + field.name + ": takes " + takes + ", and not a " + given).c_str());
}

template <class Number>
void set_number(const RecordTable& table, const Field& field, void* at, nb::handle value) {
  Number number{};
  if (!nb::try_cast<Number>(value, number)) {
    const bool whole = !std::is_floating_point_v<Number>;
    refuse(table, field, value,
           !whole ? "a number"
                  : std::string("a whole number of ") + element_name(field.kind) +
                        (field.type.empty() ? "" : " or a planefold." + field.type));
  }
  std::memcpy(at, &number, sizeof number);
}

std::string text_of(const std::vector<size_t>& shape) {
  std::string text;
  for (size_t extent : shape) text += (text.empty() ? "" : " x ") + std::to_string(extent);
  return text;
}

void set_array(const RecordTable& table, const Field& field, void* at, nb::handle value) {
  const nb::object given = nb::module_::import_("numpy").attr("ascontiguousarray")(value, element_name(field.kind));
  const auto rows = nb::cast<nb::ndarray<nb::ro, nb::c_contig, nb::device::cpu>>(given);
  bool fits = rows.ndim() == field.shape.size();
  for (size_t i = 0; fits && i < rows.ndim(); ++i) {
    const bool fewer = i == 0 && field.min_rows > 0 && rows.shape(0) < field.shape[0];
    fits = fewer || rows.shape(i) == field.shape[i];
  }
  if (!fits) {
    std::vector<size_t> shape;
    for (size_t i = 0; i < rows.ndim(); ++i) shape.push_back(rows.shape(i));
    throw nb::value_error((table.name + "." + field.name + ": takes " + (field.min_rows > 0 ? "at most " : "") +
                           text_of(field.shape) + " numbers, and was given " + text_of(shape))
                              .c_str());
  }
  std::memset(at, 0, field.bytes);
  std::memcpy(at, rows.data(), rows.nbytes());
}

/// An object of the class or of one derived from it, made by its __init__.
bool holds(nb::handle type, nb::handle object) {
  return PyType_IsSubtype(Py_TYPE(object.ptr()), reinterpret_cast<PyTypeObject*>(type.ptr())) != 0 &&
         nb::inst_ready(object);
}

void set_record(const RecordTable& table, const Field& field, void* at, nb::handle value) {
  if (!holds(table.module.attr(field.type.c_str()), value)) refuse(table, field, value, "a planefold." + field.type);
  std::memmove(at, nb::inst_ptr<void>(value), field.bytes);
}

std::string python_type(const Field& field, bool setter) {
  if (!field.shape.empty()) {
    return setter ? "numpy.typing.ArrayLike"
                  : std::string("numpy.typing.NDArray[numpy.") + element_name(field.kind) + "]";
  }
  if (field.kind == Kind::kRecord) return field.type;
  if (field.kind == Kind::kDouble) return "float";
  return field.type.empty() || setter ? "int" : field.type;
}

void check_type(const RecordTable& table, nb::handle self) {
  if (!holds(table.type, self)) throw nb::type_error(("this is no planefold." + table.name).c_str());
}

void add_attribute(const RecordTable& table, const Field& field) {
  const RecordTable* owner = &table;
  const Field* what = &field;
  const std::string getter_text = "def " + field.name + "(self) -> " + python_type(field, false);
  const std::string setter_text = "def " + field.name + "(self, value: " + python_type(field, true) + ") -> None";
  const nb::object getter = nb::cpp_function(
      [owner, what](nb::handle self) {
        check_type(*owner, self);
        return get_field(*owner, *what, nb::inst_ptr<void>(self), self);
      },
      nb::is_method(), nb::sig(getter_text.c_str()), field.doc.c_str());
  const nb::object setter = nb::cpp_function(
      [owner, what](nb::handle self, nb::handle value) {
        check_type(*owner, self);
        set_field(*owner, *what, nb::inst_ptr<void>(self), value);
      },
      nb::is_method(), nb::sig(setter_text.c_str()), nb::arg("value").none());
  nb::setattr(table.type, field.name.c_str(),
              nb::module_::import_("builtins").attr("property")(getter, setter, nb::none(), field.doc));
}

/// Numbers of a small array, or the shape of a large one.
std::string describe_array(const Field& field, void* at) {
  size_t count = 1;
  for (size_t extent : field.shape) count *= extent;
  if (count > 9) return "<" + text_of(field.shape) + ">";
  return nb::str(array(field, at, nb::handle(Py_None)).attr("tolist")()).c_str();
}

}  // namespace

std::vector<size_t> shape_of(const std::string& name, std::vector<size_t> extents) {
  const bool matrix = name.rfind("covariance", 0) == 0 || name.rfind("R_", 0) == 0;
  if (!matrix || extents.size() != 1) return extents;
  const auto side = static_cast<size_t>(std::lround(std::sqrt(static_cast<double>(extents[0]))));
  return side * side == extents[0] ? std::vector<size_t>{side, side} : extents;
}

nb::object get_field(const RecordTable& table, const Field& field, void* base, nb::handle owner) {
  void* at = static_cast<char*>(base) + field.offset;
  if (field.kind == Kind::kRecord) return nb::inst_reference(table.module.attr(field.type.c_str()), at, owner);
  if (!field.shape.empty()) return array(field, at, owner);
  const nb::object value = number(field, at);
  if (field.type.empty()) return value;
  try {
    return table.module.attr(field.type.c_str())(value);
  } catch (const nb::python_error&) {
    return value;  // of planefold_research.h, beside the enum's own
  }
}

void set_field(const RecordTable& table, const Field& field, void* base, nb::handle value) {
  void* at = static_cast<char*>(base) + field.offset;
  if (field.kind == Kind::kRecord) return set_record(table, field, at, value);
  if (!field.shape.empty()) return set_array(table, field, at, value);
  switch (field.kind) {
    case Kind::kDouble:
      return set_number<double>(table, field, at, value);
    case Kind::kInt32:
      return set_number<int32_t>(table, field, at, value);
    case Kind::kUint32:
      return set_number<uint32_t>(table, field, at, value);
    case Kind::kInt64:
      return set_number<int64_t>(table, field, at, value);
    case Kind::kUint64:
      return set_number<uint64_t>(table, field, at, value);
    default:
      return set_number<uint8_t>(table, field, at, value);
  }
}

void set_fields(const RecordTable& table, void* base, const nb::kwargs& values) {
  for (auto [key, value] : values) {
    const auto name = nb::cast<std::string>(key);
    const Field* found = nullptr;
    for (const Field& field : table.fields) found = field.name == name ? &field : found;
    if (found == nullptr) throw nb::type_error((table.name + " has no field " + name).c_str());
    set_field(table, *found, base, value);
  }
}

std::string describe(const RecordTable& table, nb::handle self) {
  check_type(table, self);
  std::string text;
  for (const Field& field : table.fields) {
    void* at = nb::inst_ptr<char>(self) + field.offset;
    const std::string value = !field.shape.empty()          ? describe_array(field, at)
                              : field.kind == Kind::kRecord ? field.type + "(...)"
                                                            : std::string(nb::str(number(field, at)).c_str());
    text += (text.empty() ? "" : ", ") + field.name + "=" + value;
  }
  return table.name + "(" + text + ")";
}

std::string init_signature(const RecordTable& table) {
  std::string text = "def __init__(self, *";
  for (const Field& field : table.fields) text += ", " + field.name + ": " + python_type(field, true) + " = ...";
  return text + ") -> None";
}

void add_attributes(RecordTable& table) {
  for (const Field& field : table.fields) add_attribute(table, field);
}

template <>
void initialise(pf_config_t& config) {
  pf_config_default(&config);
}

template <>
void initialise(pf_research_t& research) {
  pf_research_default(&research);
}

template <>
void initialise(pf_pose_t& pose) {
  pose.q_WC[0] = 1.0;
}

template <>
void initialise(pf_imu_model_t& imu) {
  pf_config_t config;
  pf_config_default(&config);
  imu = config.imu;
}

template <>
void initialise(pf_sim_options_t& options) {
  pf_sim_options_default("desk", &options);
}

template <>
void initialise(pf_sim_imu_options_t& options) {
  pf_sim_imu_options_default(&options);
}

}  // namespace pf::python
