#include "imu_columns.h"

#include <algorithm>
#include <cstdio>
#include <vector>

#include "imu_time_column.h"
#include "numbers.h"
#include "refuse.h"

namespace pf::sequence {

namespace {

constexpr size_t kBoth = 7, kOne = 4;  ///< columns without a header
constexpr const char* kKnown =
    "known are time, gyro_x, gyro_y, gyro_z, accel_x, accel_y, accel_z and their like, with a unit as in gyro_x "
    "[deg/s]";

/// The first three columns of a role that have one name, and one unit.
Axes find_axes(const ImuHeader& header, std::initializer_list<ImuRole> roles, std::string& family) {
  const std::vector<ImuColumn>& columns = header.columns;
  for (const ImuRole role : roles) {
    for (size_t k = 0; k < columns.size(); ++k) {
      if (columns[k].role != role) {
        continue;
      }
      Axes axes;
      size_t count = 0, seen = 0;
      for (size_t i = 0; i < columns.size(); ++i) {
        if (columns[i].role == role && columns[i].family == columns[k].family) {
          axes.column[static_cast<size_t>(columns[i].axis)] = i;
          seen |= size_t{1} << columns[i].axis;
          ++count;
        }
      }
      if (count > 3 && seen == 7) {
        refuse(header.table.name() + ": has more than one column like '" + header.table.header()[k] +
               "'; leave one set of three");
      }
      if (count == 3 && seen == 7) {
        family = columns[k].family;
        axes.found = true;
        return axes;
      }
    }
  }
  return {};
}

/// The factor to rad/s or m/s^2 of three columns, by the unit in the header; without one they are taken as they are.
void set_factor(const ImuHeader& header, bool rates, bool is_ios, Axes& axes) {
  if (!axes.found) {
    return;
  }
  const std::vector<std::string>& names = header.table.header();
  const ImuColumn& first = header.columns[axes.column[0]];
  // Physics Toolbox: gFx; Core Motion counts in g as well.
  const bool counts_g = !rates && (first.family == "gf" || first.family == "gforce" || is_ios);
  axes.factor = counts_g ? kStandardGravity : 1.0;
  size_t said = ImuColumns::kNone;
  for (const size_t k : axes.column) {
    const std::string& unit = header.columns[k].unit;
    if (unit.empty()) {
      continue;
    }
    const double factor = rates ? factor_of_rate(unit) : factor_of_acceleration(unit);
    if (factor == 0.0) {
      refuse(header.table.name() + ": the unit of its column '" + names[k] + "' is not known; " +
             (rates ? "rad/s and deg/s are" : "m/s^2, g and mg are"));
    }
    if (said != ImuColumns::kNone && factor != axes.factor) {
      refuse(header.table.name() + ": its columns '" + names[said] + "' and '" + names[k] + "' have different units");
    }
    axes.factor = factor;
    said = k;
  }
  axes.factor *= is_ios ? -1.0 : 1.0;
}

void add_note(std::string& note, const std::string& part) { note += (note.empty() ? "" : "; ") + part; }

/// What was done to the numbers, and the columns that are not read.
std::string note_of(const ImuHeader& header, const ImuColumns& columns) {
  std::string note;
  std::vector<bool> used(header.columns.size(), false);
  used[columns.time] = true;
  if (columns.nanoseconds != ImuColumns::kNone) {
    used[columns.nanoseconds] = true;
  }
  for (const Axes* axes : {&columns.gyro, &columns.accel, &columns.gravity}) {
    for (size_t i = 0; i < 3 && axes->found; ++i) {
      used[axes->column[i]] = true;
    }
    if (axes->found && axes->factor != 1.0) {
      char text[64];
      std::snprintf(text, sizeof(text), " is taken times %.6g", axes->factor);
      add_note(note, "'" + header.table.header()[axes->column[0]] + "'" + text +
                         (axes == &columns.gyro ? " to rad/s"
                          : axes->factor < 0.0  ? " to m/s^2, with the sign of iOS"
                                                : " to m/s^2"));
    }
  }
  if (columns.gravity.found) {
    add_note(note, "gravity is added to its accelerations, which are without");
  }
  const auto left = static_cast<size_t>(std::count(used.begin(), used.end(), false));
  if (left > 0) {
    constexpr size_t kNamed = 3;
    std::string names;
    for (size_t i = 0, named = 0; i < used.size() && named < kNamed; ++i) {
      if (!used[i]) {
        names += (named++ == 0 ? "" : ", ") + header.table.header()[i];
      }
    }
    add_note(note, std::to_string(left) + (left == 1 ? " column is" : " columns are") + " not used (" + names +
                       (left > kNamed ? ", ..)" : ")"));
  }
  return note.empty() ? "" : header.table.name() + ": " + note;
}

std::string quoted_names(const Table& table) {
  constexpr size_t kMaxNamed = 12;
  std::string names;
  for (size_t i = 0; i < std::min(table.header().size(), kMaxNamed); ++i) {
    names += (i == 0 ? "'" : ", '") + table.header()[i] + "'";
  }
  return names + (table.header().size() > kMaxNamed ? ", .." : "");
}

/// Time, rates, accelerations in this order, unless a name says otherwise. false: it does.
bool can_be_in_order(const ImuHeader& header) {
  if (header.columns.size() != kBoth) {
    return false;
  }
  for (size_t i = 0; i < kBoth; ++i) {
    const ImuColumn& column = header.columns[i];
    const bool fits = i == 0  ? column.role == ImuRole::kTime || column.role == ImuRole::kElapsed
                      : i < 4 ? column.role == ImuRole::kGyro
                              : column.role == ImuRole::kAccel || column.role == ImuRole::kAccelOrMotion;
    if (!(fits && (i == 0 || column.axis == static_cast<int>(i - 1) % 3)) && column.role != ImuRole::kOther) {
      return false;
    }
  }
  return true;
}

/// Rates and accelerations in one table.
bool find_both(const ImuHeader& header, ImuColumns& columns) {
  std::string family, other;
  columns.gyro = find_axes(header, {ImuRole::kGyro}, family);
  columns.accel = find_axes(header, {ImuRole::kTotal, ImuRole::kAccel}, other);
  if (columns.gyro.found && !columns.accel.found) {
    columns.accel = find_axes(header, {ImuRole::kMotion, ImuRole::kAccelOrMotion}, other);
    columns.gravity = columns.accel.found ? find_axes(header, {ImuRole::kGravity}, other) : Axes();
    if (columns.accel.found && !columns.gravity.found &&
        header.columns[columns.accel.column[0]].role == ImuRole::kMotion) {
      refuse(header.table.name() + ": '" + header.table.header()[columns.accel.column[0]] +
             "' is without gravity, which is needed; record raw accelerations, or gravity beside them");
    }
  }
  if (!columns.gyro.found || !columns.accel.found) {
    return false;
  }
  set_time(header, family, columns);
  return true;
}

/// One sensor: named, or plain x, y and z with a unit or in a file that is named after it.
bool find_one(const ImuHeader& header, ImuContent content, ImuColumns& columns) {
  std::string family;
  if (content == ImuContent::kGyro) {
    columns.gyro = find_axes(header, {ImuRole::kGyro, ImuRole::kPlain}, family);
  } else if (content == ImuContent::kGravity) {
    columns.accel = find_axes(header, {ImuRole::kGravity, ImuRole::kPlain}, family);
  } else {
    columns.accel =
        find_axes(header, {ImuRole::kTotal, ImuRole::kAccel, ImuRole::kAccelOrMotion, ImuRole::kPlain}, family);
  }
  if (!columns.gyro.found && !columns.accel.found) {
    return false;
  }
  set_time(header, family, columns);
  return true;
}

[[noreturn]] void refuse_names(const ImuHeader& header, ImuContent content) {
  const bool none = std::none_of(header.columns.begin(), header.columns.end(), [](const ImuColumn& column) {
    return column.role == ImuRole::kTotal || column.role == ImuRole::kAccel || column.role == ImuRole::kAccelOrMotion ||
           column.role == ImuRole::kMotion;
  });
  const bool rates = std::any_of(header.columns.begin(), header.columns.end(),
                                 [](const ImuColumn& column) { return column.role == ImuRole::kGyro; });
  if (content == ImuContent::kBoth && none == rates) {
    refuse(header.table.name() + ": has " + (none ? "rates and no accelerations" : "accelerations and no rates") +
           "; write both files as csv:GYRO+ACCEL, or csv: and the folder that they lie in");
  }
  refuse(header.table.name() + ": its columns " + quoted_names(header.table) +
         " do not say which are a time, three rates and "
         "three accelerations; " +
         kKnown);
}

/// A column whose numbers grow from row to row, in the first rows.
bool grows(const Table& table, size_t column) {
  constexpr size_t kRows = 50;
  double before = 0.0;
  for (size_t i = 0; i < std::min(table.rows().size(), kRows); ++i) {
    double now = 0.0;
    const TableRow& row = table.rows()[i];
    if (column >= row.fields.size() || !parse_double(row.fields[column], now) || (i > 0 && !(now >= before))) {
      return false;
    }
    before = now;
  }
  return true;
}

ImuColumns in_order(const Table& table, ImuContent content) {
  ImuColumns columns;
  columns.columns = content == ImuContent::kBoth ? kBoth : kOne;
  if (content == ImuContent::kBoth) {
    columns.gyro = {true, {1, 2, 3}, 1.0};
    columns.accel = {true, {4, 5, 6}, 1.0};
    return columns;
  }
  const bool last = !grows(table, 0) && grows(table, 3);
  columns.time = last ? 3 : 0;
  const size_t first = last ? 0 : 1;
  (content == ImuContent::kGyro ? columns.gyro : columns.accel) = {true, {first, first + 1, first + 2}, 1.0};
  return columns;
}

}  // namespace

ImuColumns columns_of(const Table& table, ImuContent content) {
  if (table.header().empty()) {
    return in_order(table, content);
  }
  ImuHeader header{table, {}};
  for (const std::string& name : table.header()) {
    header.columns.push_back(read_imu_column(name));
  }
  ImuColumns columns;
  columns.columns = table.header().size();
  const bool found = content == ImuContent::kBoth ? find_both(header, columns) : find_one(header, content, columns);
  if (!found) {
    if (content == ImuContent::kBoth ? !can_be_in_order(header) : table.has_header_row() || columns.columns != kOne) {
      refuse_names(header, content);
    }
    columns = in_order(table, content);
    columns.unit_said =
        parse_unit(header.columns[columns.time].unit, columns.unit) && columns.unit != TimeUnit::kFrames;
  }
  const bool is_ios = columns.accel.found && header.columns[columns.accel.column[0]].is_ios;
  set_factor(header, true, false, columns.gyro);
  set_factor(header, false, is_ios, columns.accel);
  set_factor(header, false, is_ios, columns.gravity);
  columns.note = note_of(header, columns);
  return columns;
}

}  // namespace pf::sequence
