set(PLANEFOLD_FLOAT_TESTS
    unit/test_build_mode.cpp
)
