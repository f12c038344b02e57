set(PLANEFOLD_FLOAT_TESTS
    unit/test_build_mode.cpp
    jacobian/test_camera.cpp
    unit/test_camera.cpp
)
