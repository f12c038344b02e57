set(PLANEFOLD_FLOAT_TESTS
    unit/test_build_mode.cpp
    jacobian/test_camera.cpp
    jacobian/test_planar_pose.cpp
    unit/test_camera.cpp
    unit/test_planar_pose.cpp
    unit/test_small_geometry.cpp
)
