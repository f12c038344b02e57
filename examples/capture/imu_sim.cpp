#include "imu.h"

#ifdef PLANEFOLD_HAVE_SIM

#include <planefold_platform/sim.h>

namespace pf::capture {

namespace {

/// A simulated unit, whose noise and mounting are known.
class ImuSim : public Imu {
 public:
  ImuSim(pf_sim_imu_t* imu, const pf_imu_model_t& model, int64_t offset_ns)
      : imu_(imu, pf_sim_imu_close), model_(model), offset_ns_(offset_ns) {}

  bool start(std::string&) override { return true; }

  void take(int64_t until_ns, std::vector<pf_imu_sample_t>& samples) override {
    while (pf_sim_imu_next_ns(imu_.get()) + offset_ns_ <= until_ns) {
      pf_imu_sample_t sample{};
      pf_sim_imu_next(imu_.get(), &sample);
      sample.t_ns += offset_ns_;
      samples.push_back(sample);
    }
  }

  std::string name() const override { return "sim"; }
  const pf_imu_model_t* model() const override { return &model_; }

 private:
  std::unique_ptr<pf_sim_imu_t, void (*)(pf_sim_imu_t*)> imu_;
  pf_imu_model_t model_;
  int64_t offset_ns_;
};

}  // namespace

std::unique_ptr<Imu> open_imu_sim(const pf_sim* scene, uint64_t seed, int64_t offset_ns) {
  pf_sim_imu_options_t options{};
  pf_sim_imu_options_default(&options);
  options.seed = seed;
  pf_sim_imu_t* imu = pf_sim_imu_open(scene, &options);
  return imu != nullptr ? std::make_unique<ImuSim>(imu, options.model, offset_ns) : nullptr;
}

}  // namespace pf::capture

#endif
