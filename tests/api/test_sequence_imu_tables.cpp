// Tables of inertial samples as loggers write them: names, units and signs, more columns, a file for each sensor, times out of order.
#include "same.h"
#include "skip.h"

#if __has_include(<planefold_platform/sequence.h>)

#include <cmath>
#include <cstdio>
#include <cstring>

#include "sequence_test.h"

using namespace pf::test;

void setUp() {}
void tearDown() {}

namespace {

constexpr double kG = 9.80665, kDegree = 3.14159265358979323846 / 180.0;

struct Samples {
  static Samples of_text(const std::string& text) {
    Samples samples;
    samples.done =
        pf_parse_imu(text.data(), text.size(), "some.csv", &samples.first, &samples.count, samples.message) == 0;
    return samples;
  }
  static Samples of_path(const std::string& path) {
    Samples samples;
    samples.done = pf_read_imu(path.c_str(), &samples.first, &samples.count, samples.message) == 0;
    return samples;
  }
  Samples(Samples&& other) noexcept { *this = other, other.first = nullptr; }
  ~Samples() { pf_free_imu(first); }

  bool done = false;
  pf_imu_sample_t* first = nullptr;
  size_t count = 0;
  char message[PF_SEQUENCE_MESSAGE] = "";

 private:
  Samples() = default;
  Samples(const Samples&) = default;
  Samples& operator=(const Samples&) = default;
};

void require_sample(const Samples& samples, size_t i, int64_t t_ns, const double (&gyro)[3], const double (&accel)[3]) {
  TEST_ASSERT_TRUE_MESSAGE(samples.done, samples.message);
  TEST_ASSERT_GREATER_THAN_size_t(i, samples.count);
  TEST_ASSERT_EQUAL_INT64(t_ns, samples.first[i].t_ns);
  for (int k = 0; k < 3; ++k) {
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, gyro[k], samples.first[i].gyro[k]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, accel[k], samples.first[i].accel[k]);
  }
}

void refused(const Samples& samples, const char* part) {
  TEST_ASSERT_FALSE_MESSAGE(samples.done, part);
  TEST_ASSERT_NULL(samples.first);
  require_message(samples.message, part);
}

void noted(const Samples& samples, const char* part) {
  TEST_ASSERT_NOT_NULL_MESSAGE(std::strstr(samples.message, part), samples.message);
  TEST_ASSERT_NULL_MESSAGE(std::strchr(samples.message, '\n'), samples.message);
}

}  // namespace

static void test_columns_should_be_found_by_name_among_others() {
  const double gyro[3] = {1, 2, 3}, accel[3] = {4, 5, 6};
  const struct {
    const char *header, *row;
  } cases[] = {
      // rostopic echo -p
      {"%time,field.header.seq,field.header.stamp,field.header.frame_id,field.orientation.x,field.orientation.y,"
       "field.orientation.z,field.orientation.w,field.angular_velocity.x,field.angular_velocity.y,"
       "field.angular_velocity.z,field.angular_velocity_covariance0,field.linear_acceleration.x,"
       "field.linear_acceleration.y,field.linear_acceleration.z",
       "99,7,20,imu,0,0,0,1,1,2,3,0.1,4,5,6"},
      // bagpy
      {"Time,header.stamp.secs,header.stamp.nsecs,angular_velocity.x,angular_velocity.y,angular_velocity.z,"
       "linear_acceleration.x,linear_acceleration.y,linear_acceleration.z",
       "1.5,0,20,1,2,3,4,5,6"},
      // MARS logger
      {"Timestamp[nanosec],gx[rad/s],gy[rad/s],gz[rad/s],ax[m/s^2],ay[m/s^2],az[m/s^2],Unix time[nanosec]",
       "20,1,2,3,4,5,6,1700000000000000000"},
      // Stray Scanner: its alpha is a rate
      {"timestamp_ns, a_x, a_y, a_z, alpha_x, alpha_y, alpha_z", "20,4,5,6,1,2,3"},
      // UZH-FPV
      {"# id timestamp_ns ang_vel_x ang_vel_y ang_vel_z lin_acc_x lin_acc_y lin_acc_z", "0 20 1 2 3 4 5 6"},
      {"temperature;imu_gyro_z;imu_gyro_y;imu_gyro_x;t [ns];imu_acc_x;imu_acc_y;imu_acc_z", "31,5;3;2;1;20;4;5;6"},
      {"#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],a_RS_S_x [m s^-2],a_RS_S_y [m "
       "s^-2],a_RS_S_z [m s^-2],baro",
       "20,1,2,3,4,5,6,7"},
  };
  for (const auto& c : cases) {
    require_sample(Samples::of_text(std::string(c.header) + "\n" + c.row + "\n"), 0, 20, gyro, accel);
  }
}

static void test_units_should_be_those_of_the_header() {
  const double gyro[3] = {kDegree, 2 * kDegree, 3 * kDegree}, accel[3] = {kG, 2 * kG, 3 * kG};
  for (const char* header : {"time [us],gyro_x [deg/s],gyro_y [deg/s],gyro_z [deg/s],acc_x [g],acc_y [g],acc_z [g]",
                             "timestamp_us,gyro_x_dps,gyro_y_dps,gyro_z_dps,accel_x_g,accel_y_g,accel_z_g",
                             "t (microsec),wx (\xc2\xb0/s),wy (\xc2\xb0/s),wz (\xc2\xb0/s),ax (G),ay (G),az (G)",
                             "time_us,gyro_x [deg/s],gyro_y,gyro_z,gFx,gFy,gFz"}) {
    const Samples samples = Samples::of_text(std::string(header) + "\n20,1,2,3,1,2,3\n");
    require_sample(samples, 0, 20000, gyro, accel);
    noted(samples, "rad/s");
    noted(samples, "m/s^2");
  }
  const double plain_gyro[3] = {1e-3, 2e-3, 3e-3}, plain_accel[3] = {1, 2, 3};
  require_sample(Samples::of_text("time [ms],wx [mrad/s],wy [mrad/s],wz [mrad/s],ax [m/s\xc2\xb2],ay [m/s\xc2\xb2],az "
                                  "[m/s\xc2\xb2]\n20,1,2,3,1,2,3\n"),
                 0, 20000000, plain_gyro, plain_accel);
}

static void test_accelerations_of_ios_should_have_the_sign_of_a_specific_force() {
  const double gyro[3] = {1, 2, 3}, accel[3] = {0, -0.1 * kG, 1.0 * kG};
  const Samples raw = Samples::of_text(
      "loggingTime(txt),loggingSample(N),accelerometerTimestamp_sinceReboot(s),accelerometerAccelerationX(G),"
      "accelerometerAccelerationY(G),accelerometerAccelerationZ(G),gyroTimestamp_sinceReboot(s),gyroRotationX(rad/s),"
      "gyroRotationY(rad/s),gyroRotationZ(rad/s)\n2020-05-03 10:00:00.000 +0200,1,7.001,0,0.1,-1,7.002,1,2,3\n");
  require_sample(raw, 0, 7002000000, gyro, accel);
  noted(raw, "sign of iOS");
  const Samples fused = Samples::of_text(
      "motionTimestamp_sinceReboot(s),motionRotationRateX(rad/s),motionRotationRateY(rad/s),motionRotationRateZ(rad/s),"
      "motionUserAccelerationX(G),motionUserAccelerationY(G),motionUserAccelerationZ(G),motionGravityX(G),"
      "motionGravityY(G),motionGravityZ(G)\n7.5,1,2,3,0,0.05,-0.1,0,0.05,-0.9\n");
  require_sample(fused, 0, 7500000000, gyro, accel);
  noted(fused, "gravity is added");
  // Names of Core Motion itself, and its log with a date alone.
  const Samples plain = Samples::of_text(
      "loggingTime,rotationRateX,rotationRateY,rotationRateZ,userAccelerationX,userAccelerationY,userAccelerationZ,"
      "gravityX,"
      "gravityY,gravityZ\n1970-01-01 02:00:07.500 +0200,1,2,3,0,0.05,-0.1,0,0.05,-0.9\n");
  require_sample(plain, 0, 7500000000, gyro, accel);
  noted(plain, "sign of iOS");
}

static void test_android_loggers_should_be_read() {
  const double gyro[3] = {0.5, 2, 3}, accel[3] = {4, 5, 9.75};
  require_sample(
      Samples::of_text(
          "ACCELEROMETER X (m/s\xc2\xb2);ACCELEROMETER Y (m/s\xc2\xb2);ACCELEROMETER Z (m/s\xc2\xb2);GRAVITY X "
          "(m/s\xc2\xb2);GRAVITY Y (m/s\xc2\xb2);GRAVITY Z (m/s\xc2\xb2);LINEAR ACCELERATION X "
          "(m/s\xc2\xb2);LINEAR ACCELERATION Y (m/s\xc2\xb2);LINEAR ACCELERATION Z (m/s\xc2\xb2);GYROSCOPE X "
          "(rad/s);GYROSCOPE Y (rad/s);GYROSCOPE Z (rad/s);MAGNETIC FIELD X (\xce\xbcT);Time since start in ms "
          ";YYYY-MO-DD HH-MI-SS_SSS\n4;5;9,75;0;0;9;0;0;1;0,5;2;3;7;20;2015-08-17 12:00:00:000\n"),
      0, 20000000, gyro, accel);
}

static void test_whole_accelerations_should_come_before_those_without_gravity() {
  const double gyro[3] = {1, 2, 3}, accel[3] = {4, 5, 6};
  require_sample(Samples::of_text(
                     "time_ns,Accelerometer_x,Accelerometer_y,Accelerometer_z,TotalAcceleration_x,TotalAcceleration_y,"
                     "TotalAcceleration_z,Gyroscope_z,Gyroscope_y,Gyroscope_x\n20,9,9,9,4,5,6,3,2,1\n"),
                 0, 20, gyro, accel);
}

static void test_names_should_be_refused_that_do_not_say_enough() {
  const auto text = [](const char* header, const char* row) {
    return Samples::of_text(std::string(header) + "\n" + row + "\n");
  };
  refused(text("time,gx,gy,gz", "1,2,3,4"), "rates and no accelerations; write both files");
  refused(text("time,ax,ay,az", "1,2,3,4"), "accelerations and no rates");
  refused(text("time,a,b,c,d,e,f,g", "1,2,3,4,5,6,7,8"), "'a', 'b'");
  refused(text("time,ax,ay,az,gx,gy,grz", "1,2,3,4,5,6,7"), "'grz'");
  refused(text("gx,gy,gz,ax,ay,az,temperature", "1,2,3,4,5,6,7"), "no column of times");
  refused(text("time,gx [rpm],gy [rpm],gz [rpm],ax,ay,az", "1,2,3,4,5,6,7"),
          "'gx [rpm]' is not known; rad/s and deg/s");
  refused(text("time,gx,gy,gz,ax [ft/s2],ay,az", "1,2,3,4,5,6,7"), "'ax [ft/s2]' is not known; m/s^2");
  refused(text("time,gx [rad/s],gy [deg/s],gz [rad/s],ax,ay,az", "1,2,3,4,5,6,7"), "different units");
  refused(text("time,gx,gy,gz,gx,ax,ay,az", "1,2,3,4,5,6,7,8"), "more than one column like 'gx'");
  refused(text("t,gx,gy,gz,userAccelX,userAccelY,userAccelZ", "1,2,3,4,5,6,7"), "'userAccelX' is without gravity");
  refused(text("t,gx,gy,gz,ax,ay,az,temp", "1,2,3,4,5,6,7"), "line 2: expected 8 columns, as its header has, found 7");
  refused(text("t,gx,gy,gz,ax,ay,az,temp", "1,2,3,4,5,up,7,8"), "line 2: 'up' is not a number ('ay')");
  refused(text("t,gx,gy,gz,ax,ay,az,temp", "1,2,,4,5,6,7,8"), "line 2: 'gy' is empty");
  refused(Samples::of_text("1,2,3,4,5,6,7,8\n"), "8 columns; name them in a first row");
}

static void test_samples_should_be_put_in_order_within_50_ms_and_repeated_ones_passed_over() {
  std::string text;
  for (const int ms : {100, 110, 140, 120, 130, 150, 160, 160, 170, 125}) {
    text += std::to_string(ms) + "000000,0,0,0,0,0," + std::to_string(ms) + "\n";
  }
  const Samples samples = Samples::of_text(text);
  TEST_ASSERT_TRUE_MESSAGE(samples.done, samples.message);
  const int expected[] = {100, 110, 120, 125, 130, 140, 150, 160, 170};
  TEST_ASSERT_EQUAL_size_t(9, samples.count);
  for (size_t i = 0; i < samples.count; ++i) {
    TEST_ASSERT_EQUAL_INT64(expected[i] * INT64_C(1000000), samples.first[i].t_ns);
    TEST_ASSERT_SAME(static_cast<double>(expected[i]), samples.first[i].accel[2]);
  }
  noted(samples, "3 samples were up to 45 ms late");
  noted(samples, "1 sample repeats");
  refused(Samples::of_text(text + "119000000,0,0,0,0,0,1\n"),
          "line 11: the time 119000000 (column 1) runs back by 0.051 s");
  refused(Samples::of_text("0,0,0,0,0,0,1\n-9100000000000000000,0,0,0,0,0,1\n"), "runs back");
}

static void test_a_clock_that_stands_still_should_be_refused_and_equal_rows_passed_over() {
  const std::string row = "10,1,2,3,4,5,6\n";
  const Samples equal = Samples::of_text(row + row + row + row + "20,1,2,3,4,5,6\n");
  TEST_ASSERT_TRUE_MESSAGE(equal.done, equal.message);
  TEST_ASSERT_EQUAL_size_t(2, equal.count);
  noted(equal, "3 samples repeat");
  refused(Samples::of_text(row + "10,1,2,3,4,5,7\n10,1,2,3,4,5,8\n"), "line 3: the time 10 (column 1) repeats");
}

namespace {

/// 100 rates at 100 Hz and accelerations between them; the value of each is its time [s].
void write_pair(const TemporaryFolder& folder, const char* gyro, const char* accel, const std::string& gyro_header,
                const std::string& accel_header) {
  std::string rates = gyro_header, accelerations = accel_header;
  for (int i = 0; i < 100; ++i) {
    char line[120];
    std::snprintf(line, sizeof(line), "%.4f,%.4f,0,1\n", 0.01 * i, 0.01 * i);
    rates += line;
    std::snprintf(line, sizeof(line), "%.4f,%.4f,0,9.8\n", 0.01 * i + 0.004, 0.01 * i + 0.004);
    accelerations += line;
  }
  folder.write(gyro, rates);
  folder.write(accel, accelerations);
}

void require_joined(const Samples& samples) {
  TEST_ASSERT_TRUE_MESSAGE(samples.done, samples.message);
  TEST_ASSERT_EQUAL_size_t(99, samples.count);  // the first rate is before all accelerations
  noted(samples, "1 of 100 rates");
  for (size_t i = 0; i < samples.count; ++i) {
    const double t = 1e-9 * static_cast<double>(samples.first[i].t_ns);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, t, samples.first[i].gyro[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, t, samples.first[i].accel[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 9.8, samples.first[i].accel[2]);
  }
}

}  // namespace

static void test_two_files_should_be_joined_at_the_times_of_the_rates() {
  const TemporaryFolder folder;
  write_pair(folder, "Gyroscope.csv", "Accelerometer.csv",
             "\"Time (s)\",\"Gyroscope x (rad/s)\",\"Gyroscope y (rad/s)\",\"Gyroscope z (rad/s)\"\n",
             "\"Time (s)\",\"Acceleration x (m/s^2)\",\"Acceleration y (m/s^2)\",\"Acceleration z (m/s^2)\"\n");
  require_joined(Samples::of_path(folder.path()));
  require_joined(Samples::of_path((folder / "Gyroscope.csv") + "+" + (folder / "Accelerometer.csv")));
  refused(Samples::of_path(folder / "Gyroscope.csv"), "rates and no accelerations");
  const TemporaryFolder plain;
  write_pair(plain, "gyro+1.txt", "acc.txt", "", "");
  require_joined(Samples::of_path((plain / "gyro+1.txt") + "+" + (plain / "acc.txt")));
  refused(Samples::of_path((plain / "gyro+1.txt") + "+" + (plain / "none.txt")), "none.txt");
  const TemporaryFolder empty;
  refused(Samples::of_path(empty.path()), "Gyroscope.csv");
  const TemporaryFolder apart;
  apart.write("gyro.csv", "1,0,0,0\n2,0,0,0\n");
  apart.write("accel.csv", "5,0,0,0\n6,0,0,0\n");
  refused(Samples::of_path(apart.path()), "no time in common");
}

static void test_a_folder_of_sensor_logger_should_be_read_with_gravity() {
  const TemporaryFolder folder;
  const std::string header = "time,seconds_elapsed,z,y,x\n";
  folder.write("Gyroscope.csv", header + "1700000000000000000,0.1,3,2,1\n1700000000010000000,0.11,3,2,1\n");
  folder.write("Accelerometer.csv", header + "1700000000000000000,0.1,0.5,0,0\n1700000000010000000,0.11,0.5,0,0\n");
  folder.write("Metadata.csv", "version,platform\n3,android\n");
  refused(Samples::of_path(folder.path()), "without gravity");
  folder.write("Gravity.csv", header + "1700000000000000000,0.1,9.5,1,0\n1700000000010000000,0.11,9.5,1,0\n");
  const double gyro[3] = {1, 2, 3}, accel[3] = {0, 1, 10};
  require_sample(Samples::of_path(folder.path()), 1, 1700000000010000000, gyro, accel);
  folder.write("TotalAcceleration.csv", header + "1700000000000000000,0.1,10,1,0\n1700000000010000000,0.11,10,1,0\n");
  const Samples total = Samples::of_path(folder.path());
  require_sample(total, 1, 1700000000010000000, gyro, accel);
  noted(total, "TotalAcceleration.csv");
}

static void test_columns_of_open_camera_sensors_should_be_read_with_the_time_last() {
  const TemporaryFolder folder;
  folder.write("VID_1_gyro.csv", "1,2,3,1000\n0.5,2,3,11000\n1,2,3,21000\n");
  folder.write("VID_1_accel.csv", "4,5,6,1000\n2,5,6,11000\n4,5,6,21000\n");
  const double gyro[3] = {0.5, 2, 3}, accel[3] = {2, 5, 6};
  require_sample(Samples::of_path(folder.path()), 1, 11000, gyro, accel);
}

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_columns_should_be_found_by_name_among_others);
  RUN_TEST(test_units_should_be_those_of_the_header);
  RUN_TEST(test_accelerations_of_ios_should_have_the_sign_of_a_specific_force);
  RUN_TEST(test_android_loggers_should_be_read);
  RUN_TEST(test_whole_accelerations_should_come_before_those_without_gravity);
  RUN_TEST(test_names_should_be_refused_that_do_not_say_enough);
  RUN_TEST(test_samples_should_be_put_in_order_within_50_ms_and_repeated_ones_passed_over);
  RUN_TEST(test_a_clock_that_stands_still_should_be_refused_and_equal_rows_passed_over);
  RUN_TEST(test_two_files_should_be_joined_at_the_times_of_the_rates);
  RUN_TEST(test_a_folder_of_sensor_logger_should_be_read_with_gravity);
  RUN_TEST(test_columns_of_open_camera_sensors_should_be_read_with_the_time_last);
  return UNITY_END();
}

#else

int main() { SKIP_PROGRAM("this build has no platform layer"); }

#endif
