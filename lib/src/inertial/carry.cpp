#include "model/carry.h"

#include "inertial/body_motion.h"
#include "inertial/force_check.h"
#include "inertial/kept_mounting.h"
#include "inertial/moving_start.h"
#include "inertial/rate_check.h"
#include "inertial/rest_detector.h"
#include "inertial/rest_hold.h"
#include "inertial/unit_watch.h"

namespace pf {
namespace {

void carry_reason(Archive& archive, UnitReason& reason) {
  archive.within(reason, 0, static_cast<int>(UnitReason::kAccelSign));
}

void carry_still(Archive& archive, StillReading& still) {
  auto& [gyro, accel, sigma_gyro, sigma_accel] = still;
  archive.numbers(gyro, accel, sigma_gyro, sigma_accel);
}

void carry_rest(Archive& archive, RestReading& rest) {
  auto& [gyro, accel, sigma_gyro, sigma_accel, sigma_speed, sigma_accel_bias, gravity] = rest;
  archive.numbers(gyro, accel, sigma_gyro, sigma_accel, sigma_speed, sigma_accel_bias, gravity);
}

void carry_fit(Archive& archive, RateFit& fit) {
  auto& [count, delay, sigma_delay, R_CB, sigma_turn, scale, left, next_left, turning, left_mirrored, mirrored,
         at_end] = fit;
  archive.counts(count);
  archive.numbers(delay, sigma_delay, R_CB, sigma_turn, scale, left, next_left, turning, left_mirrored);
  archive.flags(mirrored, at_end);
}

}  // namespace

void UnitNoise::carry(Archive& archive) {
  auto& [last_ns, second, third, count, white, excess] = data_;
  archive.any(last_ns);
  archive.counts(count);
  archive.numbers(second, third, white, excess);
}

void BodyMotion::carry(Archive& archive) {
  auto& [given, dv_C, dw_C] = data_;
  archive.flags(given);
  archive.numbers(dv_C, dw_C);
  noise_.carry(archive);
}

void KeptMounting::carry(Archive& archive) {
  if (kept_ == nullptr) return;
  auto& [mounting, covariance] = *kept_;
  pf::carry(archive, mounting);
  for (int i = 0; i < num_rows() * num_rows(); ++i) archive.numbers(covariance[i]);
}

void ForceCheck::carry(Archive& archive) {
  auto& [last_ns, begin_ns, count, sum, length, reason, value] = data_;
  archive.any(last_ns, begin_ns);
  archive.counts(count);
  archive.numbers(sum, length, value);
  carry_reason(archive, reason);
}

/// Links and poses are those of one smoothing.
void MovingStart::carry(Archive& archive) {
  auto& [count, frames, t_ns, map_id, sigma_scale, reversed, delay_sigma, refused, left, first, end, correlation, view,
         link, pose] = data_;
  auto& [is_first, reading, halvings] = rest_;
  archive.within(count, 0, kMaxMovingPoses);
  archive.within(halvings, 0, kMaxHalvings);
  for (int* index : {&left, &first, &end}) archive.within(*index, 0, count);
  archive.counts(frames, refused);
  archive.any(t_ns, map_id);
  archive.flags(reversed, is_first);
  archive.numbers(sigma_scale, delay_sigma, correlation);
  carry_rest(archive, reading);
  for (int k = 0; k < count; ++k) {
    auto& [is_placed, q_WC, p_W, covariance, view_ns, samples, pixels, seen] = view[k];
    auto& [dt, gyro_bias, dq_B, v, p, by_bias] = samples;
    archive.numbers(q_WC, p_W, covariance, dt, gyro_bias, dq_B, v, p, by_bias);
    archive.flags(is_placed);
    archive.any(view_ns);
    archive.within(pixels, 0, kMaxPixels);
    for (int i = 0; i < pixels; ++i) {
      archive.any(seen[i].id);
      archive.numbers(seen[i].x, seen[i].y);
    }
  }
}

void RateAlignment::carry(Archive& archive) {
  archive.within(count_, 0, kMax);
  for (int i = 0; i < count_; ++i) {
    auto& [begin_ns, end_ns, c, g, slope, has_g] = interval_[i];
    archive.any(begin_ns, end_ns);
    archive.numbers(c);
  }
}

void RateCheck::carry(Archive& archive) {
  auto& [rates, begin, until_fit, fit, has_fit, is_open, reason, value, R_CB] = data_;
  auto& [t_ns, q_WC, generation] = begin;
  rates.carry(archive);
  archive.any(t_ns, generation);
  archive.numbers(q_WC, value, R_CB);
  archive.within(until_fit, -Archive::kMaxCount, Archive::kMaxCount);
  carry_fit(archive, fit);
  archive.flags(has_fit, is_open);
  carry_reason(archive, reason);
}

void RestDetector::carry(Archive& archive) {
  if (data_ == nullptr) return;
  auto& [begun, begin_ns, rest_begin_ns, sample_ns, count, num_seen, motion2, mean, square, rested, first_ns, mean_ns,
         first, anew, motion_px, scatter] = *data_;
  archive.flags(begun, anew);
  archive.any(begin_ns, rest_begin_ns, sample_ns, first_ns, mean_ns);
  archive.counts(count);
  archive.within(num_seen, 0, kMaxPixels);
  archive.within(first, 0, kMaxPixels);
  archive.numbers(motion2, mean, square, rested, motion_px, scatter);
  const auto carry_seen = [&](Seen& seen) {
    auto& [id, frames, pixel] = seen;
    archive.any(id);
    archive.within(frames, 1, Archive::kMaxCount);
    archive.numbers(pixel);
  };
  for (int i = 0; i < num_seen; ++i) carry_seen(seen_[i]);
  for (int i = 0; i < first; ++i) carry_seen(seen_[kMaxPixels + i]);
}

void RestHold::carry(Archive& archive) {
  auto& [holds, before_ns, last_ns, moved_px, sigma_rad, dt, m_per_px, still, late, late_count] = data_;
  archive.flags(holds);
  archive.any(before_ns, last_ns);
  archive.numbers(moved_px, sigma_rad, dt, m_per_px);
  carry_still(archive, still);
  archive.within(late_count, 0, kMaxLate);
  for (int i = 0; i < late_count; ++i) {
    archive.any(late[i].before_ns);
    carry_still(archive, late[i].still);
  }
  archive.counts(rests_);
}

void UnitEvidence::carry(Archive& archive) {
  auto& [sum, doubts, used_ns, metric_ns, sound_ns] = data_;
  archive.numbers(sum);
  archive.counts(doubts);
  for (std::int64_t* time : {&used_ns, &metric_ns, &sound_ns}) archive.within(*time, 0, INT64_MAX / 2);
}

void UnitWatch::carry(Archive& archive) {
  if (parts_ == nullptr) return;
  parts_->evidence.carry(archive);
  parts_->rates.carry(archive);
  auto& [mode, rejected_ns, prior, prior_ns, follows, is_contradicted, is_taken_back, tracked, tracked_ns, is_aligned,
         is_worse_than_none, by_samples, by_none, P_by_none] = parts_->data;
  archive.within(mode, 0, static_cast<int>(UnitMode::kRejected));
  archive.within(rejected_ns, 0, INT64_MAX / 2);
  archive.any(prior_ns, tracked_ns);
  archive.flags(follows, is_contradicted, is_taken_back, is_aligned, is_worse_than_none);
  archive.numbers(P_by_none);
  pf::carry(archive, by_samples);
  pf::carry(archive, by_none);
  pf::carry(archive, prior);
  pf::carry(archive, tracked);
}

}  // namespace pf
