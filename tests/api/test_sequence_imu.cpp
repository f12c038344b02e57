// Inertial samples in files: what is read, exactly, and everything that can be wrong with them.
#include "same.h"
#include "skip.h"

#if __has_include(<planefold_platform/sequence.h>)

#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <utility>

#include "sequence_test.h"

using namespace pf::test;

void setUp() {}
void tearDown() {}

namespace {

struct Parsed {
  explicit Parsed(const std::string& text) {
    done = pf_parse_imu(text.data(), text.size(), "some.csv", &samples, &count, message) == 0;
  }
  ~Parsed() { pf_free_imu(samples); }
  Parsed(const Parsed&) = delete;
  Parsed& operator=(const Parsed&) = delete;

  bool done = false;
  pf_imu_sample_t* samples = nullptr;
  size_t count = 0;
  char message[PF_SEQUENCE_MESSAGE] = "";
};

void refused(const std::string& text, const char* part) {
  const Parsed parsed(text);
  TEST_ASSERT_FALSE_MESSAGE(parsed.done, text.c_str());
  TEST_ASSERT_NULL(parsed.samples);
  require_message(parsed.message, "some.csv");
  require_message(parsed.message, part);
}

}  // namespace

static void test_rows_should_be_read_to_the_last_digit_when_times_are_nanoseconds() {
  const Parsed parsed(
      "#timestamp [ns],w_RS_S_x [rad s^-1],w_y,w_z,a_x,a_y,a_z\r\n"
      "1403636579758555392,-0.099134701513277898,0.14730578886832138,0.02722713633111154,8.1476917083333333,"
      "-0.37592158333333331,-2.4026292499999999\r\n"
      "\n1403636579763555584,1,2,3,4,5,6e-1\n");
  TEST_ASSERT_TRUE_MESSAGE(parsed.done, parsed.message);
  TEST_ASSERT_EQUAL_size_t(2, parsed.count);
  TEST_ASSERT_EQUAL_INT64(1403636579758555392, parsed.samples[0].t_ns);
  TEST_ASSERT_SAME(-0.099134701513277898, parsed.samples[0].gyro[0]);
  TEST_ASSERT_SAME(-2.4026292499999999, parsed.samples[0].accel[2]);
  TEST_ASSERT_EQUAL_INT64(1403636579763555584, parsed.samples[1].t_ns);
  TEST_ASSERT_SAME(3.0, parsed.samples[1].gyro[2]);
  TEST_ASSERT_SAME(4.0, parsed.samples[1].accel[0]);
  TEST_ASSERT_SAME(0.6, parsed.samples[1].accel[2]);
}

static void test_times_should_be_seconds_when_a_row_has_a_decimal_point() {
  const Parsed parsed("#t[s]\n1,0,0,0,0,0,9.8\n1.005 0 0 0 0 0 9.8\n");
  TEST_ASSERT_TRUE_MESSAGE(parsed.done, parsed.message);
  TEST_ASSERT_EQUAL_INT64(1000000000, parsed.samples[0].t_ns);
  TEST_ASSERT_EQUAL_INT64(1005000000, parsed.samples[1].t_ns);
}

static void test_samples_should_be_read_with_marks_and_in_the_order_of_a_header() {
  const Parsed marked("\xef\xbb\xbf\"10\",1,2,3,4,5,6\r20, 1 , 2 ,3,4,5,6,\n");
  TEST_ASSERT_TRUE_MESSAGE(marked.done, marked.message);
  TEST_ASSERT_EQUAL_INT64(20, marked.samples[1].t_ns);
  for (const char* header :
       {"timestamp,accel_x,accel_y,accel_z,gyro_x,gyro_y,gyro_z\n", "#t [ns], ax, ay, az, wx, wy, wz\n",
        "# time;a_x;a_y;a_z;angular_velocity_x;angular_velocity_y;angular_velocity_z\n"}) {
    const Parsed swapped(std::string(header) + "10,4,5,6,1,2,3\n20,4,5,6,1,2,3\n");
    TEST_ASSERT_TRUE_MESSAGE(swapped.done, swapped.message);
    TEST_ASSERT_SAME(1.0, swapped.samples[1].gyro[0]);
    TEST_ASSERT_SAME(3.0, swapped.samples[1].gyro[2]);
    TEST_ASSERT_SAME(4.0, swapped.samples[1].accel[0]);
    TEST_ASSERT_SAME(6.0, swapped.samples[1].accel[2]);
  }
}

static void test_units_of_times_should_be_recognised_by_the_rate_with_a_note() {
  const struct {
    double step;
    const char *form, *taken;
  } cases[] = {{5e6, "%.0f", ""},
               {5e3, "%.0f", "microseconds (200 Hz)"},
               {5, "%.0f", "milliseconds (200 Hz)"},
               {0.005, "%.3f", ""},
               {5, "%.1f", "milliseconds (200 Hz)"}};
  for (const auto& c : cases) {
    std::string text;
    for (int i = 0; i < 50; ++i) {
      char time[40];
      std::snprintf(time, sizeof(time), c.form, 1000.0 * c.step + i * c.step);
      text += std::string(time) + ",0,0,0,0,0,9.8\n";
    }
    const Parsed parsed(text);
    TEST_ASSERT_TRUE_MESSAGE(parsed.done, parsed.message);
    TEST_ASSERT_EQUAL_INT64(5000000, parsed.samples[1].t_ns - parsed.samples[0].t_ns);
    TEST_ASSERT_NOT_NULL_MESSAGE(std::strstr(parsed.message, c.taken), parsed.message);
    TEST_ASSERT_EQUAL_INT(c.taken[0] == '\0', parsed.message[0] == '\0');
  }
}

static void test_rows_should_be_refused_by_line_when_they_are_wrong() {
  const std::string good = "#\n10,0,0,0,0,0,9.8\n";
  refused(good + "20,0,0,0,0,0\n", "line 3: expected");
  refused(good + "20,0,0,0,0,0,0,0\n", "8 columns");
  refused(good + "20,0,0,0,0,0,up\n", "line 3: 'up' is not a number");
  refused(good + "20,0,0,0,0,0,1.5x\n", "'1.5x'");
  refused(good + "20,nan,0,0,0,0,0\n", "not finite");
  refused(good + "20,0,0,-inf,0,0,0\n", "not finite");
  refused(good + "20,0,0,1e999,0,0,0\n", "line 3");
  refused("100000000,0,0,0,0,0,9.8\n10,0,0,0,0,0,9.8\n", "line 2: the time 10 (column 1) runs back by 0.1 s");
  refused(good + "10,0,0,0,0,0,1\n10,0,0,0,0,0,2\n", "line 4: the time 10 (column 1) repeats");
  refused(good + "soon,0,0,0,0,0,9.8\n", "not a time in whole nanoseconds");
  refused(good + "99999999999999999999,0,0,0,0,0,9.8\n", "not a time");
  refused("0.5,0,0,0,0,0,0\nnan.,0,0,0,0,0,9.8\n", "not a time in seconds");
  refused("# nothing\n", "no sample");
  refused("", "no sample");
  refused(std::string("\0\x01\xff,\n", 5), "line 1");
}

static void test_files_should_be_refused_when_they_are_missing_or_folders() {
  const TemporaryFolder folder;
  pf_imu_sample_t* samples = nullptr;
  size_t count = 0;
  char message[PF_SEQUENCE_MESSAGE] = "";
  TEST_ASSERT_EQUAL_INT(-1, pf_read_imu((folder / "none.csv").c_str(), &samples, &count, message));
  require_message(message, "none.csv");
  TEST_ASSERT_EQUAL_INT(-1, pf_read_imu(folder.path().c_str(), &samples, &count, message));
  TEST_ASSERT_EQUAL_INT(-1, pf_read_imu(nullptr, &samples, &count, message));
  TEST_ASSERT_EQUAL_INT(-1, pf_read_imu("x", nullptr, &count, message));
  TEST_ASSERT_NULL(samples);
  pf_free_imu(nullptr);
}

static void test_sequences_should_name_the_samples_that_lie_beside_the_images() {
  TemporaryFolder folder;
  folder.write("mav0/cam0/sensor.yaml",
               "resolution: [32, 32]\ncamera_model: pinhole\nintrinsics: [30, 30, 16, 16]\nrate_hz: 20\n"
               "distortion_model: radial-tangential\ndistortion_coefficients: [0, 0, 0, 0]\n");
  folder.write("mav0/cam0/data.csv", "1403636579763555584,a.png\n");
  folder.write("mav0/cam0/data/a.png", grey_png(3));
  {
    const Opened without("euroc:" + folder.path());
    TEST_ASSERT_EQUAL_STRING("", without.info.imu_path);
  }
  folder.write("mav0/imu0/data.csv", "1403636579758555392,0,0,0,0,0,9.8\n");
  for (const char* below : {"", "/mav0", "/mav0/cam0"}) {
    const Opened opened("euroc:" + folder.path() + below);
    pf_imu_sample_t* samples = nullptr;
    size_t count = 0;
    char message[PF_SEQUENCE_MESSAGE] = "";
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, pf_read_imu(opened.info.imu_path, &samples, &count, message), message);
    TEST_ASSERT_EQUAL_size_t(1, count);
    pf_free_imu(samples);
  }
}

namespace {

constexpr const char* kKalibrNoise =
    "accelerometer_noise_density: 1.86e-03\naccelerometer_random_walk: 4.33e-04\ngyroscope_noise_density: 1.87e-04\n"
    "gyroscope_random_walk: 2.66e-05\nrostopic: /imu0\nupdate_rate: 200.0\n";

bool read_noise(const std::string& text, pf_imu_model_t* imu, char* message) {
  return pf_parse_imu_noise(text.data(), text.size(), "imu.yaml", imu, message) == 0;
}

bool read_mount(const std::string& text, pf_imu_model_t* imu, char* message) {
  return pf_parse_imu_mount(text.data(), text.size(), "cam.yaml", imu, message) == 0;
}

void noise_refused(const std::string& from, const std::string& to, const char* part) {
  std::string text = kKalibrNoise;
  text.replace(text.find(from), from.size(), to);
  pf_imu_model_t imu{};
  char message[PF_SEQUENCE_MESSAGE] = "";
  TEST_ASSERT_FALSE_MESSAGE(read_noise(text, &imu, message), text.c_str());
  require_message(message, part);
  TEST_ASSERT_SAME(0.0, imu.gyro_density);
  TEST_ASSERT_SAME(0.0, imu.accel_density);
}

void require_mount(const pf_imu_model_t& imu, double delay_s) {
  // A rotation by 90 degrees about z: the camera's x is the unit's y.
  const double q[4] = {std::sqrt(0.5), 0, 0, std::sqrt(0.5)}, p[3] = {0.1, 0.2, 0.3};
  for (int i = 0; i < 4; ++i) TEST_ASSERT_DOUBLE_WITHIN(1e-12, q[i], imu.q_BC[i]);
  for (int i = 0; i < 3; ++i) TEST_ASSERT_DOUBLE_WITHIN(1e-12, p[i], imu.p_BC[i]);
  TEST_ASSERT_DOUBLE_WITHIN(1e-12, delay_s, imu.delay_s);
}

}  // namespace

static void test_noise_should_be_read_from_every_known_form() {
  for (const std::string& text :
       {std::string(kKalibrNoise), "sensor_type: imu\ncomment: x\nrate_hz: 200\n" + std::string(kKalibrNoise),
        std::string("accel_noise_density: 1.86e-03\naccel_random_walk: 4.33e-04\ngyro_noise_density: 1.87e-04\n"
                    "gyro_random_walk: 2.66e-05\nwidth: 752\n"),
        std::string(
            "%YAML:1.0\nFile.version: \"1.0\"\nCamera.type: \"PinHole\"\nCamera1.fx: 458.6\nIMU.NoiseGyro: 1.87e-04\n"
            "IMU.NoiseAcc: 1.86e-03\nIMU.GyroWalk: 2.66e-05\nIMU.AccWalk: 4.33e-04\nIMU.Frequency: 200.0\n"),
        std::string("accelerometer_noise_density = 1.86e-03\naccelerometer_random_walk   = 4.33e-04\n"
                    "gyroscope_noise_density     = 1.87e-04\ngyroscope_random_walk       = 2.66e-05\n"),
        std::string("camera_model: pinhole\ndistortion_model: radtan\ndistortion: [0.1, 0, 0, 0]\nrate_hz: 20\n"
                    "accel_noise_density: 1.86e-03\naccel_random_walk: 4.33e-04\ngyro_noise_density: 1.87e-04\n"
                    "gyro_random_walk: 2.66e-05\n")}) {
    pf_imu_model_t imu{};
    char message[PF_SEQUENCE_MESSAGE] = "";
    TEST_ASSERT_TRUE_MESSAGE(read_noise(text, &imu, message), message);
    TEST_ASSERT_SAME(1.86e-3, imu.accel_density);
    TEST_ASSERT_SAME(4.33e-4, imu.accel_walk);
    TEST_ASSERT_SAME(1.87e-4, imu.gyro_density);
    TEST_ASSERT_SAME(2.66e-5, imu.gyro_walk);
    TEST_ASSERT_SAME(0.0, imu.delay_s);
    TEST_ASSERT_SAME(0.0, imu.q_BC[0]);
  }
}

static void test_noise_should_be_that_of_the_first_unit_with_a_note_when_a_file_has_several() {
  std::string inside;
  for (const char c : std::string(kKalibrNoise)) inside += c == '\n' ? std::string("\n  ") : std::string(1, c);
  const std::string one = "imu0:\n  " + inside + "model: calibrated\n";
  pf_imu_model_t imu{};
  char message[PF_SEQUENCE_MESSAGE] = "";
  TEST_ASSERT_TRUE_MESSAGE(read_noise(one, &imu, message), message);
  TEST_ASSERT_EQUAL_STRING("", message);
  TEST_ASSERT_TRUE_MESSAGE(read_noise(one + "imu1:\n  gyroscope_noise_density: 1e-3\n", &imu, message), message);
  require_message(message, "imu0 is taken");
  TEST_ASSERT_SAME(1.87e-4, imu.gyro_density);
}

static void test_noise_of_imu_utils_should_be_divided_by_the_root_of_its_rate() {
  const std::string text =
      "%YAML:1.0\n---\ntype: IMU\nname: some\nGyr:\n   unit: \" rad/s\"\n   avg-axis:\n      gyr_n: 2.0e-03\n      "
      "gyr_w: 1.5e-05\n"
      "   x-axis:\n      gyr_n: 9.0e-03\n      gyr_w: 9.0e-05\nAcc:\n   unit: \" m/s^2\"\n   avg-axis:\n      acc_n: "
      "2.0e-02\n"
      "      acc_w: 2.5e-04\n";
  pf_imu_model_t imu{};
  char message[PF_SEQUENCE_MESSAGE] = "";
  TEST_ASSERT_TRUE_MESSAGE(read_noise(text + "update_rate: 400\n", &imu, message), message);
  require_message(message, "the root of 400 Hz");
  TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1e-4, imu.gyro_density);
  TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1e-3, imu.accel_density);
  TEST_ASSERT_SAME(1.5e-5, imu.gyro_walk);
  TEST_ASSERT_SAME(2.5e-4, imu.accel_walk);
  TEST_ASSERT_TRUE_MESSAGE(read_noise(text, &imu, message), message);
  require_message(message, "add update_rate");
  TEST_ASSERT_DOUBLE_WITHIN(1e-12, 2e-3 / std::sqrt(200.0), imu.gyro_density);
  TEST_ASSERT_FALSE(read_noise(text + "update_rate: 0\n", &imu, message));
  require_message(message, "'update_rate'");
  TEST_ASSERT_FALSE(read_noise(text.substr(0, text.find("Acc:")), &imu, message));
  require_message(message, "'Acc'");
}

static void test_noise_should_be_refused_with_what_to_give_when_a_file_has_none() {
  for (const auto& [text, part] :
       {std::pair<const char*, const char*>{"acc_n: 0.1\ngyr_n: 0.01\nacc_w: 0.001\ngyr_w: 1e-4\n", "by hand"},
        {"rate: 200\n", "IMU.NoiseGyro (ORB-SLAM3)"},
        {"IMU configuration\n  Accelerometer:\n    Noise density: 0.01\n    Noise density (discrete): 0.1\n",
         "-imu.yaml"}}) {
    pf_imu_model_t imu{};
    char message[PF_SEQUENCE_MESSAGE] = "";
    TEST_ASSERT_FALSE_MESSAGE(read_noise(text, &imu, message), text);
    require_message(message, part);
  }
}

static void test_gravity_should_be_read_from_the_noise_of_a_unit() {
  const std::string plain =
      "accel_noise_density: 1.86e-03\naccel_random_walk: 4.33e-04\ngyro_noise_density: 1.87e-04\n"
      "gyro_random_walk: 2.66e-05\nwidth: 752\n";
  for (const std::string& text : {std::string(kKalibrNoise), plain}) {
    pf_imu_model_t imu{};
    char message[PF_SEQUENCE_MESSAGE] = "";
    imu.gravity = 9.81;
    TEST_ASSERT_TRUE_MESSAGE(read_noise(text, &imu, message), message);
    TEST_ASSERT_SAME(9.81, imu.gravity);
    TEST_ASSERT_TRUE_MESSAGE(read_noise(text + "gravity: 9.7801\n", &imu, message), message);
    TEST_ASSERT_SAME(9.7801, imu.gravity);
    TEST_ASSERT_EQUAL_STRING("", message);
    for (const char* wrong :
         {"gravity: 1\n", "gravity: 11.5\n", "gravity: .nan\n", "gravity: [0, 0, 9.81]\n", "gravtiy: 9.8\n"}) {
      TEST_ASSERT_FALSE_MESSAGE(read_noise(text + wrong, &imu, message), wrong);
      require_message(message, "'grav");
      TEST_ASSERT_SAME(9.7801, imu.gravity);
    }
  }
}

static void test_noise_should_be_refused_when_a_field_is_missing_or_in_other_units() {
  noise_refused("gyroscope_noise_density: 1.87e-04\n", "", "gyroscope_noise_density");
  noise_refused("1.87e-04", "1.87e-02", "degrees");
  noise_refused("1.87e-04", "1.87e-06", "gyroscope_noise_density");
  noise_refused("1.86e-03", "1.86", "accelerometer_noise_density");
  noise_refused("1.86e-03", "1.86e-05", "accelerometer_noise_density");
  noise_refused("2.66e-05", "nan", "finite");
  noise_refused("gyroscope_random_walk", "gyroscope_random_wlak", "meant");
}

static void test_mounting_should_be_the_same_in_every_known_form() {
  const std::string in_rows = "[0, -1, 0, 0.1, 1, 0, 0, 0.2, 0, 0, 1, 0.3, 0, 0, 0, 1]";
  const std::string euroc = "sensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: " + in_rows + "\n";
  const std::string kalibr =
      "cam0:\n  T_cam_imu:\n  - [0, 1, 0, -0.2]\n  - [-1, 0, 0, 0.1]\n  - [0, 0, 1, -0.3]\n  - [0, 0, 0, 1]\n"
      "  timeshift_cam_imu: 0.004\n";
  for (const auto& [text, delay_s] :
       {std::pair<std::string, double>{euroc, 0.0}, {kalibr, -0.004}, {"T_imu_cam: " + in_rows + "\n", 0.0}}) {
    pf_imu_model_t imu{};
    char message[PF_SEQUENCE_MESSAGE] = "";
    TEST_ASSERT_TRUE_MESSAGE(read_mount(text, &imu, message), message);
    require_mount(imu, delay_s);
  }
}

static void test_mounting_should_be_read_in_the_forms_of_other_programs() {
  const std::string to_imu = "[0, -1, 0, 0.1], [1, 0, 0, 0.2], [0, 0, 1, 0.3], [0, 0, 0, 1]";
  const std::string in_rows = "[0, -1, 0, 0.1, 1, 0, 0, 0.2, 0, 0, 1, 0.3, 0, 0, 0, 1]";
  const std::string opencv = " !!opencv-matrix\n   rows: 4\n   cols: 4\n   dt: d\n   data: " + in_rows + "\n";
  const std::string openvins = "%YAML:1.0\n\ncam0:\n  T_imu_cam: [" + to_imu + "]\n  timeshift_cam_imu: 0.004\n";
  const std::string other = "cam1:\n  T_imu_cam: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n";
  const std::string parts =
      "%YAML:1.0\nestimate_extrinsic: 0\nextrinsicRotation: [0, -1, 0, 1, 0, 0, 0, 0, 1]\nextrinsicTranslation: [0.1, "
      "0.2, 0.3]\ntd: -0.002\n";
  const std::string both =
      "cam0:\n  T_imu_cam: [" + to_imu +
      "]\n  T_cam_imu:\n  - [0, 1, 0, -0.2]\n  - [-1, 0, 0, 0.1]\n  - [0, 0, 1, -0.3]\n  - [0, 0, 0, 1]\n";
  for (const auto& [text, delay_s] : {std::pair<std::string, double>{openvins, -0.004},
                                      {"T_imu_cam: [" + to_imu + "]\n", 0.0},
                                      {parts, 0.002},
                                      {"%YAML:1.0\nbody_T_cam0:" + opencv + "td: 0.01\n", -0.01},
                                      {"%YAML:1.0\nTbc:" + opencv, 0.0},
                                      {"%YAML:1.0\nIMU.T_b_c1:" + opencv, 0.0},
                                      {"T_cam_imu: [0, 1, 0, -0.2, -1, 0, 0, 0.1, 0, 0, 1, -0.3, 0, 0, 0, 1]\n", 0.0},
                                      {both, 0.0}}) {
    pf_imu_model_t imu{};
    char message[PF_SEQUENCE_MESSAGE] = "";
    TEST_ASSERT_TRUE_MESSAGE(read_mount(text, &imu, message), message);
    TEST_ASSERT_EQUAL_STRING("", message);
    require_mount(imu, delay_s);
  }
  // Of several cameras.
  pf_imu_model_t imu{};
  char message[PF_SEQUENCE_MESSAGE] = "";
  TEST_ASSERT_TRUE_MESSAGE(read_mount(openvins + other, &imu, message), message);
  require_message(message, "cam0 and cam1");
  require_mount(imu, -0.004);
  const std::string text = other + "cam2" + openvins.substr(openvins.find("cam0") + 4);
  for (const char* camera : {"cam2", "2"}) {
    pf_parse_imu_mount_of(text.data(), text.size(), "cam.yaml", camera, &imu, message);
    require_mount(imu, -0.004);
  }
}

static void test_mounting_should_be_refused_when_two_fields_of_it_differ() {
  const auto refused_mount = [](const std::string& text, const char* part) {
    pf_imu_model_t imu{};
    char message[PF_SEQUENCE_MESSAGE] = "";
    TEST_ASSERT_FALSE_MESSAGE(read_mount(text, &imu, message), text.c_str());
    require_message(message, part);
  };
  const std::string there = "[0, -1, 0, 0.1, 1, 0, 0, 0.2, 0, 0, 1, 0.3, 0, 0, 0, 1]\n";
  refused_mount("T_imu_cam: " + there + "T_cam_imu: " + there, "different mountings");
  refused_mount("T_imu_cam: [[1, 0, 0, 0, 0, 1, 0, 0], [0, 0, 1, 0, 0, 0, 0, 1]]\n", "in every row");
  refused_mount("T_cam_to_imu: " + there, "T_cam_imu (Kalibr)");
  refused_mount(
      "extrinsicRotation: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nextrinsicTranslation: [0, 0, 0]\nestimate_extrinsic: 2\n",
      "'estimate_extrinsic'");
  refused_mount("T_imu_cam: " + there + "timeshift_cam_imu: 4\n", "'timeshift_cam_imu'");
}

static void test_mounting_should_be_refused_when_it_is_no_rotation_or_nowhere() {
  const auto refused_mount = [](const std::string& text, const char* part) {
    pf_imu_model_t imu{};
    char message[PF_SEQUENCE_MESSAGE] = "";
    TEST_ASSERT_FALSE_MESSAGE(read_mount(text, &imu, message), text.c_str());
    require_message(message, part);
  };
  refused_mount("width: 3\n", "T_BS");
  refused_mount("T_imu_cam: [1, 0, 0]\n", "4 x 4");
  refused_mount("T_imu_cam: [1,0,0,0, 0,1,0,0, 0,0,-1,0, 0,0,0,1]\n", "rotation");
  refused_mount("T_imu_cam: [1,0,0,0, 0,1.1,0,0, 0,0,1,0, 0,0,0,1]\n", "rotation");
  refused_mount("T_imu_cam: [1,0,0,60, 0,1,0,0, 0,0,1,0, 0,0,0,1]\n", "metres");
  refused_mount("T_imu_cam: [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,2]\n", "last row");
  refused_mount("sensor_type: imu\nT_BS: {data: [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}\n", "cam0");
  refused_mount("T_cam_imu: [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]\ntimeshift_cam_imu: 2\n", "timeshift");
}

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_noise_should_be_read_from_every_known_form);
  RUN_TEST(test_noise_should_be_that_of_the_first_unit_with_a_note_when_a_file_has_several);
  RUN_TEST(test_noise_of_imu_utils_should_be_divided_by_the_root_of_its_rate);
  RUN_TEST(test_noise_should_be_refused_with_what_to_give_when_a_file_has_none);
  RUN_TEST(test_gravity_should_be_read_from_the_noise_of_a_unit);
  RUN_TEST(test_noise_should_be_refused_when_a_field_is_missing_or_in_other_units);
  RUN_TEST(test_mounting_should_be_the_same_in_every_known_form);
  RUN_TEST(test_mounting_should_be_read_in_the_forms_of_other_programs);
  RUN_TEST(test_mounting_should_be_refused_when_two_fields_of_it_differ);
  RUN_TEST(test_mounting_should_be_refused_when_it_is_no_rotation_or_nowhere);
  RUN_TEST(test_rows_should_be_read_to_the_last_digit_when_times_are_nanoseconds);
  RUN_TEST(test_times_should_be_seconds_when_a_row_has_a_decimal_point);
  RUN_TEST(test_samples_should_be_read_with_marks_and_in_the_order_of_a_header);
  RUN_TEST(test_units_of_times_should_be_recognised_by_the_rate_with_a_note);
  RUN_TEST(test_rows_should_be_refused_by_line_when_they_are_wrong);
  RUN_TEST(test_files_should_be_refused_when_they_are_missing_or_folders);
  RUN_TEST(test_sequences_should_name_the_samples_that_lie_beside_the_images);
  return UNITY_END();
}

#else

int main() { SKIP_PROGRAM("this build has no platform layer"); }

#endif
