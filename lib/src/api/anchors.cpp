#include "api/context.h"
#include "api/copy.h"

namespace {

void describe(const pf::Anchor& anchor, pf_anchor_t* out) {
  *out = pf_anchor_t();
  out->id = anchor.id;
  out->map_id = anchor.map_id;
  out->plane = anchor.is_on_plane ? anchor.plane : 0;
  const pf::Quat& q = anchor.T_WA.q;
  const pf::Scalar wxyz[4] = {q.w(), q.x(), q.y(), q.z()};
  pf::copy(wxyz, 4, out->q_WA);
  pf::copy(anchor.T_WA.p, 3, out->p_WA);
  pf::copy_covariance(anchor.covariance, out->covariance);
}

pf_status_t add(pf_slam_t* slam, const pf::AnchorRequest& asked, uint32_t* id) {
  std::uint32_t added = 0;
  const pf::Status status = slam->session.map_calls().add_anchor(asked, &added);
  if (status == pf::Status::kOk) *id = added;
  return pf::to_c(status);
}

}  // namespace

pf_status_t pf_add_anchor_pose(pf_slam_t* slam, const pf_pose_t* pose, uint32_t* id) {
  PF_BEGIN_CHANGE(slam);
  if (pose == nullptr || id == nullptr) return PF_ERROR_NULL;
  if (!pf::finite(pose->q_WC, 4) || !pf::finite(pose->p_WC, 3)) return PF_ERROR_NONFINITE;
  pf::AnchorRequest asked;
  if (!pf::quaternion_from(pose->q_WC, &asked.T_WA.q) || !pf::within(pose->p_WC, 3, pf::kMaxMetres))
    return PF_ERROR_RANGE;
  asked.T_WA.p = pf::vec3(pose->p_WC);
  return in_call.end(add(slam, asked, id));
}

pf_status_t pf_add_anchor_hit(pf_slam_t* slam, const pf_hit_t* hit, uint32_t* id) {
  PF_BEGIN_CHANGE(slam);
  if (hit == nullptr || id == nullptr) return PF_ERROR_NULL;
  if (!pf::finite(hit->p_W, 3)) return PF_ERROR_NONFINITE;
  if (!pf::within(hit->p_W, 3, pf::kMaxMetres)) return PF_ERROR_RANGE;
  const pf::PlaneTable& planes = slam->session.view().map().planes;
  pf::AnchorRequest asked;
  asked.plane = planes.entry_of(planes.find(hit->plane));
  asked.T_WA.p = pf::vec3(hit->p_W);
  return in_call.end(asked.plane < 0 ? PF_NOTE_NOTHING : add(slam, asked, id));
}

pf_status_t pf_remove_anchor(pf_slam_t* slam, uint32_t id) {
  PF_BEGIN_CHANGE(slam);
  return in_call.end(slam->session.map_calls().remove_anchor(id));
}

pf_status_t pf_get_anchor(const pf_slam_t* slam, uint32_t id, pf_anchor_t* anchor) {
  PF_REQUIRE_CONTEXT(slam);
  if (anchor == nullptr) return PF_ERROR_NULL;
  const pf::View view = slam->session.view();
  const int entry = view.map().anchors.entry_of(id);
  if (entry < 0) return PF_NOTE_NOTHING;
  describe(view.map().anchors[entry], anchor);
  return PF_OK;
}

pf_status_t pf_get_anchors(const pf_slam_t* slam, pf_anchor_t* anchors, size_t capacity, size_t* count) {
  PF_REQUIRE_CONTEXT(slam);
  if (count == nullptr || (anchors == nullptr && capacity > 0)) return PF_ERROR_NULL;
  *count = 0;
  const pf::View view = slam->session.view();
  for (const int i : used_entries(view.map().anchors)) {
    if (*count < capacity) describe(view.map().anchors[i], &anchors[*count]);
    ++*count;
  }
  return *count > capacity ? PF_NOTE_TRUNCATED : PF_OK;
}
