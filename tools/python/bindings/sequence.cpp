#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <planefold_platform/sequence.h>

#include <memory>
#include <optional>
#include <tuple>

#include "arrays.h"
#include "docs.h"
#include "errors.h"
#include "functions.h"

namespace pf::python {

namespace {

using Frame = std::tuple<GreyImage, int64_t>;

class Sequence {
 public:
  Sequence(const std::string& source, const std::optional<std::string>& calibration)
      : sequence_(nullptr, pf_close_sequence) {
    char message[PF_SEQUENCE_MESSAGE] = "";
    pf_sequence_t* opened = nullptr;
    if (pf_open_sequence(source.c_str(), calibration ? calibration->c_str() : nullptr, &opened, message) != 0) {
      raise_refused(message);
    }
    sequence_.reset(opened);
    pf_get_sequence_info(opened, &info_);
  }

  int64_t count() const { return info_.count; }
  const pf_sequence_info_t& info() const { return info_; }

  /// 0, or what pf_read_sequence_frame returns, with a message.
  int read(int64_t index, pf_image_t& image, char* message) {
    return pf_read_sequence_frame(sequence_.get(), index, &image, message);
  }

  Frame at(int64_t index) {
    const int64_t from_start = index < 0 ? index + info_.count : index;
    if (from_start < 0 || from_start >= info_.count) {
      throw nb::index_error(
          ("there are " + std::to_string(info_.count) + " frames, and no number " + std::to_string(index)).c_str());
    }
    char message[PF_SEQUENCE_MESSAGE] = "";
    pf_image_t image{};
    if (read(from_start, image, message) != 0) raise_refused(message);
    return {copy_image(image), image.t_ns};
  }

  std::string path(int64_t index) const {
    if (index < 0 || index >= info_.count) throw nb::index_error("there is no such frame");
    return pf_get_sequence_frame_path(sequence_.get(), index);
  }

 private:
  std::unique_ptr<pf_sequence_t, void (*)(pf_sequence_t*)> sequence_;
  pf_sequence_info_t info_{};
};

/// Goes through a sequence once. A damaged image is passed over, with a warning of Python that says which.
struct Frames {
  nb::object owner;
  Sequence* sequence;
  int64_t index = 0;

  Frame next() {
    char message[PF_SEQUENCE_MESSAGE] = "";
    for (; index < sequence->count();) {
      pf_image_t image{};
      const int result = sequence->read(index++, image, message);
      if (result == 0) return {copy_image(image), image.t_ns};
      if (result != PF_SEQUENCE_UNUSABLE_IMAGE) raise_refused(message);
      if (PyErr_WarnEx(PyExc_RuntimeWarning, message, 1) != 0) throw nb::python_error();
    }
    throw nb::stop_iteration();
  }
};

template <class Ask>
void add_text(nb::class_<Sequence>& type, const char* name, const char* what, const Ask& ask) {
  type.def_prop_ro(
      name, [ask](const Sequence& self) { return std::string(ask(self.info())); }, what);
}

}  // namespace

void add_sequences(nb::module_& module) {
  nb::class_<Frames>(module, "SequenceFrames", "Goes through a sequence once.")
      .def(
          "__iter__", [](nb::handle self) { return nb::borrow(self); }, nb::sig("def __iter__(self) -> SequenceFrames"))
      .def("__next__", &Frames::next);
  nb::class_<Sequence> sequence(
      module, "Sequence",
      "Images on disk with their times and calibration: iterates over (image, t_ns). Images that cannot be "
      "used are passed over, with a warning.");
  sequence.def(nb::init<const std::string&, const std::optional<std::string>&>(), nb::arg("source"),
               nb::arg("calibration") = nb::none(), doc::pf_open_sequence);
  sequence.def("__len__", &Sequence::count);
  sequence.def("__getitem__", &Sequence::at, nb::arg("index"), doc::pf_read_sequence_frame);
  sequence.def("__iter__", [](nb::object self) { return Frames{self, nb::inst_ptr<Sequence>(self)}; });
  sequence.def("path", &Sequence::path, nb::arg("index"), doc::pf_get_sequence_frame_path);
  sequence.def_prop_ro(
      "camera", [](const Sequence& self) { return self.info().camera; }, "The calibration.");
  sequence.def_prop_ro(
      "rate_hz", [](const Sequence& self) { return self.info().rate_hz; },
      "As the calibration says, or else from the times.");
  sequence.def_prop_ro(
      "first_t_ns", [](const Sequence& self) { return self.info().first_t_ns; }, "Time of the first frame.");
  sequence.def_prop_ro(
      "last_t_ns", [](const Sequence& self) { return self.info().last_t_ns; }, "Time of the last frame.");
  add_text(sequence, "folder", "Where the images lie.", [](const pf_sequence_info_t& info) { return info.folder; });
  add_text(sequence, "calibration_path", "The file that was read; empty where there is none.",
           [](const pf_sequence_info_t& info) { return info.calibration_path; });
  add_text(sequence, "truth_path", "A trajectory beside the images, for planefold.eval; empty where there is none.",
           [](const pf_sequence_info_t& info) { return info.truth_path; });
  add_text(sequence, "imu_path", "Inertial samples beside the images, for read_imu; empty where there are none.",
           [](const pf_sequence_info_t& info) { return info.imu_path; });
  add_text(sequence, "mask_path", "A mask beside the images, for Slam.set_mask; empty where there is none.",
           [](const pf_sequence_info_t& info) { return info.mask_path; });
  add_text(sequence, "warning", "One line on what had to be assumed; empty where nothing had.",
           [](const pf_sequence_info_t& info) { return info.warning; });
}

}  // namespace pf::python
