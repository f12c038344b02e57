// The forms that calibrations come in: what each one's numbers become, and what of each is refused by name.
#include "skip.h"

#if __has_include(<planefold_platform/sequence.h>)

#include <vector>

#include "calibration_test.h"

using namespace pf::test;

void setUp() {}
void tearDown() {}

namespace {

const std::string kOpencv =
    "%YAML:1.0\n---\ncalibration_time: \"Tue 03 Mar 2020\"\nnr_of_frames: 21\nimage_width: 800\nimage_height: 600\n"
    "board_width: 9\nflags: 0\nfisheye_model: 0\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
    "   data: [ 610.5, 0., 401.25, 0.,\n       612.25, 298.5, 0., 0., 1. ]\ndistortion_coefficients: !!opencv-matrix\n"
    "   rows: 5\n   cols: 1\n   dt: d\n   data: [ -0.2, 0.05, 1e-3,\n       -2e-3, 0.01 ]\n"
    "avg_reprojection_error: 0.31\n";
const std::string kVslam =
    "Camera.name: \"front\"\nCamera.setup: \"monocular\"\nCamera.model: \"fisheye\"\nCamera.fx: 310.0\nCamera.fy: "
    "311.0\n"
    "Camera.cx: 318.0\nCamera.cy: 241.0\nCamera.k1: 0.02\nCamera.k2: -0.01\nCamera.k3: 0.004\nCamera.k4: -0.001\n"
    "Camera.fps: 25.0\nCamera.cols: 640\nCamera.rows: 480\nCamera.color_order: \"Gray\"\nFeature.max_num_keypoints: "
    "2000\n"
    "PangolinViewer.fps: 30\n";
const std::string kStella =
    "Camera:\n  name: front\n  setup: monocular\n  model: perspective\n  fx: 500.0\n  fy: 501.0\n  cx: 320.0\n  cy: "
    "240.0\n"
    "  k1: 0.1\n  k2: -0.2\n  p1: 0.001\n  p2: 0.002\n  k3: 0.03\n  fps: 30.0\n  cols: 640\n  rows: 480\n"
    "  color_order: RGB\nPreprocessing:\n  min_size: 800\nSystem:\n  map_format: msgpack\n";
const std::string kVinsFisheye =
    "%YAML:1.0\n---\nmodel_type: KANNALA_BRANDT\ncamera_name: camera\nimage_width: 640\nimage_height: 480\n"
    "projection_parameters:\n   k2: 0.02\n   k3: -0.01\n   k4: 0.004\n   k5: -0.001\n   mu: 310.0\n   mv: 311.0\n"
    "   u0: 318.0\n   v0: 241.0\n";
const std::string kVinsMei =
    "%YAML:1.0\n---\nmodel_type: MEI\ncamera_name: camera\nimage_width: 640\nimage_height: 480\nmirror_parameters:\n"
    "   xi: 0.0\ndistortion_parameters:\n   k1: 0.1\n   k2: -0.2\n   p1: 0.001\n   p2: 0.002\nprojection_parameters:\n"
    "   gamma1: 500.0\n   gamma2: 501.0\n   u0: 320.0\n   v0: 240.0\n";
const std::string kRosEcho =
    "header: \n  seq: 7\n  stamp: \n    secs: 12\n    nsecs: 500\n  frame_id: \"cam\"\nheight: 480\nwidth: 640\n"
    "distortion_model: \"plumb_bob\"\nD: [0.1, -0.2, 0.001, 0.002, 0.03]\n"
    "K: [500.0, 0.0, 320.0, 0.0, 501.0, 240.0, 0.0, 0.0, 1.0]\nR: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]\n"
    "P: [500.0, 0.0, 320.0, 0.0, 0.0, 501.0, 240.0, 0.0, 0.0, 0.0, 1.0, 0.0]\nbinning_x: 0\nbinning_y: 0\nroi: \n"
    "  x_offset: 0\n  y_offset: 0\n  height: 0\n  width: 0\n  do_rectify: False\n";
const std::string kKittiRaw =
    "calib_time: 09-Jan-2012 13:57:47\ncorner_dist: 9.950000e-02\nS_00: 1.392e+03 5.12e+02\n"
    "K_00: 9.8e+02 0 6.9e+02 0 9.7e+02 2.4e+02 0 0 1\nD_00: -3.7e-01 2.0e-01 1e-3 1e-3 -7e-02\n"
    "R_00: 1 0 0 0 1 0 0 0 1\nT_00: 0 0 0\nS_rect_00: 1.242e+03 3.75e+02\nR_rect_00: 1 0 0 0 1 0 0 0 1\n"
    "P_rect_00: 7.215e+02 0 6.095e+02 0 0 7.216e+02 1.728e+02 0 0 0 1 0\nS_rect_02: 1.24e+03 3.76e+02\n"
    "P_rect_02: 7.115e+02 0 6.195e+02 4.4e+01 0 7.116e+02 1.738e+02 2e-01 0 0 1 2.7e-03\n";

}  // namespace

static void test_opencv_should_be_read_as_pinhole_or_fisheye_as_its_flag_says() {
  require_lens(camera_of(kOpencv), PF_CAMERA_RADTAN, 610.5, 612.25, 401.25, 298.5, {-0.2, 0.05, 1e-3, -2e-3, 0.01});
  const std::string four = replaced(replaced(kOpencv, "rows: 5", "rows: 4"), ",\n       -2e-3, 0.01 ]", ", -2e-3 ]");
  const std::string fish = replaced(four, "fisheye_model: 0", "fisheye_model: 1");
  require_lens(camera_of(fish), PF_CAMERA_EQUIDISTANT, 610.5, 612.25, 401.25, 298.5, {-0.2, 0.05, 1e-3, -2e-3});
  TEST_ASSERT_EQUAL_INT(PF_CAMERA_RADTAN, camera_of(four).model);
  // Zeros of a fisheye lens are r = f theta.
  const std::string zeros = replaced(fish, "[ -0.2, 0.05, 1e-3, -2e-3 ]", "[ 0., 0., 0., 0. ]");
  TEST_ASSERT_EQUAL_INT(PF_CAMERA_EQUIDISTANT, camera_of(zeros).model);
  require_refused(replaced(four, "fisheye_model: 0\n", ""), "add fisheye_model");
  TEST_ASSERT_EQUAL_INT(PF_CAMERA_RADTAN, camera_of(replaced(kOpencv, "fisheye_model: 0\n", "")).model);
  require_refused(replaced(kOpencv, "fisheye_model: 0", "fisheye_model: 1"), "'distortion_coefficients'");
  require_refused(replaced(kOpencv, "fisheye_model: 0", "fisheye_model: 2"), "'fisheye_model'");
}

static void test_opencv_should_be_refused_when_coefficients_or_matrix_say_more_than_is_known() {
  const std::string eight = replaced(replaced(kOpencv, "rows: 5", "rows: 8"), "0.01 ]", "0.01, 0., 0., 0. ]");
  TEST_ASSERT_EQUAL_INT(PF_CAMERA_RADTAN, camera_of(eight).model);
  require_refused(replaced(eight, "0.01, 0., 0., 0. ]", "0.01, 0.1, 0., 0. ]"), "'distortion_coefficients");
  const std::string prism = replaced(replaced(eight, "rows: 8", "rows: 12"), "0., 0. ]", "0., 0., 0., 0., 0., 1e-3 ]");
  require_refused(prism, "'distortion_coefficients");
  require_refused(replaced(kOpencv, "610.5, 0., 401", "610.5, 1.5, 401"), "'camera_matrix.data'");
  require_refused(replaced(kOpencv, "rows: 3\n", "rows: 1\n"), "'camera_matrix");
  require_refused("<?xml version=\"1.0\"?>\n<opencv_storage>\n</opencv_storage>\n", "XML");
}

static void test_matrix_should_be_read_in_rows_and_under_the_names_of_other_programs() {
  const std::string python =
      "{\"camera_matrix\": [[610.5, 0.0, 401.25], [0.0, 612.25, 298.5], [0.0, 0.0, 1.0]], "
      "\"dist_coeff\": [[-0.2, 0.05, 0.001, -0.002, 0.01]], \"image_width\": 800, \"image_height\": 600}";
  require_lens(camera_of(python), PF_CAMERA_RADTAN, 610.5, 612.25, 401.25, 298.5, {-0.2, 0.05, 1e-3, -2e-3, 0.01});
  require_refused(replaced(python, "[0.0, 612.25, 298.5]", "[0.0, 612.25]"), "'camera_matrix'");
  require_refused(replaced(python, ", \"image_width\": 800, \"image_height\": 600", ""), "add image_width");
}

static void test_openvslam_should_be_read_flat_and_nested() {
  const ReadCalibration flat = parse(kVslam);
  require_lens(flat.camera, PF_CAMERA_EQUIDISTANT, 310, 311, 318, 241, {0.02, -0.01, 0.004, -0.001});
  TEST_ASSERT_EQUAL_STRING("", flat.message);
  TEST_ASSERT_EQUAL_DOUBLE(25.0, flat.rate_hz);
  require_lens(camera_of(kStella), PF_CAMERA_RADTAN, 500, 501, 320, 240, {0.1, -0.2, 0.001, 0.002, 0.03});
  require_refused(replaced(kVslam, "\"fisheye\"", "\"equirectangular\""), "'Camera.model'");
  require_refused(replaced(kStella, "perspective", "radial_division"), "'Camera.model'");
  require_refused(replaced(kVslam, "Camera.model: \"fisheye\"\n", ""), "'Camera.model'");
  require_refused(replaced(kVslam, "Camera.k4: -0.001\n", ""), "'Camera.k4'");
  require_refused(kVslam + "StereoRectifier.K_left: [310, 0, 318, 0, 311, 241, 0, 0, 1]\n", "'StereoRectifier.K_left'");
  require_refused(replaced(replaced(kVslam, "Camera.cols: 640\n", ""), "Camera.rows: 480\n", ""), "Camera.cols");
}

static void test_openvslam_should_be_refused_when_coefficients_are_of_the_other_model() {
  require_refused(replaced(kVslam, "\"fisheye\"", "\"perspective\""), "'Camera.k4'");
  require_refused(replaced(kStella, "model: perspective", "model: fisheye"), "'Camera.");
  // Zeros of the other model say nothing.
  const std::string zeros =
      replaced(replaced(kVslam, "\"fisheye\"", "\"perspective\""), "Camera.k4: -0.001", "Camera.k4: 0");
  TEST_ASSERT_EQUAL_INT(PF_CAMERA_RADTAN, camera_of(zeros, nullptr, "'Camera.k4'").model);
}

static void test_vins_should_be_read_in_its_models() {
  require_lens(camera_of(kVinsFisheye), PF_CAMERA_EQUIDISTANT, 310, 311, 318, 241, {0.02, -0.01, 0.004, -0.001});
  require_lens(camera_of(kVinsMei), PF_CAMERA_RADTAN, 500, 501, 320, 240, {0.1, -0.2, 0.001, 0.002});
  std::string pinhole =
      replaced(replaced(kVinsMei, "model_type: MEI", "model_type: PINHOLE"), "mirror_parameters:\n   xi: 0.0\n", "");
  for (const auto& [from, to] : {std::pair("gamma1", "fx"), {"gamma2", "fy"}, {"u0", "cx"}, {"v0", "cy"}}) {
    pinhole = replaced(pinhole, from, to);
  }
  require_lens(camera_of(pinhole), PF_CAMERA_RADTAN, 500, 501, 320, 240, {0.1, -0.2, 0.001, 0.002});
  require_refused(replaced(kVinsMei, "xi: 0.0", "xi: 1.2"), "'mirror_parameters.xi'");
  require_refused(replaced(kVinsMei, "   xi: 0.0\n", ""), "'mirror_parameters");
  require_refused(replaced(pinhole, "PINHOLE", "SCARAMUZZA"), "'model_type'");
  require_refused(pinhole + "mirror_parameters:\n   xi: 0.9\n", "'mirror_parameters'");
  require_refused(replaced(kVinsFisheye, "   k5: -0.001\n", ""), "'projection_parameters.k5'");
  require_refused(replaced(kVinsFisheye, "   mu:", "   k6: 0.1\n   mu:"), "'projection_parameters.k6'");
}

static void test_ros_messages_should_be_read_as_either_ros_prints_them() {
  require_lens(camera_of(kRosEcho + "---\n"), PF_CAMERA_RADTAN, 500, 501, 320, 240, {0.1, -0.2, 0.001, 0.002, 0.03});
  std::string ros2 = kRosEcho;
  for (const auto& [from, to] : {std::pair("\nD:", "\nd:"), {"\nK:", "\nk:"}, {"\nR:", "\nr:"}, {"\nP:", "\np:"}}) {
    ros2 = replaced(ros2, from, to);
  }
  require_lens(camera_of(ros2), PF_CAMERA_RADTAN, 500, 501, 320, 240, {0.1, -0.2, 0.001, 0.002, 0.03});
  const std::string stream = kRosEcho + "---\n" + replaced(kRosEcho, "seq: 7", "seq: 8") + "---\n";
  TEST_ASSERT_EQUAL_INT(PF_CAMERA_RADTAN, camera_of(stream).model);
  require_refused(kRosEcho + "---\n" + replaced(kRosEcho, "K: [500.0", "K: [505.0"), "documents");
  require_refused(kRosEcho + "---\nheight: 480\n", "number 2");
  require_refused(
      replaced(kRosEcho, "K: [500.0, 0.0, 320.0, 0.0, 501.0, 240.0, 0.0, 0.0, 1.0]", "K: [0, 0, 0, 0, 0, 0, 0, 0, 0]"),
      "not calibrated");
  require_refused("# oST version 5.0 parameters\n[image]\nwidth\n640\n", "ROS camera_info");
  const std::string fish = replaced(replaced(kRosEcho, "plumb_bob", "equidistant"), ", 0.03]", "]");
  TEST_ASSERT_EQUAL_INT(PF_CAMERA_EQUIDISTANT, camera_of(fish).model);
  const std::string rational = replaced(kRosEcho, "plumb_bob", "rational_polynomial");
  TEST_ASSERT_EQUAL_INT(PF_CAMERA_RADTAN, camera_of(replaced(rational, "0.03]", "0.03, 0.0, 0.0, 0.0]")).model);
  require_refused(replaced(rational, "0.03]", "0.03, 0.0, 0.0, 0.2]"), "'D'");
  require_refused(replaced(kRosEcho, "K: [500.0", "K: [0.0"), "'K'");
  require_refused(replaced(kRosEcho, "plumb_bob", "scaramuzza"), "'distortion_model'");
}

static void test_ros_should_apply_roi_refuse_binning_and_note_rectification() {
  const std::string part =
      replaced(replaced(kRosEcho, "x_offset: 0", "x_offset: 40"), "height: 0\n  width: 0", "height: 480\n  width: 400");
  const pf_camera_t c = camera_of(part, nullptr, "roi of 400 x 480 at 40, 0");
  require_lens(c, PF_CAMERA_RADTAN, 500, 501, 280, 240, {0.1, -0.2, 0.001, 0.002, 0.03});
  TEST_ASSERT_EQUAL_INT(400, c.width);
  require_refused(replaced(part, "x_offset: 40", "x_offset: 400"), "'roi'");
  require_refused(replaced(kRosEcho, "y_offset: 0", "y_offset: 8"), "'roi'");
  require_refused(replaced(kRosEcho, "binning_x: 0", "binning_x: 2"), "'binning_x'");
  TEST_ASSERT_EQUAL_INT(PF_CAMERA_RADTAN, camera_of(replaced(kRosEcho, "binning_y: 0", "binning_y: 1")).model);
  camera_of(replaced(kRosEcho, "P: [500.0", "P: [450.0"), nullptr, "'P'");
  camera_of(replaced(kRosEcho, "R: [1.0, 0.0", "R: [0.9998, 0.02"), nullptr, "'R'");
}

static void test_kitti_raw_should_be_read_as_rectified_with_its_size() {
  const pf_camera_t first = camera_of(kKittiRaw, nullptr, "P_rect_00 and P_rect_02");
  require_lens(first, PF_CAMERA_PINHOLE, 721.5, 721.6, 609.5, 172.8);
  TEST_ASSERT_EQUAL_INT(1242, first.width);
  const pf_camera_t third = camera_of(kKittiRaw, "2");
  require_lens(third, PF_CAMERA_PINHOLE, 711.5, 711.6, 619.5, 173.8);
  TEST_ASSERT_EQUAL_INT(376, third.height);
  require_refused(replaced(kKittiRaw, "S_rect_00: 1.242e+03 3.75e+02\n", ""), "'S_rect_00'");
  require_refused(replaced(kKittiRaw, "P_rect_00: 7.215e+02 0", "P_rect_00: 7.215e+02 4"), "'P_rect_00'");
  require_refused(kKittiRaw, "P_rect_02", "1");
}

static void test_colmap_should_be_read_with_its_centre_moved_by_half_a_pixel() {
  const std::string head =
      "# Camera list with one line of data per camera:\n#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n";
  const auto read = [&](const std::string& row) { return camera_of(head + row + "\n"); };
  require_lens(read("1 SIMPLE_PINHOLE 640 480 500 320 240"), PF_CAMERA_PINHOLE, 500, 500, 319.5, 239.5);
  require_lens(read("1 PINHOLE 640 480 500 501 320 240"), PF_CAMERA_PINHOLE, 500, 501, 319.5, 239.5);
  require_lens(read("3 SIMPLE_RADIAL 640 480 500 320 240 0.1"), PF_CAMERA_RADTAN, 500, 500, 319.5, 239.5, {0.1});
  require_lens(read("1 RADIAL 640 480 500 320 240 0.1 -0.2"), PF_CAMERA_RADTAN, 500, 500, 319.5, 239.5, {0.1, -0.2});
  require_lens(read("1 OPENCV 640 480 500 501 320 240 0.1 -0.2 0.001 0.002"), PF_CAMERA_RADTAN, 500, 501, 319.5, 239.5,
               {0.1, -0.2, 0.001, 0.002});
  require_lens(read("1 OPENCV_FISHEYE 640 480 500 501 320 240 0.1 -0.2 0.01 0"), PF_CAMERA_EQUIDISTANT, 500, 501, 319.5,
               239.5, {0.1, -0.2, 0.01});
  for (const char* row : {"FULL_OPENCV 640 480 500 501 320 240 0 0 0 0 0 0 0 0", "FOV 640 480 500 501 320 240 0.9",
                          "THIN_PRISM_FISHEYE 640 480 500 501 320 240 0 0 0 0 0 0 0 0"}) {
    require_refused(head + "1 " + row + "\n", "OPENCV_FISHEYE");
  }
  require_refused("1 PINHOLE 640 480 500 501 320\n", "'camera 1'");
  require_refused("1 RADIAL 640 480 500 501 320 240 0.1 -0.2\n", "'camera 1'");
  require_refused("1 PINHOLE 640 480 500 nan 320 240\n", "'camera 1'");
}

static void test_numbers_alone_should_be_read_with_distortion_where_they_have_it() {
  const auto read = [](const std::string& row) {
    TemporaryFolder folder;
    folder.write("rgb.txt", "0 rgb/0.png\n0.05 rgb/1.png\n");
    for (const char* name : {"rgb/0.png", "rgb/1.png"}) folder.write(name, grey_png(1));
    folder.write("calibration.txt", row + "\n");
    const Opened opened("tum:" + folder.path());
    TEST_ASSERT_NOT_NULL_MESSAGE(opened.sequence, opened.message);
    return opened.info.camera;
  };
  require_lens(read("30 31 15.5 16.5"), PF_CAMERA_PINHOLE, 30, 31, 15.5, 16.5);
  require_lens(read("30 31 15.5 16.5 0.1 -0.2 0.001 0.002"), PF_CAMERA_RADTAN, 30, 31, 15.5, 16.5,
               {0.1, -0.2, 0.001, 0.002});
  require_lens(read("30, 31, 15.5, 16.5, 0.1, -0.2, 0.001, 0.002, 0.03"), PF_CAMERA_RADTAN, 30, 31, 15.5, 16.5,
               {0.1, -0.2, 0.001, 0.002, 0.03});
  require_refused("30 31 15.5 16.5 0.1 -0.2\n", "has 6 numbers; known are fx fy cx cy");
}

static void test_mono_vo_should_be_read_in_its_models_and_shares_of_the_size() {
  const std::string rest = "\n640 480\ncrop\n640 480\n";
  require_lens(camera_of("RadTan 500 501 320 240 0.1 -0.2 0.001 0.002" + rest), PF_CAMERA_RADTAN, 500, 501, 320, 240,
               {0.1, -0.2, 0.001, 0.002});
  require_lens(camera_of("EquiDistant 310 311 318 241 0.02 -0.01 0.004 -0.001" + rest), PF_CAMERA_EQUIDISTANT, 310, 311,
               318, 241, {0.02, -0.01, 0.004, -0.001});
  require_lens(camera_of("Pinhole 0.75 1 0.5 0.5 0" + rest), PF_CAMERA_PINHOLE, 480, 480, 319.5, 239.5);
  require_lens(camera_of("0.75 1 0.5 0.5 0\n640 480\n0.4 0.53 0.5 0.5 0\n640 480\n"), PF_CAMERA_PINHOLE, 480, 480,
               319.5, 239.5);
  require_refused("FOV 0.349 0.436 0.493 0.499 0.933" + rest, "is 'FOV' with 5 numbers; known are Pinhole");
  require_refused("0.349 0.436 0.493 0.499 0.933" + rest, "is 'FOV'");
  require_refused("RadTan 500 501 320 240 0.1" + rest, "is 'RadTan' with 5 numbers");
  require_refused("Pinhole 500 501 320 240 0.9" + rest, "is 'Pinhole'");
}

static void test_settings_that_name_a_calibration_should_be_refused_with_its_name() {
  TemporaryFolder folder;
  folder.write("cam0_pinhole.yaml", kVinsMei);
  folder.write("config.yaml",
               "%YAML:1.0\nimu: 1\nnum_of_cam: 2\nimu_topic: \"/imu0\"\ncam0_calib: \"cam0_pinhole.yaml\"\n");
  pf_camera_t camera{};
  char message[PF_SEQUENCE_MESSAGE];
  TEST_ASSERT_EQUAL_INT(-1, pf_read_calibration((folder / "config.yaml").c_str(), &camera, nullptr, message));
  require_message(message, "'cam0_calib'; give that: " + (folder / "cam0_pinhole.yaml"));
  TEST_ASSERT_EQUAL_INT(0, pf_read_calibration((folder / "cam0_pinhole.yaml").c_str(), &camera, nullptr, message));
  require_refused("%YAML:1.0\nuse_fej: true\nrelative_config_imucam: \"kalibr_imucam_chain.yaml\"\n",
                  "which is not beside it");
}

static void test_orb_slam_should_not_take_rectified_numbers_for_those_of_the_camera() {
  const std::string stereo =
      "%YAML:1.0\nCamera.fx: 435.2\nCamera.fy: 435.2\nCamera.cx: 367.4\nCamera.cy: 252.2\nCamera.k1: 0.0\nCamera.k2: "
      "0.0\n"
      "Camera.p1: 0.0\nCamera.p2: 0.0\nCamera.width: 752\nCamera.height: 480\nCamera.fps: 20.0\nCamera.bf: 47.9\n"
      "LEFT.width: 752\nLEFT.height: 480\nLEFT.D: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n"
      "   data: [-0.28, 0.07, 0.0002, 0.00002, 0.0]\nLEFT.K: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
      "   data: [458.6, 0.0, 367.2, 0.0, 457.3, 248.4, 0.0, 0.0, 1.0]\nLEFT.R: !!opencv-matrix\n   rows: 3\n   cols: "
      "3\n"
      "   dt: d\n   data: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n";
  require_refused(stereo, "'LEFT.K'");
  require_lens(camera_of(stereo, "Camera"), PF_CAMERA_PINHOLE, 435.2, 435.2, 367.4, 252.2);
  require_lens(camera_of(stereo, "LEFT"), PF_CAMERA_RADTAN, 458.6, 457.3, 367.2, 248.4, {-0.28, 0.07, 0.0002, 0.00002});
  require_refused(replaced(stereo, "458.6, 0.0, 367", "458.6, 0.7, 367"), "'LEFT.K'", "LEFT");
}

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_opencv_should_be_read_as_pinhole_or_fisheye_as_its_flag_says);
  RUN_TEST(test_opencv_should_be_refused_when_coefficients_or_matrix_say_more_than_is_known);
  RUN_TEST(test_matrix_should_be_read_in_rows_and_under_the_names_of_other_programs);
  RUN_TEST(test_openvslam_should_be_read_flat_and_nested);
  RUN_TEST(test_openvslam_should_be_refused_when_coefficients_are_of_the_other_model);
  RUN_TEST(test_vins_should_be_read_in_its_models);
  RUN_TEST(test_ros_messages_should_be_read_as_either_ros_prints_them);
  RUN_TEST(test_ros_should_apply_roi_refuse_binning_and_note_rectification);
  RUN_TEST(test_kitti_raw_should_be_read_as_rectified_with_its_size);
  RUN_TEST(test_colmap_should_be_read_with_its_centre_moved_by_half_a_pixel);
  RUN_TEST(test_numbers_alone_should_be_read_with_distortion_where_they_have_it);
  RUN_TEST(test_mono_vo_should_be_read_in_its_models_and_shares_of_the_size);
  RUN_TEST(test_settings_that_name_a_calibration_should_be_refused_with_its_name);
  RUN_TEST(test_orb_slam_should_not_take_rectified_numbers_for_those_of_the_camera);
  return UNITY_END();
}

#else

int main() { SKIP_PROGRAM("this build has no platform layer"); }

#endif
