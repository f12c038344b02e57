/* Image sequences and films on disk, their calibration and their targets, as the structures of planefold.h.
 *
 *   char message[PF_SEQUENCE_MESSAGE];
 *   pf_sequence_t *sequence;
 *   if (pf_open_sequence("images:/data/desk", NULL, &sequence, message) != 0) puts(message);
 *   pf_sequence_info_t info;
 *   pf_get_sequence_info(sequence, &info);       config.camera = info.camera;
 *   pf_read_sequence_frame(sequence, i, &image, message);
 *   pf_close_sequence(sequence);
 *
 * Every function that can fail returns 0, or -1 with one line of plain text in message that names the file, says what is
 * wrong with it and what to do (pf_open_sequence and pf_read_sequence_frame know more values). Files are not trusted: whatever
 * they hold, the answer is one of the two. What is to be noted of a calibration comes with 0, each note on a line of its own. This is the
 * desktop side: it uses the heap and the file system. A sequence belongs to one thread at a time.
 */
#ifndef PLANEFOLD_PLATFORM_SEQUENCE_H
#define PLANEFOLD_PLATFORM_SEQUENCE_H

#include <planefold/planefold.h>

#ifdef __cplusplus
extern "C" {
#endif

#define PF_SEQUENCE_MESSAGE 4096 /* bytes of a message, with its terminating zero */

/* As a calibration: none is read. Only the size in the camera means something then, which is that of the first image. */
#define PF_SEQUENCE_UNCALIBRATED "uncalibrated"

typedef struct pf_sequence pf_sequence_t;

typedef struct pf_sequence_info {
  pf_camera_t camera;
  int64_t count; /* frames; of a film at most */
  int64_t first_t_ns, last_t_ns;
  double rate_hz;   /* as the calibration says, or else from the times */
  int32_t in_order; /* 1: a film. Frames are read in their order; to go back costs all that came before */
  const char*
      folder; /* of a film its file. These eight are valid until the sequence is closed; "" where there is none */
  const char* calibration_path;
  const char* calibration_form; /* as in the table at pf_read_calibration, or "none" */
  const char* camera_name;      /* of the camera that was taken, where the calibration names its cameras: "cam0" */
  const char* truth_path;       /* a trajectory beside the images: TUM, or EuRoC's data.csv of the body */
  const char* warning;          /* what had to be assumed: each on a line of its own, with '\n' between them */
  const char* imu_path;         /* inertial samples beside the images, for pf_read_imu */
  const char* mask_path;        /* mask.png beside the images, for pf_read_mask */
} pf_sequence_info_t;

/* What pf_open_sequence returns where it is the calibration that is wrong. */
#define PF_SEQUENCE_WRONG_CALIBRATION (-3)

/* Sources:
 *   video:FILE  a film in any form that ffmpeg reads; the programs ffprobe and ffmpeg must be installed. Its frames become grey as ffmpeg
 *               shows them (rotated and cropped where the film says so), at the film's own times; none is dropped or repeated. The
 *               calibration is of the pictures as shown, and is always given.
 *   images:DIR  images/ (or KITTI's image_0/ or image_2/, the images themselves, or the only folder inside that holds images), times.txt
 *               (or timestamps.txt, or either as .csv), calib.yaml or KITTI's calib.txt. Without a table, times in the names are taken
 *               (12.05.png, 1403636579763555584.png), or else the names in natural order at the calibration's rate_hz, or 30 Hz, with a
 *               warning. Where images of several kinds lie side by side (frame-000000.color.png, frame-000000.depth.png), those in colour
 *               or grey are taken; previews and single files of another name are left out; what is ambiguous is an error.
 *   images:DIR/left_*.png   the images of that name only
 *   euroc:DIR   mav0/cam0/data, data.csv and sensor.yaml; DIR may also be mav0 or cam0, or of the layout above.
 *   tum:DIR     rgb.txt and rgb/; the calibration is calib.yaml inside, or ETH3D's calibration.txt, or given.
 * A table of frames has the columns that its header names (time, name, index, exposure; units as in "time [us]" or timestamp_ns), or one
 * of the forms time | time name | name time | index time name | name or index, time, exposure. It is cut at commas, semicolons or blanks,
 * and may have quotes and byte order marks. Times are seconds (euroc: nanoseconds); where that gives no camera's rate, they are taken in
 * the unit, or as frame numbers, that gives the calibration's rate_hz, with a warning. Other columns are errors.
 * Inertial samples are looked for in imu.csv or gyro_accel.csv (images:) and in imu0/data.csv beside cam0 (euroc:).
 * PNG, JPEG and binary PGM; colour becomes grey, 16 bits become 8 (of a PNG, 65535 is white, but data of 14 bits or fewer are scaled up and
 * raw thermal images stretched, with a warning). Pixels are taken as stored, whatever EXIF says of the orientation, and so must the
 * calibration. Hidden files are left out. Times must grow from frame to frame.
 * calibration  a file in one of the forms of pf_read_calibration; null: the one inside DIR, calib.yaml or another name that the layout has;
 *              of images: also the one file of such a form there or else beside the images; an error where several differ
 * camera       of a calibration of several: its name there or the number that ends it; null: the one that the folder of the images is
 *              named after, or the first, and then a note names the others */
int pf_open_sequence_of(const char* source, const char* calibration, const char* camera, pf_sequence_t** sequence,
                        char message[PF_SEQUENCE_MESSAGE]);
/* The same with camera null. */
int pf_open_sequence(const char* source, const char* calibration, pf_sequence_t** sequence,
                     char message[PF_SEQUENCE_MESSAGE]);
void pf_close_sequence(pf_sequence_t* sequence); /* null is welcome */
void pf_get_sequence_info(const pf_sequence_t* sequence, pf_sequence_info_t* info);

/* What pf_read_sequence_frame returns where this image alone cannot be used: it is missing, empty or damaged. The next may be read. */
#define PF_SEQUENCE_UNUSABLE_IMAGE (-2)
/* Likewise where a film has fewer frames than its file lists: there is no frame of this number, and message says where it ended. */
#define PF_SEQUENCE_END (-4)

/* Frame number index of 0 .. count-1. The pixels are valid until the next call with this sequence. An image of another
 * size than the calibration's is an error (but a single one among images of the right size is unusable), and so is one
 * of another type than the first that was read (grey or colour, 8 or 16 bits). A
 * JPEG of which libjpeg warns counts as damaged. */
int pf_read_sequence_frame(pf_sequence_t* sequence, int64_t index, pf_image_t* image,
                           char message[PF_SEQUENCE_MESSAGE]);

/* A mask of images of this size, as pf_mask_t has it: a PNG of grey levels 0 (ignored) and 255 (scene) alone. Sets width * height bytes of
 * pixels, row by row. One beside the images is called mask.png, in their folder or the one above, and is none of them. */
int pf_read_mask(const char* path, int32_t width, int32_t height, uint8_t* pixels, char message[PF_SEQUENCE_MESSAGE]);

/* File of a frame, for messages. */
const char* pf_get_sequence_frame_path(const pf_sequence_t* sequence, int64_t index);

/* A calibration file, in one of these forms:
 *
 *   form        whose                                 known by            read as                                cameras
 *   kalibr      Kalibr's camchain, OpenVINS           cam0:               pinhole: radtan, equidistant, none     cam0, cam1, ..
 *   euroc       EuRoC's sensor.yaml                   intrinsics:         the same
 *   ros         ROS camera_info, as a file or as      camera_matrix: with plumb_bob, equidistant, rational_
 *               rostopic and ros2 topic print it      distortion_model:,  polynomial with zeros behind k3; roi is
 *                                                     K: or k:            applied, binning refused
 *   opencv      OpenCV's calibration sample           camera_matrix:      5 coefficients; 4 with fisheye_model
 *   vins        VINS-Fusion, VINS-Mono (camodocal)    model_type:         PINHOLE, KANNALA_BRANDT, MEI with xi 0
 *   openvslam   OpenVSLAM, stella_vslam               Camera.model:       perspective, fisheye
 *   orb-slam3   ORB-SLAM3                             Camera1.fx:         PinHole, KannalaBrandt8, Rectified     Camera1, Camera2
 *   orb-slam    ORB-SLAM, ORB-SLAM2                   Camera.fx:          the same                               Camera, LEFT, RIGHT
 *   kitti       KITTI's calib.txt                     P0:                 rectified pinhole                      P0 .. P3
 *               and calib_cam_to_cam.txt              P_rect_00:          the same                               P_rect_00 .. P_rect_03
 *   colmap      COLMAP's cameras.txt                  its rows            (SIMPLE_)PINHOLE, (SIMPLE_)RADIAL,     camera 1, ..
 *                                                                         OPENCV, OPENCV_FISHEYE
 *   eth3d       ETH3D's calibration.txt               fx fy cx cy, alone  pinhole; radtan with k1 k2 p1 p2 k3 behind them
 *   mono_vo     camera.txt of the mono-VO data set    its four rows       Pinhole, RadTan, EquiDistant
 *   plain       this project, and files by hand       fx:                 none, radtan, equidistant,
 *                                                                         harris_division
 *
 * The plain form is camera_model: pinhole / width / height / fx / fy / cx / cy / distortion_model / distortion: [..] / rate_hz (optional);
 * without distortion and its model there is none. COLMAP's centre of the first pixel is 0.5, 0.5; it becomes 0, 0, as in the others.
 * KITTI's calib.txt and ETH3D's do not say the size of the images, and those of ORB-SLAM, OpenVSLAM and OpenCV not always: such a file is
 * read by pf_open_sequence only, which takes the size of the first image.
 * Each may have readout_s, of a rolling shutter [s], timestamps: real | nominal (pf_timestamps_t; real), and say how well its numbers
 * are known (pf_camera_t): sigma_focal, sigma_aspect, sigma_centre_px, sigma_distortion: [..]; where one is missing, a typical value
 * is filled in: 0.01, 0.001, 1 % of the width, and for distortion zeros, or 0.05 where the file names none. rate_hz (may be null) is 0
 * where the file does not state it.
 * A field is an error that is there twice, looks misspelled, or may change what others mean (another model, further coefficients,
 * images of another size), and so is any unknown one of the plain form; other unknown fields are ignored with a note.
 * which  as camera of pf_open_sequence_of; null: the first, with a note that names the others */
int pf_read_calibration_of(const char* path, const char* which, pf_camera_t* camera, double* rate_hz,
                           char message[PF_SEQUENCE_MESSAGE]);
/* The same with which null. */
int pf_read_calibration(const char* path, pf_camera_t* camera, double* rate_hz, char message[PF_SEQUENCE_MESSAGE]);

/* The same from text in memory; name stands for the file in messages. */
int pf_parse_calibration_of(const char* text, size_t size, const char* name, const char* which, pf_camera_t* camera,
                            double* rate_hz, char message[PF_SEQUENCE_MESSAGE]);
int pf_parse_calibration(const char* text, size_t size, const char* name, pf_camera_t* camera, double* rate_hz,
                         char message[PF_SEQUENCE_MESSAGE]);

typedef enum pf_calibration_form { PF_CALIBRATION_PLAIN = 0, PF_CALIBRATION_EUROC = 1 } pf_calibration_form_t;

/* The plain form, or EuRoC's sensor.yaml, of which pf_read_calibration makes the same camera again, bit for bit. rate_hz is left out
 * when it is 0. */
int pf_write_calibration(const char* path, uint32_t form, const pf_camera_t* camera, double rate_hz,
                         char message[PF_SEQUENCE_MESSAGE]);

/* A target file (with 0, message is a line on what is hardly meant, or empty):
 *   width, height [m], sigma [m] (optional, 0.0005), and where it is in W:
 *     q_WT: [w, x, y, z], p_WT: [x, y, z] [m] (both or neither)                     a dark rectangle
 *   points: [[x, y, z], ..] [m], first_pose: {position: [x, y, z], quaternion_wxyz: [w, x, y, z],
 *     sigma_position [m] (optional, 0.02), sigma_rotation [rad] (optional, 0.05)}, sigma [m] (optional, 0.001)
 *     (T_WC is welcome as another name of first_pose)                               known points
 *   features, start_camera_position, start_camera_quat_wxyz, sigma (optional)       known points in SceneLib's form */
int pf_read_target(const char* path, pf_target_t* target, char message[PF_SEQUENCE_MESSAGE]);

/* The pose of the first frame, from one line of a TUM trajectory with its sigmas behind it:
 *   seconds x y z qx qy qz qw [sigma_position_m sigma_rotation_deg]
 * in metres; the sigmas are of each axis, 0.02 m and 3 degrees where there are none. Empty lines and such that begin with # are passed
 * over. t_ns is 0, and velocities are zero. */
int pf_read_first_pose(const char* path, pf_pose_t* pose, char message[PF_SEQUENCE_MESSAGE]);

/* "0.1832x0.1295" in metres, as a rectangle. */
int pf_parse_rectangle(const char* text, pf_target_t* target, char message[PF_SEQUENCE_MESSAGE]);

/* Inertial samples: rows of time, rates and accelerations, in columns that a header names, with their units, among any others
 * ("gyro_x [deg/s]", "field.angular_velocity.x", "accelerometerAccelerationX(G)"), or without a header in the order of EuRoC's
 * imu0/data.csv: t, wx, wy, wz [rad/s], ax, ay, az [m/s^2]. Cut by commas, semicolons or blanks.
 *   units   of times s, ms, us, ns, of rates rad/s, deg/s, of accelerations m/s^2, g; without one as above, and times are whole
 *           nanoseconds, or seconds with a decimal point. Where no unit samples at such a rate times are taken as milliseconds or
 *           microseconds.
 *   signs   of iOS (Core Motion), by its names, become those of a specific force: +9.8 upwards at rest
 *   gravity of a column or file of its own is added to accelerations that are without
 *   order   times up to 50 ms late are put in order, and rows that repeat a time passed over; further back, or standing still, is an error
 * path  a file; GYRO+ACCEL, a file for each; or a folder with both (Gyroscope.csv, Accelerometer.csv and the like), of which accelerations
 *       are taken between two, at the times of the rates
 * With 0, message says in one line what was converted, mended or left out, or is empty. *samples is to be given to pf_free_imu. */
int pf_read_imu(const char* path, pf_imu_sample_t** samples, size_t* count, char message[PF_SEQUENCE_MESSAGE]);
void pf_free_imu(pf_imu_sample_t* samples); /* null is welcome */

/* The same from text in memory; name stands for the file in messages. */
int pf_parse_imu(const char* text, size_t size, const char* name, pf_imu_sample_t** samples, size_t* count,
                 char message[PF_SEQUENCE_MESSAGE]);

/* Noise densities of an inertial unit: Kalibr's imu.yaml, EuRoC's imu0/sensor.yaml (gyroscope_noise_density and so on, with : or =),
 * ORB-SLAM3's IMU.NoiseGyro and so on, imu_utils' Gyr and Acc (of single samples: divided by the root of its update_rate, or of 200 Hz), or
 * gyro_noise_density, gyro_random_walk, accel_noise_density, accel_random_walk; each may have gravity [m/s^2], 9 .. 11. Sets these fields
 * of *imu, gravity only where the file has it, and none on an error. A density that no unit has (degrees, or the noise of single
 * samples) is an error. With 0, message is a note on what was ignored, or empty. */
int pf_read_imu_noise(const char* path, pf_imu_model_t* imu, char message[PF_SEQUENCE_MESSAGE]);

/* How the unit B is mounted, by one of these fields; matrices are of 4 x 4 numbers in rows, one list or four.
 *   p_B = T p_C: T_BS (EuRoC's cam0/sensor.yaml), T_imu_cam (OpenVINS, plain), body_T_cam0 (VINS-Fusion), IMU.T_b_c1 and Tbc (ORB-SLAM),
 *                extrinsicRotation and extrinsicTranslation (VINS-Mono)
 *   p_C = T p_B: T_cam_imu (Kalibr)
 * timeshift_cam_imu (Kalibr, OpenVINS) or td (VINS) beside it becomes delay_s. Fields that say the same must agree. Sets q_BC, p_BC and
 * delay_s of *imu.
 * camera  of a file of several: its name or number; null, or where it is not there: the first, with a note that names the others */
int pf_read_imu_mount_of(const char* path, const char* camera, pf_imu_model_t* imu, char message[PF_SEQUENCE_MESSAGE]);
/* The same with camera null. */
int pf_read_imu_mount(const char* path, pf_imu_model_t* imu, char message[PF_SEQUENCE_MESSAGE]);

/* The same from text in memory; name stands for the file in messages. */
int pf_parse_imu_noise(const char* text, size_t size, const char* name, pf_imu_model_t* imu,
                       char message[PF_SEQUENCE_MESSAGE]);
int pf_parse_imu_mount_of(const char* text, size_t size, const char* name, const char* camera, pf_imu_model_t* imu,
                          char message[PF_SEQUENCE_MESSAGE]);
int pf_parse_imu_mount(const char* text, size_t size, const char* name, pf_imu_model_t* imu,
                       char message[PF_SEQUENCE_MESSAGE]);

/* A folder for what a program writes. It is made where it is missing. Its list .planefold names what was written there: where there is
 * one, the files that it names are deleted, and no others. A folder that holds anything and has no list is an error, and stays untouched.
 * option  how the user names the folder, for messages: "--out" */
int pf_open_output_folder(const char* folder, const char* option, char message[PF_SEQUENCE_MESSAGE]);

/* The error that pf_open_output_folder would return; changes nothing. */
int pf_check_output_folder(const char* folder, const char* option, char message[PF_SEQUENCE_MESSAGE]);

/* Refuses a folder from which pf_open_output_folder would delete what the program reads: input is a file, or a folder of images. */
int pf_check_output_input(const char* folder, const char* option, const char* input, char message[PF_SEQUENCE_MESSAGE]);

/* Adds a name to the list, before the file is made: relative to the folder; with a / at its end it is a folder. Refused where such a
 * file is there that is not on the list. */
int pf_add_output_file(const char* folder, const char* name, char message[PF_SEQUENCE_MESSAGE]);

#ifdef __cplusplus
}
#endif

#endif
