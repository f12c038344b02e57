#include <algorithm>

#include "form.h"

namespace pf::sequence {

const std::vector<const Form*>& all_forms() {
  // A form that has what another is known by, and more, comes before it. All but the plain one are read for what others wrote.
  static const std::vector<const Form*> forms = {&kKalibrForm,  &kEurocForm,  &kRosForm,       &kRosMessageForm,
                                                 &kOpencvForm,  &kVinsForm,   &kOpenvslamForm, &kOrbSlam3Form,
                                                 &kOrbSlamForm, &kKittiForm,  &kKittiRawForm,  &kColmapForm,
                                                 &kEth3dForm,   &kMonoVoForm, &kPlainForm};
  return forms;
}

Fields::Known known_fields(std::vector<std::string> read, std::vector<std::string> unused) {
  for (const char* name :
       {"readout_s", "timestamps", "sigma_focal", "sigma_aspect", "sigma_centre_px", "sigma_distortion"}) {
    if (std::find(read.begin(), read.end(), name) == read.end()) {
      read.emplace_back(name);
    }
  }
  return {std::move(read), std::move(unused)};
}

namespace {

std::string number_at_end(const std::string& name) {
  const size_t last = name.find_last_not_of("0123456789");
  const std::string digits = name.substr(last == std::string::npos ? 0 : last + 1);
  const size_t first = digits.find_first_not_of('0');
  return digits.empty() ? "" : first == std::string::npos ? "0" : digits.substr(first);
}

bool is_named(const NamedCamera& camera, const std::string& name) {
  return camera.name == name || std::find(camera.folders.begin(), camera.folders.end(), name) != camera.folders.end();
}

bool is_number(const std::string& name) { return !name.empty() && number_at_end(name) == name; }

}  // namespace

size_t choose_camera(const Fields& fields, const std::vector<NamedCamera>& cameras, const Asked& asked, bool is_layout,
                     std::vector<std::string>& notes) {
  std::string names;
  for (size_t i = 0; i < cameras.size(); ++i) {
    names += (i == 0 ? "" : i + 1 < cameras.size() ? ", " : " and ") + cameras[i].name;
  }
  if (!asked.camera.empty()) {
    for (size_t i = 0; i < cameras.size(); ++i) {
      const bool by_number = is_number(asked.camera) && number_at_end(cameras[i].name) == asked.camera;
      if (is_named(cameras[i], asked.camera) || by_number) {
        return i;
      }
    }
    refuse(fields.file() + ": has no camera '" + asked.camera + "'; there " + (cameras.size() > 1 ? "are " : "is ") +
           names);
  }
  if (cameras.size() == 1) {
    return 0;
  }
  size_t chosen = cameras.size();
  for (const std::string& folder : asked.folders) {
    for (size_t i = 0; i < cameras.size() && chosen == cameras.size(); ++i) {
      chosen = is_named(cameras[i], folder) ? i : chosen;
    }
  }
  const bool by_folder = chosen < cameras.size();
  chosen = by_folder ? chosen : 0;
  if (!by_folder || !is_layout) {
    notes.push_back(fields.file() + ": has the cameras " + names + "; that of " + cameras[chosen].name + " is taken" +
                    (by_folder ? ", as the folder of the images is called" : "") + " (--camera chooses another)");
  }
  return chosen;
}

}  // namespace pf::sequence
