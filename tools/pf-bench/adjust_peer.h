#pragma once

// What the bundle adjuster and its peer adjust, as plain numbers: the peer is a module of its own (ceres/adjust.cpp).

extern "C" {

/// Poses, and points by bearing and inverse depth in a host pose, before a pinhole camera.
struct pf_bench_bundle {
  double fx, fy, cx, cy;
  int poses, points;
  double* pose;         ///< per pose: quaternion of R_WC (w x y z), p_W
  const int* free;      ///< per pose
  const double* ray;    ///< per point, in its host
  const int* host;      ///< per point
  double* rho;          ///< per point
  const double* pixel;  ///< pose by pose, per point: x, y
  const int* seen;      ///< likewise
  double sigma_px, huber, rho_mean, rho_sigma, no_pixel_penalty;
  int max_rounds;
  double small_gain;
};

struct pf_bench_adjusted {
  double cost;        ///< in squared standard deviations
  double us;          ///< of the minimiser alone
  double prepare_us;  ///< what the peer does between the built problem and the minimiser's first round
  int rounds;
};

}  // extern "C"
