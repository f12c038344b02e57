/* planefold for comparisons: forms that papers have and products do not need.
 *
 *   pf_research_t research;
 *   pf_research_default(&research);
 *   research.keep_gauge = 0;                     the textbook EKF
 *   pf_config_set_research(&config, &research);  then pf_create as ever
 *
 * The values below that belong to enums of planefold.h are rejected by pf_config_check, by the name
 * of the field, in a config without research.
 */
#ifndef PLANEFOLD_PLANEFOLD_RESEARCH_H
#define PLANEFOLD_PLANEFOLD_RESEARCH_H

#include "planefold/planefold.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Of motion.model: random walk of the pose (Gee 2007, eq 1). */
#define PF_MOTION_CONSTANT_POSITION 2
/* Of plane.fix: a fixed point leaves the state, as if known exactly (Gee 2007, section 3.4). */
#define PF_FIX_ERROR_FREE 3
/* Of map.masks: as PF_MASKS_PARTIAL with all pixels on the plane. */
#define PF_MASKS_WHOLE 2

/* How a point enters a plane. */
typedef enum pf_fold {
  /* its distance from the plane is measured as zero, within the roughness; then it is dropped */
  PF_FOLD_CONDITION = 1,
  PF_FOLD_DROP = 2 /* its distance is dropped (Gee 2007, eq 4 and 6) */
} pf_fold_t;

typedef struct pf_research {
  /* 1: keeps the covariance consistent with what a camera alone cannot observe
   * (lib/docs/theory/gauge.md). 0: the textbook EKF, which is overconfident. Default 1 */
  int32_t keep_gauge;
  int32_t fold;        /* pf_fold_t. Default condition */
  double linear_walk;  /* of PF_MOTION_CONSTANT_POSITION [m/sqrt(s)] 1e-9 .. 1e4. Default 0.1 */
  double angular_walk; /* the same [rad/sqrt(s)] 1e-9 .. 1e4. Default 0.2 */
  /* 1: a patch of a wall is used where its corners pass the gate. 0: always, on the nearest wall
   * that it may lie on. Default 1 */
  int32_t gate_patches;
} pf_research_t;

PF_API pf_status_t pf_research_default(pf_research_t* research);

/* Writes research into the config; null takes it out again. Values are checked by pf_config_check,
 * under names such as "research.fold". */
PF_API pf_status_t pf_config_set_research(pf_config_t* config, const pf_research_t* research);

/* What a config holds; the defaults where it holds none. PF_ERROR_VERSION: it was written by
 * another release. */
PF_API pf_status_t pf_config_get_research(const pf_config_t* config, pf_research_t* research);

/* Information that the filter holds about what a camera alone cannot observe: N^T P^-1 N, 7x7,
 * row-major, in the order translation, rotation, log scale of the whole world. It must never grow
 * without absolute data. For tests: cubic in the state's dimension. scratch needs state_dim *
 * (state_dim + 8) doubles (pf_report_t), else PF_ERROR_MEMORY. PF_ERROR_STATE: before the first
 * state, and with PF_BACKEND_WINDOW. PF_ERROR_RANGE: P is no covariance, by more than rounding
 * leaves (lib/docs/theory/float.md). */
PF_API pf_status_t pf_get_gauge_information(const pf_slam_t* slam, double* scratch,
                                            size_t scratch_count, double information[49]);

#ifdef __cplusplus
}
#endif

#endif
