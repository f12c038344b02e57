# Finds the Unity test framework and defines the target planefold_unity.
#
# In this order: what is installed (a CMake package, or UNITY_ROOT with unity.c in it or in its src/),
# the copy inside Debian's source package ntpsec, a download by CMake. What is fetched is kept in
# build/_deps, which all presets share.

set(UNITY_ROOT "$ENV{UNITY_ROOT}" CACHE PATH "Folder of an installed or unpacked Unity")
set(PLANEFOLD_DEPS_DIR ${PROJECT_SOURCE_DIR}/build/_deps CACHE PATH "Where fetched sources are kept")

set(unity_source "")
find_path(unity_root_dir NAMES unity.c PATHS ${UNITY_ROOT} ${PLANEFOLD_DEPS_DIR}/unity
          PATH_SUFFIXES src NO_DEFAULT_PATH NO_CMAKE_FIND_ROOT_PATH)
if(NOT unity_root_dir)
  find_package(unity QUIET CONFIG)
  if(NOT TARGET unity::framework)
    execute_process(COMMAND bash ${CMAKE_CURRENT_LIST_DIR}/fetch_unity_from_debian.sh
                            ${PLANEFOLD_DEPS_DIR}/unity
                    RESULT_VARIABLE unity_fetch_result)
    if(unity_fetch_result EQUAL 0)
      find_path(unity_root_dir NAMES unity.c PATHS ${PLANEFOLD_DEPS_DIR}/unity NO_DEFAULT_PATH
                NO_CMAKE_FIND_ROOT_PATH)
    endif()
  endif()
endif()

add_library(planefold_unity INTERFACE)
target_compile_definitions(planefold_unity INTERFACE UNITY_INCLUDE_DOUBLE UNITY_SUPPORT_64)
if(unity_root_dir)
  message(STATUS "Unity: ${unity_root_dir}")
  add_library(planefold_unity_objects STATIC ${unity_root_dir}/unity.c)
  target_compile_definitions(planefold_unity_objects PRIVATE UNITY_INCLUDE_DOUBLE UNITY_SUPPORT_64)
  target_include_directories(planefold_unity_objects SYSTEM PUBLIC ${unity_root_dir})
  target_link_libraries(planefold_unity INTERFACE planefold_unity_objects)
elseif(TARGET unity::framework)
  message(STATUS "Unity: installed package ${unity_DIR}")
  target_link_libraries(planefold_unity INTERFACE unity::framework)
else()
  message(STATUS "Unity: fetching the release")
  include(FetchContent)
  FetchContent_Declare(unity
    URL https://github.com/ThrowTheSwitch/Unity/archive/refs/tags/v2.5.2.tar.gz
    DOWNLOAD_EXTRACT_TIMESTAMP TRUE SOURCE_DIR ${PLANEFOLD_DEPS_DIR}/unity-release)
  FetchContent_MakeAvailable(unity)
  target_compile_definitions(unity PUBLIC UNITY_INCLUDE_DOUBLE UNITY_SUPPORT_64)
  target_link_libraries(planefold_unity INTERFACE unity)
endif()
