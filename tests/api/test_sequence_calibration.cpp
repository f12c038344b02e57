// The calibration reader: every form, and every field that can be wrong.
#include "skip.h"

#if __has_include(<planefold_platform/sequence.h>)

#include <cmath>

#include "sequence_test.h"

using namespace pf::test;

void setUp() {}
void tearDown() {}

namespace {

const char* const kKalibr =
    "cam0:\n  cam_overlaps: []\n  camera_model: pinhole\n  distortion_coeffs: [-0.28, 0.07, 0.0002, 1.8e-05]\n"
    "  distortion_model: radtan\n  intrinsics: [458.654, 457.296, 367.215, 248.375]\n  resolution: [752, 480]\n"
    "  rostopic: /cam0/image_raw\n";
const char* const kEuroc =
    "sensor_type: camera\ncomment: VI-Sensor cam0\nT_BS:\n  cols: 4\n  rows: 4\n  data: [1.0, 0.0, 0.0, 0.0]\nrate_hz: "
    "20\n"
    "resolution: [752, 480]\ncamera_model: pinhole\nintrinsics: [458.654, 457.296, 367.215, 248.375]\n"
    "distortion_model: radial-tangential\ndistortion_coefficients: [-0.28340811, 0.07395907, 0.00019359, "
    "1.76187114e-05]\n";
const char* const kRos =
    "image_width: 640\nimage_height: 480\ncamera_name: usb\ncamera_matrix:\n  rows: 3\n  cols: 3\n"
    "  data: [500, 0, 320, 0, 501, 240, 0, 0, 1]\ndistortion_model: plumb_bob\ndistortion_coefficients:\n  rows: 1\n  "
    "cols: 5\n"
    "  data: [0.1, -0.2, 0.001, 0.002, 0.05]\n";

const char* const kOrbSlam3 =
    "%YAML:1.0\n\n#----\n# Camera Parameters\n#----\nFile.version: \"1.0\"\n\nCamera.type: \"PinHole\"\n\n"
    "Camera1.fx: 458.654\nCamera1.fy: 457.296\nCamera1.cx: 367.215\nCamera1.cy: 248.375\n"
    "Camera1.k1: -0.28340811\nCamera1.k2: 0.07395907\nCamera1.p1: 0.00019359\nCamera1.p2: 1.76187114e-05\n"
    "Camera2.fx: 457.587\nCamera.width: 752\nCamera.height: 480\nCamera.newWidth: 600\nCamera.newHeight: 350\n"
    "Camera.fps: 20\nCamera.RGB: 1\nStereo.ThDepth: 60.0\nStereo.T_c1_c2: !!opencv-matrix\n  rows: 4\n  cols: 4\n"
    "  dt: f\n  data: [1.0,0,0,0.1,\n         0,1.0,0,0,\n         0,0,1.0,0,\n         0,0,0,1.000000000000000]\n"
    "IMU.NoiseGyro: 1.7e-04\nORBextractor.nFeatures: 1200\nViewer.KeyFrameSize: 0.05\nSystem.thFarPoints: 20.0\n";
const char* const kOrbSlam =
    "%YAML:1.0\n---\nCamera.fx: 517.306408\nCamera.fy: 516.469215\nCamera.cx: 318.643040\nCamera.cy: 255.313989\n"
    "Camera.k1: 0.262383\nCamera.k2: -0.953104\nCamera.p1: -0.005358\nCamera.p2: 0.002628\nCamera.k3: 1.163314\n"
    "Camera.width: 640\nCamera.height: 480\nCamera.fps: 30.0\nCamera.bf: 40.0\nCamera.RGB: 1\nThDepth: 40.0\n"
    "DepthMapFactor: 5000.0\nORBextractor.nLevels: 8\nViewer.PointSize:2\n";
const char* const kKitti =
    "P0: 7.188560000000e+02 0.000000000000e+00 6.071928000000e+02 0.000000000000e+00 0.000000000000e+00 "
    "7.188560000000e+02 "
    "1.852157000000e+02 0.000000000000e+00 0.000000000000e+00 0.000000000000e+00 1.000000000000e+00 "
    "0.000000000000e+00\n"
    "P1: 7.188560000000e+02 0 6.071928000000e+02 -3.861448000000e+02 0 7.188560000000e+02 1.852157000000e+02 0 0 0 1 "
    "0\n"
    "Tr: 4.27e-04 -9.99e-01 -8.08e-03 -1.19e-02 -7.21e-03 8.08e-03 -9.99e-01 -5.40e-02 9.99e-01 4.85e-04 -7.20e-03 "
    "-0.29\n";

pf_camera_t read(const std::string& text) {
  pf_camera_t camera;
  char message[PF_SEQUENCE_MESSAGE];
  TEST_ASSERT_EQUAL_INT_MESSAGE(0, pf_parse_calibration(text.data(), text.size(), "c.yaml", &camera, nullptr, message),
                                message);
  return camera;
}

/// Replaces the first occurrence; the text must have it.
std::string with(std::string text, const std::string& from, const std::string& to) {
  const size_t at = text.find(from);
  TEST_ASSERT_TRUE_MESSAGE(at != std::string::npos, from.c_str());
  return text.replace(at, from.size(), to);
}

void refused(const std::string& text, const std::string& field) {
  pf_camera_t camera;
  std::memset(&camera, 7, sizeof(camera));
  const pf_camera_t before = camera;
  char message[PF_SEQUENCE_MESSAGE];
  TEST_ASSERT_EQUAL_INT_MESSAGE(-1, pf_parse_calibration(text.data(), text.size(), "c.yaml", &camera, nullptr, message),
                                text.c_str());
  require_message(message, field);
  require_message(message, "c.yaml");
  TEST_ASSERT_EQUAL_INT(0, std::memcmp(&before, &camera, sizeof(camera)));
}

}  // namespace

static void test_kalibr_should_be_read_when_it_is_pinhole_radtan() {
  const pf_camera_t c = read(kKalibr);
  TEST_ASSERT_EQUAL_INT(PF_CAMERA_RADTAN, c.model);
  TEST_ASSERT_EQUAL_INT(752, c.width);
  TEST_ASSERT_EQUAL_INT(480, c.height);
  TEST_ASSERT_EQUAL_DOUBLE(457.296, c.fy);
  TEST_ASSERT_EQUAL_DOUBLE(367.215, c.cx);
  TEST_ASSERT_EQUAL_DOUBLE(1.8e-05, c.distortion[3]);
  TEST_ASSERT_EQUAL_DOUBLE(0.0, c.distortion[4]);
}

static void test_kalibr_should_be_read_when_it_is_equidistant_or_without_distortion() {
  const std::string fish = with(kKalibr, "distortion_model: radtan", "distortion_model: equidistant");
  TEST_ASSERT_EQUAL_INT(PF_CAMERA_EQUIDISTANT, read(fish).model);
  const std::string none =
      with(with(kKalibr, "distortion_model: radtan", "distortion_model: none"), "[-0.28, 0.07, 0.0002, 1.8e-05]", "[]");
  TEST_ASSERT_EQUAL_INT(PF_CAMERA_PINHOLE, read(none).model);
}

static void test_euroc_should_be_read_with_its_rate() {
  pf_camera_t c;
  double rate = 0.0;
  char message[PF_SEQUENCE_MESSAGE];
  TEST_ASSERT_EQUAL_INT(0, pf_parse_calibration(kEuroc, std::strlen(kEuroc), "sensor.yaml", &c, &rate, message));
  TEST_ASSERT_EQUAL_INT(PF_CAMERA_RADTAN, c.model);
  TEST_ASSERT_EQUAL_DOUBLE(-0.28340811, c.distortion[0]);
  TEST_ASSERT_EQUAL_DOUBLE(20.0, rate);
}

static void test_ros_should_be_read_in_its_three_models() {
  const pf_camera_t c = read(kRos);
  TEST_ASSERT_EQUAL_INT(PF_CAMERA_RADTAN, c.model);
  TEST_ASSERT_EQUAL_DOUBLE(501.0, c.fy);
  TEST_ASSERT_EQUAL_DOUBLE(240.0, c.cy);
  TEST_ASSERT_EQUAL_DOUBLE(0.05, c.distortion[4]);
  const std::string rational = with(with(kRos, "plumb_bob", "rational_polynomial"), "0.05]", "0.05, 0, 0, 0]");
  TEST_ASSERT_EQUAL_INT(PF_CAMERA_RADTAN, read(rational).model);
  const std::string fish = with(with(kRos, "plumb_bob", "equidistant"), ", 0.05]", "]");
  TEST_ASSERT_EQUAL_INT(PF_CAMERA_EQUIDISTANT, read(fish).model);
  const std::string straight = with(kRos, "[0.1, -0.2, 0.001, 0.002, 0.05]", "[0, 0, 0, 0, 0]");
  TEST_ASSERT_EQUAL_INT(PF_CAMERA_PINHOLE, read(straight).model);
}

static void test_plain_should_be_read_in_its_four_models() {
  const pf_camera_t c = read(kPlainCalibration);
  TEST_ASSERT_EQUAL_INT(PF_CAMERA_PINHOLE, c.model);
  TEST_ASSERT_EQUAL_DOUBLE(30.5, c.fx);
  TEST_ASSERT_EQUAL_DOUBLE(15.25, c.cx);
  const auto model = [](const std::string& name, const std::string& list) {
    return read(with(with(kPlainCalibration, "distortion_model: none", "distortion_model: " + name), "distortion: []",
                     "distortion: " + list));
  };
  TEST_ASSERT_EQUAL_INT(PF_CAMERA_RADTAN, model("radtan", "[0.1, 0.2, 0, 0.001]").model);
  TEST_ASSERT_EQUAL_INT(PF_CAMERA_EQUIDISTANT, model("equidistant", "[0.1, 0.2, 0, 0]").model);
  const pf_camera_t division = model("harris_division", "[9e-06]");
  TEST_ASSERT_EQUAL_INT(PF_CAMERA_DIVISION, division.model);
  TEST_ASSERT_EQUAL_DOUBLE(9e-06, division.distortion[0]);
}

static void test_orb_slam3_should_be_read_in_its_three_models() {
  pf_camera_t c;
  double rate = 0.0;
  char message[PF_SEQUENCE_MESSAGE] = "x";
  const int done = pf_parse_calibration(kOrbSlam3, std::strlen(kOrbSlam3), "EuRoC.yaml", &c, &rate, message);
  TEST_ASSERT_EQUAL_INT_MESSAGE(0, done, message);
  TEST_ASSERT_EQUAL_STRING("", message);
  TEST_ASSERT_EQUAL_INT(PF_CAMERA_RADTAN, c.model);
  TEST_ASSERT_EQUAL_INT(752, c.width);
  TEST_ASSERT_EQUAL_INT(480, c.height);
  TEST_ASSERT_EQUAL_DOUBLE(458.654, c.fx);
  TEST_ASSERT_EQUAL_DOUBLE(248.375, c.cy);
  TEST_ASSERT_EQUAL_DOUBLE(0.07395907, c.distortion[1]);
  TEST_ASSERT_EQUAL_DOUBLE(1.76187114e-05, c.distortion[3]);
  TEST_ASSERT_EQUAL_DOUBLE(0.0, c.distortion[4]);
  TEST_ASSERT_EQUAL_DOUBLE(20.0, rate);
  const std::string fisheye = with(with(with(kOrbSlam3, "PinHole", "KannalaBrandt8"), "Camera1.p1:", "Camera1.k3:"),
                                   "Camera1.p2:", "Camera1.k4:");
  TEST_ASSERT_EQUAL_INT(PF_CAMERA_EQUIDISTANT, read(fisheye).model);
  TEST_ASSERT_EQUAL_DOUBLE(0.00019359, read(fisheye).distortion[2]);
  const std::string rectified =
      "Camera.type: Rectified\nCamera1.fx: 400\nCamera1.fy: 400\nCamera1.cx: 320\nCamera1.cy: 240\n"
      "Camera.width: 640\nCamera.height: 480\n";
  TEST_ASSERT_EQUAL_INT(PF_CAMERA_PINHOLE, read(rectified).model);
}

static void test_orb_slam_of_before_should_be_read() {
  const pf_camera_t c = read(kOrbSlam);
  TEST_ASSERT_EQUAL_INT(PF_CAMERA_RADTAN, c.model);
  TEST_ASSERT_EQUAL_DOUBLE(516.469215, c.fy);
  TEST_ASSERT_EQUAL_DOUBLE(0.002628, c.distortion[3]);
  TEST_ASSERT_EQUAL_DOUBLE(1.163314, c.distortion[4]);
}

static void test_orb_slam_should_name_the_field_when_it_is_bad() {
  refused(with(kOrbSlam3, "Camera1.cy: 248.375\n", ""), "'Camera1.cy'");
  refused(with(kOrbSlam3, "458.654", "0"), "'Camera1.fx'");
  refused(with(kOrbSlam3, "Camera.height: 480\n", ""), "'Camera.height'");
  refused(with(kOrbSlam3, "Camera1.k1:", "Camera1.k7:"), "'Camera1.k7'");
  refused(with(kOrbSlam3, "PinHole", "Omni"), "'Camera.type'");
  refused(with(kOrbSlam3, "PinHole", "KannalaBrandt8"), "'Camera1.k3'");
  refused(with(kOrbSlam3, "Camera1.p1: 0.00019359", "Camera1.p1: .nan"), "'Camera1.p1'");
  refused(std::string(kOrbSlam) + "Camera.fx: 500\n", "'Camera.fx'");
  refused(with(with(kOrbSlam, "Camera.width: 640\n", ""), "Camera.height: 480\n", ""), "Camera.width");
}

static void test_kitti_should_be_read_with_images_only_and_name_what_is_bad() {
  // Alone it does not say how large the images are.
  refused(kKitti, "size of the images");
  refused(with(kKitti, "P0: 7.188560000000e+02 ", "P0: "), "'P0'");
  refused(with(kKitti, "P0: 7.188560000000e+02 0.", "P0: 7.188560000000e+02 3."), "'P0'");
  refused(with(kKitti, "P0: 7.188560000000e+02", "P0: fx"), "'P0'");
  refused(with(kKitti, "P0: 7.188560000000e+02", "P0: nan"), "'P0'");
  refused("P0: [1, 2]\n", "'P0'");
}

static void test_layout_should_be_refused_with_the_list_of_known_ones_when_nobody_knows_it() {
  for (const char* text : {"calib_time: 09-Jan-2012 13:57:47\nS_00: 1.392e+03 5.12e+02\n", "lens: 8 mm\n",
                           "cameras:\n- camera: {label: left}\n", "value0: {intrinsics: []}\n"}) {
    for (const char* layout : {"Kalibr", "EuRoC", "ROS", "ORB-SLAM3", "KITTI", "plain"}) {
      refused(text, layout);
    }
  }
}

static void test_readout_should_be_read_in_every_form() {
  TEST_ASSERT_EQUAL_DOUBLE(0.0, read(kPlainCalibration).readout_s);
  TEST_ASSERT_EQUAL_DOUBLE(0.02, read(with(kPlainCalibration, "rate_hz: 20", "readout_s: 0.02")).readout_s);
  TEST_ASSERT_EQUAL_DOUBLE(0.02, read(with(kEuroc, "rate_hz: ", "readout_s: 0.02\nrate_hz: ")).readout_s);
  TEST_ASSERT_EQUAL_DOUBLE(0.02,
                           read(with(kRos, "image_height: 480\n", "image_height: 480\nreadout_s: 0.02\n")).readout_s);
  TEST_ASSERT_EQUAL_DOUBLE(0.02, read(with(kKalibr, "  camera_model", "  readout_s: 0.02\n  camera_model")).readout_s);
}

static void test_timestamps_should_be_read_in_every_form_and_are_real_where_nothing_is_said() {
  TEST_ASSERT_EQUAL_INT(PF_TIMESTAMPS_REAL, read(kPlainCalibration).timestamps);
  const std::string said = "timestamps: nominal\n";
  for (const char* calibration : {kPlainCalibration, kEuroc, kRos, kKalibr}) {
    TEST_ASSERT_EQUAL_INT(PF_TIMESTAMPS_NOMINAL, read((calibration + said).c_str()).timestamps);
    TEST_ASSERT_EQUAL_INT(PF_TIMESTAMPS_REAL,
                          read((calibration + std::string("timestamps: real\n")).c_str()).timestamps);
    refused(calibration + std::string("timestamps: counted\n"), "'timestamps'");
  }
  TEST_ASSERT_EQUAL_INT(PF_TIMESTAMPS_NOMINAL,
                        read(with(kKalibr, "  camera_model", "  timestamps: nominal\n  camera_model")).timestamps);
}

static void test_settings_of_a_camera_of_a_chain_should_count_and_not_be_there_twice() {
  const auto inside = [](const char* line) {
    return with(kKalibr, "  camera_model", "  " + std::string(line) + "\n  camera_model");
  };
  TEST_ASSERT_EQUAL_DOUBLE(0.002, read(inside("sigma_focal: 0.002")).sigma_focal);
  TEST_ASSERT_EQUAL_DOUBLE(0.02, read(inside("sigma_distortion: [0.02]")).sigma_distortion[0]);
  refused(inside("sigma_focal: 2"), "'sigma_focal'");
  refused(inside("readout_s: 0.02") + "readout_s: 0.03\n", "'cam0.readout_s'");
  refused(inside("timestamps: nominal") + "timestamps: real\n", "'cam0.timestamps'");
}

static void test_plain_should_name_the_field_when_one_is_missing() {
  for (const char* field : {"width", "height", "fx", "fy", "cx", "cy", "distortion_model"}) {
    const std::string key = std::string("\n") + field + ":";
    refused(with(kPlainCalibration, key, "\nother_" + std::string(field) + ":"), "'" + std::string(field) + "'");
  }
}

static void test_plain_should_be_without_distortion_when_it_names_none() {
  const pf_camera_t c = read(with(kPlainCalibration, "distortion_model: none\ndistortion: []\n", ""));
  TEST_ASSERT_EQUAL_INT(PF_CAMERA_PINHOLE, c.model);
  TEST_ASSERT_EQUAL_DOUBLE(0.05, c.sigma_distortion[0]);
}

static void test_sigmas_should_be_read_in_every_form_and_be_typical_where_the_file_says_nothing() {
  const pf_camera_t typical = read(kPlainCalibration);
  TEST_ASSERT_EQUAL_INT(PF_CAMERA_EXACT, typical.estimate);
  TEST_ASSERT_EQUAL_DOUBLE(0.01, typical.sigma_focal);
  TEST_ASSERT_EQUAL_DOUBLE(0.001, typical.sigma_aspect);
  TEST_ASSERT_EQUAL_DOUBLE(0.01 * typical.width, typical.sigma_centre_px);
  TEST_ASSERT_EQUAL_DOUBLE(0.05, typical.sigma_distortion[0]);  // none is named
  TEST_ASSERT_EQUAL_DOUBLE(0.0, read(kEuroc).sigma_distortion[0]);
  const std::string sigmas = "sigma_focal: 0.002\nsigma_aspect: 0.0003\nsigma_centre_px: 1.5\nsigma_distortion: [";
  const auto require = [](const pf_camera_t& camera, double k1, double k2) {
    TEST_ASSERT_EQUAL_DOUBLE(0.002, camera.sigma_focal);
    TEST_ASSERT_EQUAL_DOUBLE(0.0003, camera.sigma_aspect);
    TEST_ASSERT_EQUAL_DOUBLE(1.5, camera.sigma_centre_px);
    TEST_ASSERT_EQUAL_DOUBLE(k1, camera.sigma_distortion[0]);
    TEST_ASSERT_EQUAL_DOUBLE(k2, camera.sigma_distortion[1]);
  };
  require(read(kPlainCalibration + ("\n" + sigmas + "0.02]\n")), 0.02, 0.0);
  for (const char* form : {kEuroc, kRos, kKalibr}) require(read(form + ("\n" + sigmas + "0.02, 0.01]\n")), 0.02, 0.01);
}

static void test_plain_should_name_the_field_when_one_is_absurd() {
  const struct {
    const char *from, *to, *field;
  } cases[] = {
      {"width: 32", "width: 0", "'width'"},
      {"width: 32", "width: 100000", "'width'"},
      {"width: 32", "width: -32", "'width'"},
      {"width: 32", "width: 32.5", "'width'"},
      {"height: 32", "height: abc", "'height'"},
      {"height: 32", "height: [1, 2]", "'height'"},
      {"fx: 30.5", "fx: 0", "'fx'"},
      {"fx: 30.5", "fx: -30", "'fx'"},
      {"fx: 30.5", "fx: .nan", "'fx'"},
      {"fx: 30.5", "fx: nan", "'fx'"},
      {"fx: 30.5", "fx: inf", "'fx'"},
      {"fx: 30.5", "fx: 1e9", "'fx'"},
      {"fx: 30.5", "fx: 30px", "'fx'"},
      {"fy: 31", "fy: 90", "'fy'"},
      {"cx: 15.25", "cx: 700", "'cx'"},
      {"cy: 16", "cy: -1", "'cy'"},
      {"model: none", "model: fov", "'distortion_model'"},
      {"model: none\ndistortion: []", "model: none\ndistortion: [0.1]", "'distortion'"},
      {"model: none\ndistortion: []", "model: radtan\ndistortion: [0.1]", "'distortion'"},
      {"model: none\ndistortion: []", "model: radtan\ndistortion: [0, 0, 0, nan]", "'distortion'"},
      {"model: none\ndistortion: []", "model: radtan\ndistortion: [0, 0, 0, 1e6]", "'distortion'"},
      {"model: none\ndistortion: []", "model: equidistant\ndistortion: 3", "'distortion'"},
      {"model: none\ndistortion: []", "model: harris_division\ndistortion: [0.1]", "'distortion'"},
      {"camera_model: pinhole", "camera_model: omni", "'camera_model'"},
      {"rate_hz: 20", "rate_hz: -5", "'rate_hz'"},
      {"rate_hz: 20", "readout_s: 0.3", "'readout_s'"},
      {"rate_hz: 20", "readout_s: -0.01", "'readout_s'"},
      {"rate_hz: 20", "readout_s: soon", "'readout_s'"},
      {"rate_hz: 20", "sigma_focal: -0.01", "'sigma_focal'"},
      {"rate_hz: 20", "sigma_focal: 0", "'sigma_focal'"},
      {"rate_hz: 20", "sigma_focal: .nan", "'sigma_focal'"},
      {"rate_hz: 20", "sigma_aspect: 1", "'sigma_aspect'"},
      {"rate_hz: 20", "sigma_centre_px: 0", "'sigma_centre_px'"},
      {"rate_hz: 20", "sigma_centre_px: wide", "'sigma_centre_px'"},
      {"rate_hz: 20", "sigma_distortion: [-0.05]", "'sigma_distortion'"},
      {"rate_hz: 20", "sigma_distortion: [.nan]", "'sigma_distortion'"},
      {"rate_hz: 20", "sigma_distortion: [0.05, 0.05]", "'sigma_distortion'"},
      {"rate_hz: 20", "sigma_distortion: 0.05", "'sigma_distortion'"},
  };
  for (const auto& c : cases) {
    refused(with(kPlainCalibration, c.from, c.to), c.field);
  }
}

static void test_other_forms_should_name_the_field_when_it_is_bad() {
  refused(with(kKalibr, "intrinsics: [458.654, ", "intrinsics: ["), "'cam0.intrinsics'");
  refused(with(kKalibr, "resolution: [752, 480]", "resolution: [752]"), "'cam0.resolution'");
  refused(with(kKalibr, "camera_model: pinhole", "camera_model: omni"), "'cam0.camera_model'");
  refused(with(kKalibr, "  distortion_coeffs", "  coeffs"), "'cam0.distortion_coeffs'");
  refused("cam0: 5\n", "'cam0'");
  refused(with(kEuroc, "intrinsics: [458.654", "intrinsics: [0"), "'intrinsics'");
  refused(with(kEuroc, "distortion_coefficients", "coefficients"), "'distortion_coefficients'");
  refused(with(kRos, "data: [500, 0, 320", "data: [500, 3, 320"), "'camera_matrix.data'");
  refused(with(kRos, "data: [500, 0, 320", "data: [500, 0, 1320"), "'camera_matrix.data'");
  refused(with(kRos, "image_height: 480\n", ""), "'image_height'");
  refused(with(with(kRos, "plumb_bob", "rational_polynomial"), "0.05]", "0.05, 0.1, 0, 0]"),
          "'distortion_coefficients.data'");
}

static void test_anything_else_should_be_refused_in_one_line() {
  refused("", "fields");
  refused("just words", "fields");
  refused("a: [1, 2", "YAML");
  refused("%YAML:1.0\n---\nfx: 1\n", "'width'");
  refused("a: {b", "YAML");
  refused(std::string(3000, '['), "YAML");
  refused(std::string(200, '-') + "\n", "YAML");
  refused(std::string("wid\0th: 3", 9), "YAML");
  refused("&a [*a, *a]\n", "fields");
  refused("width: &w [*w]\n", "width");
}

static void test_file_should_be_named_when_it_cannot_be_read() {
  TemporaryFolder folder;
  folder.write("empty.yaml", std::string());
  pf_camera_t camera;
  char message[PF_SEQUENCE_MESSAGE];
  TEST_ASSERT_EQUAL_INT(-1, pf_read_calibration((folder / "none.yaml").c_str(), &camera, nullptr, message));
  require_message(message, "none.yaml");
  TEST_ASSERT_EQUAL_INT(-1, pf_read_calibration((folder / "empty.yaml").c_str(), &camera, nullptr, message));
  require_message(message, "empty.yaml");
  TEST_ASSERT_EQUAL_INT(-1, pf_read_calibration(folder.path().c_str(), &camera, nullptr, message));
  require_message(message, "not a file");
  TEST_ASSERT_EQUAL_INT(-1, pf_read_calibration(nullptr, &camera, nullptr, message));
  TEST_ASSERT_EQUAL_INT(-1, pf_read_calibration("x", nullptr, nullptr, nullptr));
}

static void test_field_should_be_refused_when_it_is_there_twice_or_misspelled() {
  const std::string plain = kPlainCalibration;
  refused(plain + "fx: 300\n", "'fx'");
  refused(plain + "readout: 0.03\n", "'readout_s'");
  refused(plain + "readout_ms: 30\n", "'readout_s'");
  refused(plain + "ratehz: 30\n", "'rate_hz'");
  refused(plain + "Fx: 300\n", "'fx'");
  refused(plain + "my_own: 1\n", "'my_own'");
  refused(std::string(kKalibr) + "readout: 0.03\n", "'readout_s'");
  refused(with(kKalibr, "  rostopic", "  readout: 0.03\n  rostopic"), "'cam0.readout_s'");
  refused(std::string(kEuroc) + "intrinsics: [458.654, 457.296, 367.215, 248.375]\n", "'intrinsics'");
  refused(std::string(kEuroc) + "readout: 0.03\n", "'readout_s'");
  refused(std::string(kRos) + "image_width: 640\n", "'image_width'");
  refused(std::string(kRos) + "readot_s: 0.02\n", "'readout_s'");
}

static void test_field_should_give_a_warning_when_another_form_has_it_and_nobody_knows_it() {
  const auto warning = [](const std::string& text) {
    pf_camera_t camera;
    char message[PF_SEQUENCE_MESSAGE] = "x";
    TEST_ASSERT_EQUAL_INT_MESSAGE(
        0, pf_parse_calibration(text.data(), text.size(), "c.yaml", &camera, nullptr, message), message);
    return std::string(message);
  };
  TEST_ASSERT_EQUAL_STRING("", warning(kKalibr).c_str());
  TEST_ASSERT_EQUAL_STRING("", warning(kEuroc).c_str());
  TEST_ASSERT_EQUAL_STRING("", warning(kRos).c_str());
  TEST_ASSERT_EQUAL_STRING("", warning(std::string(kPlainCalibration) + "comment: on my desk\n").c_str());
  require_message(warning(std::string(kEuroc) + "lens: 8 mm\nlens: 8 mm\n").c_str(), "'lens'");
  require_message(warning(with(kKalibr, "  rostopic", "  lens: 8 mm\n  rostopic")).c_str(), "'cam0.lens'");
  require_message(warning(std::string(kRos) + "lens: 8 mm\n").c_str(), "c.yaml");
}

static void test_written_file_should_be_read_as_the_same_camera_in_both_forms() {
  const TemporaryFolder folder;
  const std::string path = folder / "written.yaml";
  char message[PF_SEQUENCE_MESSAGE];
  for (int k = 0; k < 8; ++k) {
    pf_camera_t camera = read(kKalibr);
    camera.model = static_cast<pf_camera_model_t>(PF_CAMERA_PINHOLE + k / 2);
    camera.fx = 1000.0 / 3.0;
    camera.readout_s = k < 4 ? 1.0 / 70.0 : 0.0;
    camera.timestamps = k < 6 ? PF_TIMESTAMPS_NOMINAL : PF_TIMESTAMPS_REAL;
    const int used[] = {0, 5, 4, 1};
    for (int i = 0; i < 5; ++i) {
      camera.distortion[i] = i < used[k / 2] ? (k / 2 == 3 ? 1e-6 : 0.1) / (3.0 + i) : 0.0;
    }
    const uint32_t form = k % 2 == 0 ? PF_CALIBRATION_PLAIN : PF_CALIBRATION_EUROC;
    const double rate_hz = k < 6 ? 100.0 / 3.0 : 0.0;
    pf_camera_t again;
    double rate_again_hz = -1.0;
    TEST_ASSERT_EQUAL_INT(0, pf_write_calibration(path.c_str(), form, &camera, rate_hz, message));
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, pf_read_calibration(path.c_str(), &again, &rate_again_hz, message), message);
    TEST_ASSERT_EQUAL_INT(camera.model, again.model);
    TEST_ASSERT_EQUAL_INT(camera.width, again.width);
    TEST_ASSERT_EQUAL_INT(camera.height, again.height);
    TEST_ASSERT_EQUAL_INT(camera.timestamps, again.timestamps);
    TEST_ASSERT_EQUAL_MEMORY(&camera.fx, &again.fx, sizeof(double));
    TEST_ASSERT_EQUAL_MEMORY(&camera.cy, &again.cy, sizeof(double));
    TEST_ASSERT_EQUAL_MEMORY(camera.distortion, again.distortion, sizeof(camera.distortion));
    TEST_ASSERT_EQUAL_MEMORY(&camera.readout_s, &again.readout_s, sizeof(double));
    TEST_ASSERT_EQUAL_MEMORY(&rate_hz, &rate_again_hz, sizeof(double));
  }
  const pf_camera_t camera = read(kKalibr);
  TEST_ASSERT_EQUAL_INT(-1, pf_write_calibration((folder / "no/c.yaml").c_str(), 0, &camera, 0.0, message));
  require_message(message, "no/c.yaml");
  TEST_ASSERT_EQUAL_INT(-1, pf_write_calibration(path.c_str(), 0, nullptr, 0.0, message));
}

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_kalibr_should_be_read_when_it_is_pinhole_radtan);
  RUN_TEST(test_kalibr_should_be_read_when_it_is_equidistant_or_without_distortion);
  RUN_TEST(test_euroc_should_be_read_with_its_rate);
  RUN_TEST(test_ros_should_be_read_in_its_three_models);
  RUN_TEST(test_plain_should_be_read_in_its_four_models);
  RUN_TEST(test_orb_slam3_should_be_read_in_its_three_models);
  RUN_TEST(test_orb_slam_of_before_should_be_read);
  RUN_TEST(test_orb_slam_should_name_the_field_when_it_is_bad);
  RUN_TEST(test_kitti_should_be_read_with_images_only_and_name_what_is_bad);
  RUN_TEST(test_layout_should_be_refused_with_the_list_of_known_ones_when_nobody_knows_it);
  RUN_TEST(test_readout_should_be_read_in_every_form);
  RUN_TEST(test_timestamps_should_be_read_in_every_form_and_are_real_where_nothing_is_said);
  RUN_TEST(test_settings_of_a_camera_of_a_chain_should_count_and_not_be_there_twice);
  RUN_TEST(test_plain_should_name_the_field_when_one_is_missing);
  RUN_TEST(test_plain_should_be_without_distortion_when_it_names_none);
  RUN_TEST(test_sigmas_should_be_read_in_every_form_and_be_typical_where_the_file_says_nothing);
  RUN_TEST(test_plain_should_name_the_field_when_one_is_absurd);
  RUN_TEST(test_other_forms_should_name_the_field_when_it_is_bad);
  RUN_TEST(test_anything_else_should_be_refused_in_one_line);
  RUN_TEST(test_file_should_be_named_when_it_cannot_be_read);
  RUN_TEST(test_field_should_be_refused_when_it_is_there_twice_or_misspelled);
  RUN_TEST(test_field_should_give_a_warning_when_another_form_has_it_and_nobody_knows_it);
  RUN_TEST(test_written_file_should_be_read_as_the_same_camera_in_both_forms);
  return UNITY_END();
}

#else

int main() { SKIP_PROGRAM("this build has no platform layer"); }

#endif
