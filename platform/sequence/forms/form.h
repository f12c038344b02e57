#ifndef PLANEFOLD_PLATFORM_SEQUENCE_FORMS_FORM_H
#define PLANEFOLD_PLATFORM_SEQUENCE_FORMS_FORM_H

#include <string>
#include <vector>

#include "../calibration.h"
#include "../yaml_fields.h"

namespace pf::sequence {

/// A form of calibration files. A new one is a file of its own in this folder and a row in forms.cpp.
struct Form {
  const char* name;   ///< Calibration::form
  const char* label;  ///< for the list of known forms: whose it is, and what it is known by
  /// Whether the fields have what the form is known by.
  bool (*is)(const Fields& fields);
  /// Reads camera and rate, and checks that no other field changes what they mean. Throws ReadError.
  void (*read)(const Fields& fields, const Asked& asked, Calibration& calibration);
};

extern const Form kColmapForm, kEth3dForm, kEurocForm, kKalibrForm, kKittiForm, kKittiRawForm, kOpencvForm, kMonoVoForm,
    kOpenvslamForm, kOrbSlamForm, kOrbSlam3Form, kPlainForm, kRosForm, kRosMessageForm, kVinsForm;

/// In the order in which they are tried.
const std::vector<const Form*>& all_forms();

/// The fields of a form, with those that each may have beside: readout_s and so on.
Fields::Known known_fields(std::vector<std::string> read, std::vector<std::string> unused = {});

/// A camera of a file: its name, and names of folders that stand for it.
struct NamedCamera {
  std::string name;
  std::vector<std::string> folders;
};

/// The camera that is asked for, or that a folder of the images is named after, or the first. Where there are several, a note names them,
/// unless is_layout says that the folder's name alone decides.
size_t choose_camera(const Fields& fields, const std::vector<NamedCamera>& cameras, const Asked& asked, bool is_layout,
                     std::vector<std::string>& notes);

/// cam0, cam1, .. of a camchain, in the order of their numbers.
std::vector<NamedCamera> kalibr_cameras(const Fields& fields);

/// Rows of COLMAP's cameras.txt as fields "camera ID: MODEL WIDTH HEIGHT PARAMETERS"; any other text as it is.
std::string from_colmap(const std::string& text);

/// A row of four to nine numbers, as ETH3D has it, as a field; any other text as it is.
std::string from_eth3d(const std::string& text);

/// camera.txt of the photometric mono-VO data set as fields; any other text as it is.
std::string from_mono_vo(const std::string& text);

/// The number of frames per second of a field, or 0 where it is missing.
double read_rate(const Fields& fields, const char* key);

}  // namespace pf::sequence

#endif
