/* The config of a context that moves by inertial samples, of a unit about as good as EuRoC's. */
#ifndef PLANEFOLD_TESTS_INERTIAL_UNIT_H
#define PLANEFOLD_TESTS_INERTIAL_UNIT_H

#include <planefold/planefold.h>

static inline void use_inertial_unit(pf_config_t* of, int32_t max_imu_samples) {
  of->motion.model = PF_MOTION_INERTIAL;
  of->capacity.max_imu_samples = max_imu_samples;
  of->imu.gyro_density = 2e-4;
  of->imu.accel_density = 2e-3;
  of->imu.gyro_walk = 2e-5;
  of->imu.accel_walk = 3e-3;
}

#endif
