/// Inertial samples in a file for each sensor, as phones write them.
#include <algorithm>
#include <memory>
#include <system_error>

#include "file.h"
#include "imu.h"
#include "imu_rows.h"
#include "meaning.h"
#include "refuse.h"

namespace pf::sequence {

namespace {

constexpr int64_t kMaxGap = 100000000;  ///< [ns] between two accelerations to take one between them

struct Sensor {
  std::unique_ptr<Table> table;
  std::vector<ImuRow> rows;
};

Sensor read_sensor(const fs::path& path, ImuContent content, std::string& note) {
  Sensor sensor;
  sensor.table = std::make_unique<Table>(read_text(path, kMaxImuBytes, "inertial samples"), path.string());
  const ImuColumns columns = columns_of(*sensor.table, content);
  std::string own = columns.note;
  sensor.rows = read_imu_rows(*sensor.table, columns, own);
  put_in_order(*sensor.table, columns, sensor.rows, own);
  note += own.empty() ? "" : (note.empty() ? "" : "; ") + own;
  return sensor;
}

/// The acceleration at a time, between the two rows about it. at moves on to the later of them. false: none, or they are far apart.
bool accel_at(const std::vector<ImuRow>& rows, int64_t t_ns, size_t& at, double accel[3]) {
  while (at < rows.size() && rows[at].sample.t_ns < t_ns) {
    ++at;
  }
  if (at == rows.size() || (at == 0 && rows[0].sample.t_ns != t_ns)) {
    return false;
  }
  const pf_imu_sample_t& b = rows[at].sample;
  const pf_imu_sample_t& a = rows[at == 0 ? 0 : at - 1].sample;
  const double gap = static_cast<double>(b.t_ns) - static_cast<double>(a.t_ns);
  if (gap > static_cast<double>(kMaxGap) && b.t_ns != t_ns) {
    return false;
  }
  const double share = gap > 0.0 ? (static_cast<double>(t_ns) - static_cast<double>(a.t_ns)) / gap : 1.0;
  for (size_t i = 0; i < 3; ++i) {
    accel[i] = b.t_ns == t_ns ? b.accel[i] : a.accel[i] + share * (b.accel[i] - a.accel[i]);
  }
  return true;
}

/// Samples at the times of the rates.
std::vector<pf_imu_sample_t> join(const Sensor& gyro, const Sensor& accel, std::string& note) {
  std::vector<pf_imu_sample_t> samples;
  size_t at = 0;
  for (const ImuRow& row : gyro.rows) {
    pf_imu_sample_t sample = row.sample;
    if (accel_at(accel.rows, sample.t_ns, at, sample.accel)) {
      samples.push_back(sample);
    }
  }
  if (samples.empty()) {
    refuse(gyro.table->name() + " and " + accel.table->name() +
           ": have no time in common; are both of one recording, and on one clock?");
  }
  const size_t left = gyro.rows.size() - samples.size();
  if (left > 0) {
    note += (note.empty() ? "" : "; ") + std::to_string(left) + " of " + std::to_string(gyro.rows.size()) +
            " rates have no acceleration within 0.1 s and are passed over";
  }
  return samples;
}

/// Adds what gravity is, of a file of its own.
void add_gravity(const fs::path& path, Sensor& accel, std::string& note) {
  const Sensor gravity = read_sensor(path, ImuContent::kGravity, note);
  size_t at = 0, kept = 0;
  for (ImuRow& row : accel.rows) {
    double more[3] = {0.0, 0.0, 0.0};
    if (accel_at(gravity.rows, row.sample.t_ns, at, more)) {
      for (size_t i = 0; i < 3; ++i) {
        row.sample.accel[i] += more[i];
      }
      accel.rows[kept++] = row;
    }
  }
  accel.rows.resize(kept);
  note += (note.empty() ? "" : "; ") + path.filename().string() + " is added to the accelerations, which are without";
}

struct SensorFiles {
  fs::path gyro, accel, gravity;
};

/// How good a table of accelerations is, by its name: whole ones before raw ones. 0: it is none of these.
int rank_of_accelerations(const std::string& name) {
  const auto has = [&](const char* word) { return name.find(word) != std::string::npos; };
  if (!has("acc") || has("linear") || has("user") || has("without")) {
    return 0;
  }
  return has("total") ? 3 : has("uncal") ? 1 : 2;
}

/// The tables of a phone's folder, by their names.
SensorFiles find_sensors(const fs::path& folder) {
  SensorFiles found;
  int best = 0;
  std::vector<fs::path> paths;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), last; !error && entry != last; entry.increment(error)) {
    paths.push_back(entry->path());
  }
  std::sort(paths.begin(), paths.end());
  for (const fs::path& path : paths) {
    const std::string name = lower_case(path.filename().string()), end = lower_case(path.extension().string());
    if (name[0] == '.' || (end != ".csv" && end != ".txt") || !is_file(path)) {
      continue;
    }
    const int rank = rank_of_accelerations(name);
    if (name.find("gyr") != std::string::npos && name.find("acc") == std::string::npos) {
      const bool better = found.gyro.empty() || name.find("uncal") == std::string::npos;
      found.gyro = better ? path : found.gyro;
    } else if (rank > best) {
      best = rank;
      found.accel = path;
    } else if (name.rfind("gravity", 0) == 0) {
      found.gravity = path;
    }
  }
  if (found.gyro.empty() || found.accel.empty()) {
    refuse(folder.string() + ": is a folder without " +
           (found.gyro.empty() ? "a table of rates (Gyroscope.csv)" : "a table of accelerations (Accelerometer.csv)") +
           "; give the file of inertial samples, or GYRO+ACCEL");
  }
  return found;
}

/// Sensor Logger's Accelerometer.csv, which is without gravity: it alone has seconds_elapsed.
bool is_without_gravity(const fs::path& path, const Table& table) {
  const std::vector<std::string>& header = table.header();
  return lower_case(path.filename().string()) == "accelerometer.csv" &&
         std::find(header.begin(), header.end(), "seconds_elapsed") != header.end();
}

std::vector<pf_imu_sample_t> read_pair(const SensorFiles& files, std::string& note) {
  const Sensor gyro = read_sensor(files.gyro, ImuContent::kGyro, note);
  Sensor accel = read_sensor(files.accel, ImuContent::kAccel, note);
  if (is_without_gravity(files.accel, *accel.table)) {
    const fs::path gravity = !files.gravity.empty() ? files.gravity : files.accel.parent_path() / "Gravity.csv";
    if (!is_file(gravity)) {
      refuse(files.accel.string() +
             ": its accelerations are without gravity, which is needed; record TotalAcceleration too, or Gravity");
    }
    add_gravity(gravity, accel, note);
  }
  note += (note.empty() ? "" : "; ") + std::string("rates are of ") + files.gyro.filename().string() +
          ", accelerations of " + files.accel.filename().string();
  return join(gyro, accel, note);
}

}  // namespace

std::vector<pf_imu_sample_t> read_imu(const std::string& path, std::string& note) {
  if (is_folder(path)) {
    return read_pair(find_sensors(path), note);
  }
  for (size_t plus = path.find('+'); !is_file(path) && plus != std::string::npos; plus = path.find('+', plus + 1)) {
    const SensorFiles files{path.substr(0, plus), path.substr(plus + 1), {}};
    if (is_file(files.gyro) || is_file(files.accel)) {
      return read_pair(files, note);
    }
  }
  return parse_imu(read_text(path, kMaxImuBytes, "inertial samples"), path, note);
}

}  // namespace pf::sequence
