#include "filter/filter.h"

#include "model/camera_at.h"
#include "model/kinds.h"
#include "model/tuning.h"
#include "observe/inverse_depth.h"

namespace pf {

bool Filter::layout(Arena& arena, const FilterCapacity& capacity) {
  // Features, planes with their point groups, and anchors with a child each or reference cameras (six rows).
  state_.slots = capacity.features + 2 * capacity.planes + capacity.state_dim / 6 + 1;
  const std::size_t slots = static_cast<std::size_t>(state_.slots);
  state_.block = arena.take<Block>(slots);
  state_.max_planes = capacity.planes;
  state_.plane_frame = arena.take<PlaneFrame>(static_cast<std::size_t>(capacity.planes));
  state_.plane_roughness = arena.take<Scalar>(static_cast<std::size_t>(capacity.planes));
  blocks_.layout(arena, {capacity.state_dim, state_.slots, 2 * capacity.observations});
  transport_.layout(arena, blocks_.ld());
  view_ = arena.take<Measurement>(static_cast<std::size_t>(capacity.observations));
  place_ = arena.take<Vec3>(slots);
  place_slot_ = arena.take<int>(slots);
  return arena.ok();
}

void Filter::init(const Kernels* kernels, const BodyLayout& layout, bool keep_gauge) {
  keep_gauge_ = keep_gauge;
  ++generation_;
  for (int s = 0; s < state_.slots; ++s) state_.block[s] = Block();
  state_.body = Body();
  state_.bend = Bend();
  state_.layout = layout;
  state_.unobservable = gauge::kBareCamera;
  state_.metric = false;
  state_.mounting = Mounting();
  state_.lens = Camera();
  state_.lens_rows = LensRows();
  state_.planes = 0;
  roughness_ = Scalar(0);
  apart_.clear();
  told_updates_ = 0;
  blocks_.init(kernels, layout.rows() - layout.considered_rows(), layout.considered_rows());
  transport_.init();
}

void Filter::set_lens(const Camera& camera, const LensPrior& prior) {
  state_.lens = camera;
  state_.lens_rows = prior.rows;
  PF_ASSERT(state_.layout.rows() - state_.layout.unit_rows() == prior.rows.count);
  const int n = prior.rows.count;
  Scalar C[kLensParameters * kLensParameters];
  for (int a = 0; a < n; ++a)
    for (int b = 0; b < n; ++b) C[a * n + b] = prior.covariance(a, b);
  if (n > 0) blocks_.set_constants(state_.layout.row(BodyPart::kLens), C);
}

void Filter::set_metric() {
  PF_ASSERT(state_.layout.has(BodyPart::kGravity));
  state_.metric = true;
}

void Filter::consider_lens(bool only_considered) {
  blocks_.consider_last(only_considered ? state_.lens_rows.count : state_.layout.considered_rows());
}

void Filter::predict(const Transition& transition) {
  state_.body = transition.mean;
  state_.bend = transition.bend;
  blocks_.predict(transition.F, transition.Q, transition.dim);
  if (transition.has_intrinsics)
    blocks_.add_constants(transition.by_intrinsics, transition.dim, state_.layout.row(BodyPart::kIntrinsics),
                          Intrinsics::kRows);
}

int Filter::take_slot(BlockKind kind) {
  const int slot = state_.find_free(), size = info(kind).rows;
  if (slot < 0 || size > room()) return -1;
  Block& block = state_.block[slot];
  block = Block();
  block.kind = kind;
  block.size = static_cast<std::int16_t>(size);
  return slot;
}

int Filter::add_anchor(int reference) {
  const int slot = take_slot(BlockKind::kAnchor);
  if (slot < 0) return -1;
  RowsOf<3, 3, 1> J;  // o = p
  J.parts = 1;
  J.part[0] = reference == kBodyBlock ? Part::body(Body::kPosition, 3) : Part::of(reference, 3, 3);
  put<3, 3>(J.h, 3, 0, Mat3::Identity());
  const Scalar none[9] = {};
  blocks_.augment(slot, J, none);
  state_.block[slot].set_xyz(reference == kBodyBlock ? camera_at(state_, Scalar(0)).p_W
                                                     : model::ReferenceCamera::p_WC(state_.block[reference]));
  return slot;
}

int Filter::add_inverse_depth(int anchor, const Vec3& ray_C, const Mat32& J_ray_z, const Mat2& noise_px, Scalar rho,
                              Scalar sigma_rho, Scalar tau) {
  PF_ASSERT(state_.block[anchor].kind == BlockKind::kAnchor);
  const int slot = take_slot(BlockKind::kInverseDepth);
  if (slot < 0) return -1;
  CameraAt camera = camera_at(state_, tau);
  camera.q_WC.normalize();  // the bearing keeps what its length is off
  const Vec3 c_W = camera.p_W - camera_at(state_, Scalar(0)).p_W;
  Mat23 J_theta, J_c;
  Mat2 J_z;
  const InverseDepth feature = begin_inverse_depth(camera, ray_C, J_ray_z, rho, c_W, &J_theta, &J_z, &J_c);
  RowsOf<3, CameraAt::kMaxColumns + kLensParameters, 2> J;  // the anchor takes part in what the position does
  const int lens = state_.lens_rows.count;
  J.parts = lens > 0 ? 2 : 1;
  J.part[0] = camera.tau == Scalar(0) ? Part::body(Body::kTheta, 3) : camera.part();
  const int columns = J.part[0].size + lens;
  for (int i = 0; i < 3 * columns; ++i) J.h[i] = Scalar(0);
  put<2, 3>(J.h, columns, 0, J_theta);
  if (camera.tau != Scalar(0)) {
    put<2, 3>(J.h, columns, camera.velocity_row, Mat23(camera.tau * J_c));
    put<2, 3>(J.h, columns, camera.rate_row, Mat23(J_theta.lazyProduct(camera.J_theta_w)));
    if (camera.beside) {
      put<2, 3>(J.h, columns, 0, Mat23(J_theta + J_c * camera.J_p_theta));
      put<2, 3>(J.h, columns, camera.rate_row, Mat23(J_theta * camera.J_theta_w + J_c * camera.J_p_w));
    }
  }
  if (lens > 0) {  // the ray of a given pixel: J_z_lens e + J_z_ray e_ray = 0
    J.part[1] = Part::body(state_.layout.row(BodyPart::kLens), lens);
    LensJacobian J_lens = -J_z * lens_jacobian(state_.lens, ray_C);
    Mat26 J_camera;
    J_camera << J_theta, J_c;
    J_lens.col(kReadoutParameter) = camera.by_readout<2>(J_camera, state_.lens.readout);
    put_lens<2>(J_lens, state_.lens_rows, J.part[0].size, columns, J.h);
  }
  // Of the pixel, and of the inverse depth, which rotates the bearing too where the anchor is not where the ray begins.
  Mat3 noise = Mat3::Zero();
  const Mat2 Jn = J_z * noise_px;
  const Vec2 J_rho = J_c.lazyProduct(c_W) / rho;
  noise.topLeftCorner<2, 2>() = Jn * J_z.transpose() + sigma_rho * sigma_rho * J_rho * J_rho.transpose();
  // What neither Jacobian shows is the product of both where the camera's speed is open: as for parallax, e_rho e_c.
  if (camera.tau != Scalar(0)) {
    const Mat23 J_speed = J_c * (camera.tau * sigma_rho / rho);
    RowsOf<2, 3, 1> by_speed;
    by_speed.parts = 1;
    by_speed.part[0] = Part::body(camera.velocity_row, 3);
    put<2, 3>(by_speed.h, 3, 0, J_speed);
    noise.topLeftCorner<2, 2>() += blocks_.covariance_of<2>(by_speed);
  }
  noise.topRightCorner<2, 1>() = sigma_rho * sigma_rho * J_rho;
  noise.bottomLeftCorner<1, 2>() = noise.topRightCorner<2, 1>().transpose();
  noise(2, 2) = sigma_rho * sigma_rho;
  Scalar raw[9];
  put<3, 3>(raw, 3, 0, noise);
  blocks_.augment(slot, J, raw);
  state_.block[slot].set_inverse_depth(feature);
  state_.adopt(anchor, slot);
  return slot;
}

int Filter::add_point(const Vec3& p_W, const Mat3& covariance) {
  tell_gauge();
  const int slot = take_slot(BlockKind::kPoint);
  if (slot < 0) return -1;
  augment_known<3>(&blocks_, slot, covariance);
  state_.block[slot].set_xyz(p_W);
  return slot;
}

void Filter::convert_to_point(int slot) {
  Block& block = state_.block[slot];
  PF_ASSERT(block.kind == BlockKind::kInverseDepth);
  const int anchor = block.parent;
  Mat3 J_feature;
  const Vec3 f_W = inverse_depth_to_point(state_.block[anchor].xyz(), block.inverse_depth(), &J_feature);
  RowsOf<3, 6, 2> J;  // f = o + b / rho
  J.parts = 2;
  J.part[0] = Part::of(anchor, 0, 3);
  J.part[1] = Part::of(slot, 0, 3);
  put<3, 3>(J.h, 6, 0, Mat3::Identity());
  put<3, 3>(J.h, 6, 3, J_feature);
  blocks_.transform(slot, J);
  state_.leave_parent(slot);
  block.kind = BlockKind::kPoint;
  block.set_xyz(f_W);
  if (state_.block[anchor].children == 0 && state_.block[anchor].pins == 0) remove(&anchor, 1);
}

void Filter::remove(const int* slots, int count) {
  // Mark, let what dies childless follow its last child, then list what goes.
  for (int i = 0; i < count; ++i) {
    Block& block = state_.block[slots[i]];
    PF_ASSERT(block.kind != BlockKind::kPlane || block.children == 0);
    state_.leave_parent(slots[i]);
    state_.leave_second_parent(slots[i]);
    if (is_plane(block.kind)) --state_.planes;
    block.kind = BlockKind::kNone;
  }
  for (int s = 0; s < state_.slots; ++s) {
    Block& block = state_.block[s];
    if (!info(block.kind).dies_childless || block.children > 0 || block.pins > 0) continue;
    state_.leave_parent(s);
    state_.leave_second_parent(s);
    block.kind = BlockKind::kNone;
  }
  int gone = 0;
  for (int s = 0; s < state_.slots; ++s) {
    Block& block = state_.block[s];
    if (block.kind != BlockKind::kNone) continue;
    if (block.size > 0) place_slot_[gone++] = s;
    block = Block();
  }
  blocks_.remove(place_slot_, gone);
}

Vec3 Filter::point(int slot) const {
  Vec3 p_W = state_.block[slot].xyz();
  visit(state_.block[slot].kind, [&](auto kind) {
    using K = decltype(kind);
    if constexpr (K::kHasPlace) p_W = K::point(state_, state_.block[slot]);
  });
  return p_W;
}

Mat3 Filter::covariance3(int slot) const {
  Place at;
  Mat3 C = Mat3::Zero();
  const Block& block = state_.block[slot];
  if (block.kind == BlockKind::kInverseDepth && !(block.inverse_depth().rho > tuning::inverse_depth::kMinShownRho)) {
    const int first[2] = {first_row(block.parent), first_row(slot)};
    Mat6 cov;
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) cov(i, j) = covariance()(first[i / 3] + i % 3, first[j / 3] + j % 3);
    if (apart_.any()) {
      const Part part[2] = {Part::of(block.parent, 0, 3), Part::of(slot, 0, 3)};
      Scalar identity[36];
      put<6, 6>(identity, 6, 0, Mat6::Identity());
      cov += apart_.covariance_of<6>(state_, {6, 2, part, identity});
    }
    shown_place(state_.block[block.parent].xyz(), block.inverse_depth(), cov, &C);
    return C;
  }
  if (!find_point(state_, slot, &at)) return C;
  C = rounded_covariance_of<3>(at.rows<3>(Mat3::Identity()));
  if (!at.has_rows) C += at.J_own * block.inside() * at.J_own.transpose();
  return C;
}

Scalar Filter::variance_of(const Rows& row) const { return covariance_of<1>(row)(0, 0); }

Mat2 Filter::innovation(const PixelMeasurement& pixel) const { return blocks_.covariance_of<2>(pixel.H); }

}  // namespace pf
