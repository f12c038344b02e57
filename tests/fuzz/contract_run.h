// One context from its creation to its end, with calls that are drawn from bytes: most of them mean something, some are hostile.
#pragma once

#include <planefold/planefold_research.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "api/context.h"
#include "bytes.h"
#include "drawn_config.h"
#include "guarded.h"
#include "required_numbers.h"

constexpr size_t kMaxBlock = size_t{8} << 20;

/// A context with guard pages about its block and its image, what was pushed, and a world to observe.
class ContractRun {
 public:
  /// calm: of the steps that are no frame only each eighth is taken, and few frames are odd, so that maps grow old.
  explicit ContractRun(Bytes& bytes, bool calm = false)
      : bytes_(bytes), calm_(calm), config_(config_from(bytes, calm, &extended_)) {
    const char* field = nullptr;
    usable_ = status(pf_config_check(&config_, &field)) == PF_OK;
    require(usable_ == (field == nullptr), "a bad config names a field");
    require((status(pf_memory_query(&config_, &need_)) == PF_OK) == usable_, "query and check agree");
    usable_ = usable_ && need_.bytes <= kMaxBlock;
  }

  bool usable() const { return usable_; }

  struct Seen {
    long frames, tracked, metric, planes, patches;  ///< frames, and those of them that have these
    long repaired, refused_gauge;                   ///< frames that repaired a covariance; readings of the gauge
  };
  const Seen& seen() const { return seen_; }
  /// What a run that says that it repaired its covariance holds inside is not looked at any more: what float cannot hold
  /// (lib/docs/theory/float.md). What leaves the library is, in any case.
  void trust_told_repairs() { trusts_told_repairs_ = true; }

  void play(int max_steps = 120) {
    const uint8_t how = bytes_.take<uint8_t>();
    Guarded block(need_.bytes, need_.alignment, (how & 1) != 0);
    block_ = &block;
    std::memset(block.begin(), how, need_.bytes);
    require(status(pf_create(&config_, block.begin(), need_.bytes - 1, &slam_)) == PF_ERROR_MEMORY && slam_ == nullptr,
            "a block that is too small is refused");
    require(status(pf_create(&config_, block.begin(), need_.bytes, &slam_)) == PF_OK,
            "a checked config makes a context");
    stride_ = config_.camera.width + (how >> 4);
    Guarded pixels(static_cast<size_t>(stride_) * static_cast<size_t>(config_.camera.height - 1) +
                       static_cast<size_t>(config_.camera.width),
                   1, (how & 2) != 0);
    pixels_ = pixels.begin();
    for (int s = PF_ERROR_FULL - 1; s <= PF_NOTE_NOTHING + 1; ++s)
      require(pf_status_text(static_cast<pf_status_t>(s)) != nullptr, "every status has a text");
    observes_ = (how & 4) != 0 && config_.backend == PF_BACKEND_FILTER;
    t_ns_ = (how & 8) != 0 ? bytes_.take<int64_t>() : 0;
    for (double& v : velocity_) v = unit(bytes_) * 0.05;
    if (bytes_.take<uint8_t>() % 4 == 0) changing([&] { return start_from_target(); });
    if (bytes_.take<uint8_t>() % 4 == 0) changing([&] { return start_from_pose(); });
    if (extended_ && config_.backend == PF_BACKEND_FILTER && bytes_.take<uint8_t>() % 2 == 0) start_before_walls();
    for (int steps = 0; steps < max_steps && !bytes_.empty(); ++steps) step();
  }

 private:
  static pf_status_t status(pf_status_t value) {
    require(value >= PF_ERROR_FULL && value <= PF_NOTE_NOTHING, "a status is one that the header names");
    return value;
  }

  /// A call that may change the context. What it refuses leaves the block as it was.
  template <class Call>
  pf_status_t changing(const Call& call) {
    const uint64_t before = block_->hash();
    const pf_status_t result = status(call());
    if (result < PF_OK) require(block_->hash() == before, "what is refused changes nothing");
    if (result >= PF_OK) look();
    return result;
  }

  /// A call that only asks.
  template <class Call>
  void asking(const Call& call) {
    const uint64_t before = block_->hash();
    call();
    require(block_->hash() == before, "a call that asks changes nothing");
  }

  void step() {
    const uint8_t what = bytes_.take<uint8_t>();
    if (what < 160 || (calm_ && bytes_.take<uint8_t>() % 8 != 0)) {
      next_frame();
      return;
    }
    switch (what % 12) {
      case 0:
        changing([&] { return hostile_frame(); });
        break;
      case 1:
        changing([&] { return hostile_observations(); });
        break;
      case 2:
        changing([&] { return imu(); });
        break;
      case 3: {
        double dv[3], dw[3];
        for (int i = 0; i < 3; ++i) dv[i] = what < 200 ? unit(bytes_) * 0.02 : hostile(bytes_);
        for (int i = 0; i < 3; ++i) dw[i] = what < 200 ? unit(bytes_) * 0.02 : hostile(bytes_);
        changing([&] { return pf_push_control(slam_, dv, dw); });
        break;
      }
      case 4: {
        const double gravity[3] = {hostile(bytes_), hostile(bytes_), hostile(bytes_)};
        changing([&] { return pf_set_gravity(slam_, gravity); });
        const uint32_t plane = bytes_.take<uint8_t>();
        const uint8_t sigma = bytes_.take<uint8_t>();
        changing([&] { return pf_set_plane_vertical(slam_, plane, sigma < 128 ? sigma / 256.0 : hostile(bytes_)); });
        break;
      }
      case 5:
        changing([&] { return bytes_.take<uint8_t>() % 4 != 0 ? pf_mark_pose(slam_) : pf_withdraw_target(slam_); });
        changing([&] { return change_anchors(); });
        break;
      case 6:
        if (bytes_.take<uint8_t>() % 8 == 0) {
          require(changing([&] { return pf_reset(slam_); }) == PF_OK, "reset");
          pushed_ = false;
        } else if (extended_) {
          changing([&] { return add_wall(what >= 224); });
        }
        break;
      case 7:
        for (double& v : velocity_) v = unit(bytes_) * 0.05;
        break;
      case 8:
        pattern_ = bytes_.take<uint8_t>();
        break;
      case 9:  // too late, but for a context without a frame
        changing([&] { return bytes_.take<uint8_t>() % 2 == 0 ? start_from_target() : start_from_pose(); });
        break;
      case 10:
        asking([&] { ask(); });
        break;
      default:
        asking([&] { ask_camera(); });
        break;
    }
  }

  void taken(int64_t t_ns) {
    t_ns_ = last_t_ns_ = t_ns;
    pushed_ = true;
  }

  void next_frame() {
    uint8_t how = bytes_.take<uint8_t>();
    if (calm_ && how < 252) how %= 31;  // no jump, and the usual interval
    int64_t dt = how < 224 ? 33333333 : int64_t{1} << (how % 40);
    dt = t_ns_ > INT64_MAX - dt ? INT64_MAX - t_ns_ : dt;
    t_ns_ += dt;
    const bool late = pushed_ && t_ns_ <= last_t_ns_;
    const bool rests = extended_ && frames_++ < kRest;  // long enough for gravity
    for (int i = 0; i < 3 && !rests; ++i) {
      if (calm_ && position_[i] * velocity_[i] > 0 && std::fabs(position_[i]) > kFarthest) velocity_[i] = -velocity_[i];
      position_[i] += velocity_[i];
    }
    if (extended_ && config_.motion.model == PF_MOTION_INERTIAL && how % 64 != 63) push_samples();
    if (how % 32 == 31) position_[0] += 1;  // a jump
    pf_status_t result = PF_OK;
    if (observes_) {
      const std::vector<pf_observation_t> seen = observe(how);
      result = changing([&] { return pf_push_observations(slam_, t_ns_, seen.data(), seen.size()); });
      require(result >= PF_OK || late || result == PF_ERROR_STATE, "observations that are right are taken");
    } else {
      paint();
      const pf_image_t image = {pixels_, config_.camera.width, config_.camera.height, stride_, t_ns_};
      result = changing([&] { return pf_push_frame(slam_, &image); });
      require(result >= PF_OK || late || result == PF_ERROR_STATE, "a frame that is right is taken");
    }
    if (late) require(result < PF_OK, "a time that stands still is refused");
    if (result >= PF_OK) taken(t_ns_);
    if (result >= PF_OK) {
      pf_state_t state;
      require(pf_get_state(slam_, &state) == PF_OK, "a state");
      require(result != PF_OK || state == PF_STATE_TRACKING, "PF_OK is tracking");
      require(result != PF_NOTE_STARTING || state == PF_STATE_STARTING, "starting is starting");
      require(result != PF_NOTE_COASTING || state == PF_STATE_COASTING, "coasting is coasting");
      require(result != PF_NOTE_LOST || state == PF_STATE_LOST, "lost is lost");
      count_frame(result);
    }
  }

  void count_frame(pf_status_t result) {
    pf_report_t report;
    pf_get_report(slam_, &report);
    ++seen_.frames;
    seen_.tracked += result == PF_OK ? 1 : 0;
    pf_inertial_t inertial;
    seen_.metric += pf_get_inertial(slam_, &inertial) == PF_OK && inertial.metric != 0 ? 1 : 0;
    seen_.planes += report.planes > 0 ? 1 : 0;
    seen_.patches += report.patches > 0 ? 1 : 0;
    seen_.repaired = report.covariance_repairs;
  }

  /// Up to the frame, of a unit that lies still but for noise; a camera that moves speeds up unseen.
  void push_samples() {
    const int64_t step = 5000000, span = 20 * step;
    if (t_ns_ < INT64_MIN + span) return;
    imu_t_ns_ = std::max(imu_t_ns_, t_ns_ - span);
    while (imu_t_ns_ <= t_ns_ - step) {
      imu_t_ns_ += step;
      noise_ = noise_ * 6364136223846793005u + 1442695040888963407u;
      const double e = static_cast<double>(noise_ >> 40) / 0x800000 - 1;
      const pf_imu_sample_t sample = {imu_t_ns_, {0.001 * e, -0.002 * e, 0.001}, {0.01 * e, -9.81, 0.02 * e}};
      status(pf_push_imu(slam_, &sample, 1));
    }
  }

  /// A pose that is known well enough, and the nearer of the walls that are painted, or the one of the points.
  void start_before_walls() {
    pf_pose_t pose;
    std::memset(static_cast<void*>(&pose), 0, sizeof(pose));
    double velocity_covariance[36] = {};
    pose.q_WC[0] = 1;
    for (int i = 0; i < 6; ++i) pose.covariance[7 * i] = between(bytes_, 1e-8, 1e-2);
    for (int i = 0; i < 6; ++i) velocity_covariance[7 * i] = between(bytes_, 1e-6, 1);
    changing([&] { return pf_start_from_pose(slam_, &pose, velocity_covariance); });
    const int walls = 1 + bytes_.take<uint8_t>() % 3;
    for (int i = 0; i < walls; ++i) changing([&] { return add_wall(false); });
  }

  pf_status_t add_wall(bool is_hostile) {
    pf_wall_prior_t wall;
    std::memset(static_cast<void*>(&wall), 0, sizeof(wall));
    const double slant = 0.05 * unit(bytes_), c = std::cos(slant), s = std::sin(slant);
    const double R[9] = {1, 0, 0, 0, -c, -s, 0, s, -c};
    std::memcpy(wall.R_WP, R, sizeof(R));
    for (double& p : wall.p_WP) p = 0.1 * unit(bytes_);
    wall.p_WP[2] += observes_ ? 2.0 : config_.camera.fx / 40;
    for (int i = 0; i < 3; ++i) wall.covariance[4 * i] = between(bytes_, 1e-8, 0.1);
    wall.outline_count = 3 + bytes_.take<uint8_t>() % 6;
    for (int i = 0; i < wall.outline_count; ++i) {
      const double a = 2 * 3.14159265358979 * i / wall.outline_count;
      wall.outline_P[i][0] = 3 * std::cos(a);
      wall.outline_P[i][1] = 3 * std::sin(a);
    }
    wall.two_sided = bytes_.take<uint8_t>() % 2;
    if (is_hostile) {
      switch (bytes_.take<uint8_t>() % 6) {
        case 0:
          wall.covariance[bytes_.take<uint8_t>() % 9] = hostile(bytes_);
          break;
        case 1:
          wall.R_WP[bytes_.take<uint8_t>() % 9] = hostile(bytes_);
          break;
        case 2:
          wall.outline_P[bytes_.take<uint8_t>() % PF_OUTLINE_MAX][0] = hostile(bytes_);
          break;
        case 3:
          wall.outline_count = bytes_.take<int8_t>();
          break;
        case 4:
          wall.roughness = hostile(bytes_);
          break;
        default:
          wall.p_WP[bytes_.take<uint8_t>() % 3] = hostile(bytes_);
          break;
      }
    }
    uint32_t id = 0, current = 0;
    const pf_status_t result = pf_add_wall(slam_, &wall, &id);
    if (result == PF_OK)
      require(pf_find_plane(slam_, id, &current) == PF_OK && current == id, "a wall is found by its id");
    return result;
  }

  /// A wall of blocks whose grey levels are hashed from their place, and a nearer one before it, both seen by the moving camera.
  void paint() const {
    const double u = position_[0] * 40, v = position_[1] * 40, scale = 1 + 0.2 * std::sin(position_[2]);
    for (int y = 0; y < config_.camera.height; ++y) {
      for (int x = 0; x < config_.camera.width; ++x) {
        int X = static_cast<int>(std::floor(x * scale + u)) + 4096,
            Y = static_cast<int>(std::floor(y * scale + v)) + 4096;
        if ((X / 32 + Y / 32) % 3 == 0) {
          X = static_cast<int>(std::floor(x + u / 2)) + 9000;
          Y = static_cast<int>(std::floor(y + v / 2)) + 9000;
        }
        uint32_t h = static_cast<uint32_t>(X / 3) * 2654435761u ^ static_cast<uint32_t>(Y / 3) * 40503u;
        h = (h ^ h >> 15) * 2246822519u;
        uint8_t grey = static_cast<uint8_t>(h >> 24);
        if (pattern_ % 8 == 1) grey = static_cast<uint8_t>(pattern_);
        if (pattern_ % 8 == 2) grey = (x / 6 + y / 6) % 2 == 0 ? 230 : 20;
        if (pattern_ % 8 == 3) grey = x > 12 && y > 10 && x < 36 && y < 30 ? 15 : 220;
        if (pattern_ % 8 == 4) {  // a dark rectangle on a light ground, on the nearer wall
          const double rx = std::fabs(x + u - config_.camera.width / 2.0),
                       ry = std::fabs(y + v - config_.camera.height / 2.0);
          if (rx < config_.camera.width / 4.0 && ry < config_.camera.width / 5.0) grey = 220;
          if (rx < config_.camera.width / 6.0 && ry < config_.camera.width / 8.0) grey = 15;
        }
        // No two images of a camera are the same to the last bit.
        if (extended_) grey = static_cast<uint8_t>(grey ^ (h * static_cast<uint32_t>(frames_) >> 31));
        pixels_[y * stride_ + x] = grey;
      }
    }
  }

  std::vector<pf_observation_t> observe(uint8_t how) {
    std::vector<pf_observation_t> seen;
    const uint32_t points = 20 + pattern_ % 40;
    for (uint32_t i = 0; i < points; ++i) {
      const uint32_t h = (i + 1) * 2654435761u;
      const double z = (pattern_ & 64) != 0 ? 2.0 : 1.0 + (h >> 24) / 100.0;
      const double p_C[3] = {(h % 997) / 400.0 - 1.25 - position_[0], (h / 997 % 997) / 500.0 - 1 - position_[1],
                             z - position_[2]};
      pf_observation_t o = {i, {}, 0.0};
      if (pf_camera_project(&config_.camera, p_C, o.pixel) != PF_OK) continue;
      if (o.pixel[0] < 0 || o.pixel[1] < 0 || o.pixel[0] > config_.camera.width - 1 ||
          o.pixel[1] > config_.camera.height - 1)
        continue;
      noise_ = noise_ * 6364136223846793005u + 1442695040888963407u;
      for (int k = 0; k < 2; ++k)
        o.pixel[k] +=
            config_.measurement.sigma_px * (static_cast<double>(noise_ >> (20 + 20 * k) & 0xfffff) / 0x80000 - 1);
      if (how % 16 == 15 && i % 7 == 0) o.pixel[0] += 20;  // a false match
      seen.push_back(o);
    }
    return seen;
  }

  pf_status_t hostile_frame() {
    pf_image_t image = {pixels_, config_.camera.width, config_.camera.height, stride_, hostile_time(bytes_, t_ns_)};
    switch (bytes_.take<uint8_t>() % 6) {
      case 0:
        image.width += 1 + bytes_.take<uint8_t>();
        break;
      case 1:
        image.height = -image.height;
        break;
      case 2:
        image.stride = bytes_.take<int32_t>() % image.width;
        break;
      case 3:
        image.pixels = nullptr;
        break;
      default:
        break;
    }
    const pf_status_t result = pf_push_frame(slam_, &image);
    if (result >= PF_OK) {
      require(image.pixels != nullptr && image.width == config_.camera.width && image.stride >= image.width,
              "a frame fits");
      require(!pushed_ || image.t_ns > last_t_ns_, "time grows");
      taken(image.t_ns);
    }
    return result;
  }

  pf_status_t hostile_observations() {
    pf_observation_t o[3];
    bool good = true;
    for (pf_observation_t& each : o) {
      each = {bytes_.take<uint32_t>(), {hostile(bytes_), hostile(bytes_)}, hostile(bytes_)};
      good = good && finite(each.pixel, 2) && std::isfinite(each.sigma_px);
    }
    const int64_t t_ns = hostile_time(bytes_, t_ns_);
    const pf_status_t result = pf_push_observations(slam_, t_ns, o, 3);
    if (result >= PF_OK) {
      require(good && (!pushed_ || t_ns > last_t_ns_), "observations are finite, and time grows");
      taken(t_ns);
    }
    return result;
  }

  pf_status_t imu() {
    pf_imu_sample_t samples[3];
    for (pf_imu_sample_t& sample : samples) {
      sample.t_ns = imu_t_ns_ = bytes_.take<uint8_t>() % 16 == 0  ? hostile_time(bytes_, imu_t_ns_)
                                : imu_t_ns_ < INT64_MAX - 5000000 ? imu_t_ns_ + 5000000
                                                                  : imu_t_ns_;
      for (double& v : sample.gyro) v = unit(bytes_) * 10;
      for (double& v : sample.accel) v = bytes_.take<uint8_t>() == 0 ? hostile(bytes_) : 9.8;
    }
    return pf_push_imu(slam_, samples, 3);
  }

  pf_status_t start_from_target() {
    pf_target_t target;
    std::memset(static_cast<void*>(&target), 0, sizeof(target));
    const uint8_t how = bytes_.take<uint8_t>();
    target.kind = how % 16 == 0 ? bytes_.take<int8_t>() : 1 + how % 2;
    target.width = 0.2;
    if (extended_ && target.kind == PF_TARGET_RECTANGLE) pattern_ = 4;
    if (extended_ && (how & 64) != 0) target.q_WT[0] = target.p_WT[2] = 1;
    target.height = how % 32 == 1 ? hostile(bytes_) : 0.15;
    target.sigma = how % 32 == 2 ? hostile(bytes_) : 1e-3;
    target.count = how % 32 == 3 ? bytes_.take<int8_t>() : 4 + how % 13;
    for (int i = 0; i < PF_TARGET_MAX_POINTS; ++i) {  // the first points of observe()
      const uint32_t h = (static_cast<uint32_t>(i) + 1) * 2654435761u;
      target.points_W[i][0] = how % 32 == 5 ? hostile(bytes_) : (h % 997) / 400.0 - 1.25;
      target.points_W[i][1] = (h / 997 % 997) / 500.0 - 1;
      target.points_W[i][2] = (pattern_ & 64) != 0 ? 2.0 : 1.0 + (h >> 24) / 100.0;
    }
    target.first_pose.q_WC[0] = 1;
    for (int i = 0; i < 6; ++i) target.first_pose.covariance[7 * i] = how % 32 == 7 ? hostile(bytes_) : 1e-3;
    return pf_start_from_target(slam_, &target);
  }

  pf_status_t start_from_pose() {
    pf_pose_t pose;
    std::memset(static_cast<void*>(&pose), 0, sizeof(pose));
    double velocity_covariance[36] = {};
    const uint8_t how = bytes_.take<uint8_t>();
    pose.q_WC[0] = how % 16 == 1 ? hostile(bytes_) : 1;
    for (int i = 0; i < 3; ++i) pose.p_WC[i] = how % 16 == 2 ? hostile(bytes_) : unit(bytes_);
    for (int i = 0; i < 3; ++i) pose.v_W[i] = how % 16 == 3 ? hostile(bytes_) : unit(bytes_);
    for (int i = 0; i < 6; ++i) pose.covariance[7 * i] = how % 16 == 4 ? hostile(bytes_) : between(bytes_, 1e-9, 1);
    for (int i = 0; i < 6; ++i) velocity_covariance[7 * i] = how % 16 == 5 ? hostile(bytes_) : between(bytes_, 1e-6, 1);
    if (how % 16 == 6) pose.covariance[bytes_.take<uint8_t>() % 36] = hostile(bytes_);
    return pf_start_from_pose(slam_, &pose, how % 16 == 7 ? nullptr : velocity_covariance);
  }

  /// Sets an anchor at the camera, at a pixel or anywhere, or removes one.
  pf_status_t change_anchors() {
    const uint8_t how = bytes_.take<uint8_t>();
    uint32_t id = 0;
    if (how % 4 == 0) return pf_remove_anchor(slam_, how / 4 % 16);
    pf_pose_t pose{};
    pf_hit_t hit{};
    const double pixel[2] = {between(bytes_, 0, config_.camera.width), between(bytes_, 0, config_.camera.height)};
    if (how % 4 == 1) {
      if (pf_get_pose(slam_, &pose) != PF_OK) pose.q_WC[0] = 1;
      if (how >= 192) pose.q_WC[how / 4 % 4] = hostile(bytes_);
      if (how >= 128) pose.p_WC[how / 4 % 3] = hostile(bytes_);
      return pf_add_anchor_pose(slam_, &pose, &id);
    }
    if (pf_hit_test(slam_, pixel, &hit) != PF_OK) hit.plane = 1 + how / 4 % 4;
    if (how % 4 == 3) hit.p_W[how / 4 % 3] = hostile(bytes_);
    return pf_add_anchor_hit(slam_, &hit, &id);
  }

  /// What every context shows, whatever it went through.
  void look() {
    pf_report_t report;
    pf_state_t state = PF_STATE_STARTING;
    pf_pose_t pose;
    require(pf_get_report(slam_, &report) == PF_OK && pf_get_state(slam_, &state) == PF_OK, "a report and a state");
    require(report.state == static_cast<int32_t>(state), "state and report agree");
    const bool has_window = config_.backend == PF_BACKEND_WINDOW;
    require(report.features <= (has_window ? config_.window.points : config_.capacity.max_features) &&
                report.patches <= config_.capacity.max_patches && report.cameras <= config_.capacity.max_cameras,
            "features and patches keep to their capacity");
    require(report.planes <= config_.capacity.max_planes &&
                (has_window || report.state_dim <= config_.capacity.max_state_dim),
            "the map keeps to its capacity");
    require(report.attempts >= report.matches && report.matches >= report.inliers &&
                report.features == report.features_point + report.features_inverse_depth + report.features_folded +
                                       report.features_fixed + report.features_trial,
            "the report's numbers add up");
    require(std::isfinite(report.nis) && report.nis >= 0, "the NIS is a number");
    const pf_status_t posed = status(pf_get_pose(slam_, &pose));
    require(posed == PF_OK || posed == PF_ERROR_STATE, "a pose, or none yet");
    if (posed == PF_OK) require_pose(pose);
    look_at_map(report);
    look_at_patches(report);
    look_at_anchors(report);
    if (!trusts_told_repairs_ || report.covariance_repairs == 0) look_inside();
  }

  /// Covariances before the getters mend what rounding has left of them.
  void look_inside() const {
    const pf::View view = slam_->session.view();
    if (!view.tracking().has_pose()) return;
    pf::Body body;
    pf::Mat6 pose;
    view.pose_at(view.last_ns(), &body, &pose);
    require_nearly(pose, kSmallestOfBody, "a pose has a covariance before it is mended");
    for (int i = 0; i < view.map().features.capacity(); ++i)
      if (view.map().features.used(i))
        require_nearly(view.feature(i).covariance, kSmallestOfOthers, "a feature has a covariance before it is mended");
    for (int i = 0; i < view.map().planes.capacity(); ++i)
      if (view.map().planes.used(i))
        require_nearly(view.plane(i).covariance, kSmallestOfOthers, "a plane has a covariance before it is mended");
  }

  void look_at_anchors(const pf_report_t& report) const {
    std::vector<pf_anchor_t> anchors(static_cast<size_t>(config_.capacity.max_anchors));
    size_t count = 0;
    require(pf_get_anchors(slam_, anchors.data(), anchors.size(), &count) == PF_OK, "anchors keep to their capacity");
    for (size_t i = 0; i < count; ++i) {
      const pf_anchor_t& anchor = anchors[i];
      pf_anchor_t same{};
      require(pf_get_anchor(slam_, anchor.id, &same) == PF_OK && std::memcmp(&same, &anchor, sizeof(same)) == 0,
              "an anchor is found by its id");
      const double* q = anchor.q_WA;
      require(std::fabs(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] - 1) < 1e-4 && finite(anchor.p_WA, 3),
              "an anchor is finite");
      require(anchor.map_id <= report.map_id, "an anchor belongs to a map that there has been");
      require_covariance(anchor.covariance, 6, "an anchor has a covariance");
    }
  }

  void look_at_patches(const pf_report_t& report) const {
    std::vector<pf_patch_t> patches(static_cast<size_t>(config_.capacity.max_patches));
    size_t count = 0;
    require(pf_get_patches(slam_, patches.data(), patches.size(), &count) == PF_OK &&
                count == static_cast<size_t>(report.patches),
            "every patch is given");
    for (size_t i = 0; i < count; ++i) {
      const pf_patch_t& patch = patches[i];
      require(finite(&patch.corners_px[0][0], 8) && patch.weight >= 0 && patch.weight <= 1, "a patch is finite");
      double corners[36];
      for (int k = 0; k < 36; ++k) corners[k] = patch.covariance_px[k / 6 * 8 + k % 6];
      require_covariance(corners, 6, "corners have a covariance");
    }
  }

  void look_at_map(const pf_report_t& report) const {
    std::vector<pf_feature_t> features(
        static_cast<size_t>(std::max(config_.capacity.max_features, config_.window.points)));
    std::vector<pf_match_t> matches(features.size() + static_cast<size_t>(config_.capacity.max_observations));
    std::vector<pf_plane_t> planes(static_cast<size_t>(config_.capacity.max_planes));
    size_t count = 0;
    require(pf_get_features(slam_, features.data(), features.size(), &count) == PF_OK &&
                count == static_cast<size_t>(report.features),
            "every feature is given");
    for (size_t i = 0; i < count; ++i) {
      require(finite(features[i].p_W, 3), "a feature is finite");
      require_covariance(features[i].covariance, 3, "a feature has a covariance");
      require(features[i].is_target || features[i].observations <= features[i].attempts,
              "only what is searched is seen");
      pf_template_t shape;
      const pf_status_t shaped = status(pf_get_template(slam_, features[i].id, &shape));
      require(shaped == PF_OK || shaped == PF_NOTE_NOTHING, "a template, or none");
      if (shaped != PF_OK) continue;
      const double* n = shape.normal_W;
      require(finite(n, 3) && std::fabs(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 1e-4 &&
                  std::isfinite(shape.sigma_normal_rad) && shape.side == config_.capacity.template_px,
              "a template has a normal");
    }
    require(pf_get_matches(slam_, matches.data(), matches.size(), &count) == PF_OK, "every match is given");
    for (size_t i = 0; i < count; ++i) {
      require(finite(matches[i].predicted_px, 2) && finite(matches[i].measured_px, 2) && std::isfinite(matches[i].nis),
              "a match is finite");
      require_covariance(matches[i].covariance_px, 2, "a match has a covariance");
    }
    require(pf_get_planes(slam_, planes.data(), planes.size(), &count) == PF_OK &&
                count == static_cast<size_t>(report.planes),
            "every plane is given");
    for (size_t i = 0; i < count; ++i) {
      const pf_plane_t& plane = planes[i];
      const double* n = plane.normal_W;
      require(std::fabs(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 1e-4, "a normal has length 1");
      require(finite(plane.p_WP, 3) && finite(plane.R_WP, 9) && std::isfinite(plane.distance + plane.area),
              "a plane is finite");
      require(plane.outline_count >= 0 && plane.outline_count <= PF_OUTLINE_MAX, "an outline fits");
      require_covariance(plane.covariance, 3, "a plane has a covariance");
      uint32_t current = 0;
      require(pf_find_plane(slam_, plane.id, &current) == PF_OK && current == plane.id, "a plane is found by its id");
    }
  }

  void ask() {
    const uint8_t what = bytes_.take<uint8_t>();
    const bool hostile_input = what >= 192;
    pf_pose_t pose;
    pf_hit_t hit;
    double point[3], pixel[2], covariance[4];
    for (double& v : point) v = hostile_input ? hostile(bytes_) : 2 * unit(bytes_);
    switch (what % 5) {
      case 0:
        pixel[0] = hostile_input ? hostile(bytes_) : bytes_.take<uint8_t>() % config_.camera.width;
        pixel[1] = hostile_input ? hostile(bytes_) : bytes_.take<uint8_t>() % config_.camera.height;
        if (status(pf_hit_test(slam_, pixel, &hit)) == PF_OK) {
          require(finite(hit.p_W, 3) && std::isfinite(hit.range) && hit.range > 0, "a hit is finite");
          require_covariance(hit.covariance, 3, "a hit has a covariance");
        }
        break;
      case 1: {
        const int64_t ahead = hostile_input                  ? hostile_time(bytes_, t_ns_)
                              : t_ns_ < INT64_MAX - 50000000 ? t_ns_ + 50000000
                                                             : t_ns_;
        if (status(pf_predict_pose(slam_, ahead, &pose)) == PF_OK) require_pose(pose);
        break;
      }
      case 2:
        if (status(pf_project_point(slam_, point, pixel, covariance)) == PF_OK) {
          require(finite(pixel, 2), "a projected point is finite");
          require_covariance(covariance, 2, "a projected point has a covariance");
        }
        break;
      case 3: {
        pf_report_t report;
        pf_get_report(slam_, &report);
        const size_t count = static_cast<size_t>(report.state_dim) * (static_cast<size_t>(report.state_dim) + 8);
        std::vector<double> scratch(count + 1);
        double information[49];
        if (report.state_dim >= 150) break;
        const pf_status_t read = status(pf_get_gauge_information(slam_, scratch.data(), count, information));
        if (read == PF_OK) require(finite(information, 49), "gauge information is finite");
        seen_.refused_gauge += read == PF_ERROR_RANGE ? 1 : 0;
        break;
      }
      default: {
        pf_imu_report_t report;
        uint32_t current = 0;
        require(pf_get_imu_report(slam_, &report) == PF_OK && report.kept <= config_.capacity.max_imu_samples,
                "samples");
        status(pf_find_plane(slam_, bytes_.take<uint32_t>(), &current));
        pf_inertial_t inertial;
        static_assert(sizeof(inertial.sigma) == 18 * sizeof(double), "all of sigma is doubles");
        if (status(pf_get_inertial(slam_, &inertial)) == PF_OK)
          require(finite(inertial.gravity_W, 3) && finite(inertial.gyro_bias, 3) && finite(inertial.accel_bias, 3) &&
                      finite(inertial.covariance, 64) && finite(inertial.q_BC, 4) && finite(inertial.p_BC, 3) &&
                      finite(inertial.gyro_matrix, 9) && finite(inertial.accel_matrix, 9) &&
                      finite(reinterpret_cast<const double*>(&inertial.sigma), 18),
                  "what is known of the unit is finite");
        pf_camera_t camera;
        double lens[100];
        require(pf_get_camera(slam_, &camera, lens) == PF_OK && finite(lens, 100) && finite(camera.distortion, 8) &&
                    std::isfinite(camera.fx + camera.fy + camera.cx + camera.cy),
                "what is known of the camera is finite");
        size_t kept = 0;
        pf_imu_sample_t newest[4];
        require(status(pf_get_imu_samples(slam_, newest, 4, &kept)) >= PF_OK && static_cast<int>(kept) == report.kept,
                "samples are given");
        pf_motion_t motion;
        if (status(pf_get_motion_since_mark(slam_, &motion)) == PF_OK)
          require(finite(motion.q_KC, 4) && finite(motion.p_KC, 3), "a motion is finite");
        if (pf_get_motion_since_mark(slam_, &motion) == PF_OK)
          require_covariance(motion.covariance, 6, "a motion has a covariance");
        break;
      }
    }
  }

  void ask_camera() {
    pf_camera_t camera = config_.camera;
    double point[3], pixel[2], ray[3];
    if (bytes_.take<uint8_t>() % 2 == 0) {
      camera.model = bytes_.take<uint8_t>() % 6;
      for (double& k : camera.distortion) k = bytes_.take<uint8_t>() % 4 == 0 ? hostile(bytes_) : 0.0;
    }
    for (double& v : point) v = bytes_.take<uint8_t>() % 4 == 0 ? hostile(bytes_) : unit(bytes_);
    if (status(pf_camera_project(&camera, point, pixel)) == PF_OK) require(finite(pixel, 2), "a pixel is finite");
    for (double& v : pixel) v = bytes_.take<uint8_t>() % 4 == 0 ? hostile(bytes_) : bytes_.take<uint8_t>();
    if (status(pf_camera_unproject(&camera, pixel, ray)) == PF_OK)
      require(std::fabs(ray[0] * ray[0] + ray[1] * ray[1] + ray[2] * ray[2] - 1) < 1e-3, "a ray has length 1");
  }

  Bytes& bytes_;
  const bool calm_;
  bool trusts_told_repairs_ = false;
  Seen seen_{};
  bool extended_ = false;  ///< before the config, which sets it
  pf_config_t config_;
  pf_memory_t need_{};
  static constexpr int kRest = 45;          ///< frames
  static constexpr double kFarthest = 0.4;  ///< from the first camera, of a calm walk
  int frames_ = 0;
  bool usable_ = false;
  const Guarded* block_ = nullptr;
  pf_slam_t* slam_ = nullptr;
  uint8_t* pixels_ = nullptr;
  int32_t stride_ = 0;
  bool observes_ = false, pushed_ = false;
  int64_t t_ns_ = 0, last_t_ns_ = 0, imu_t_ns_ = 0;
  double position_[3] = {}, velocity_[3] = {};
  uint8_t pattern_ = 0;
  uint64_t noise_ = 1;
};
