# The Debian package of a native build: cpack -G DEB in the build folder, or tools/package deb.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME planefold)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION "A C library that gives a handheld device its own camera pose and a map of the
planes around it, with the programs pf-capture (tracks a camera, a film or a
folder), pf-eval (compares a run with ground truth), pf-sim and pf-bench.")
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/FinishDebianPackage.cmake)
set(CPACK_PACKAGE_CONTACT "planefold maintainers <planefold@localhost>")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS python3) # pf-eval
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "python3-venv, ffmpeg") # pf-eval's environment, pf-capture's film
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
# One package: the library is static, so that those who have its header have all of it.
set(CPACK_DEB_COMPONENT_INSTALL OFF)
set(CPACK_COMPONENTS_ALL development programs)
include(CPack)
