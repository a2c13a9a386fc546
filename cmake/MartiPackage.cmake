# The package config that `cmake --install` puts beside the libraries, for find_package(marti).
include(CMakePackageConfigHelpers)

get_property(MARTI_SCENES_PACKAGES GLOBAL PROPERTY MARTI_SCENES_PACKAGES)
configure_package_config_file(
  "${PROJECT_SOURCE_DIR}/cmake/martiConfig.cmake.in" "${PROJECT_BINARY_DIR}/martiConfig.cmake"
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/marti
  NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file("${PROJECT_BINARY_DIR}/martiConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/martiConfig.cmake" "${PROJECT_BINARY_DIR}/martiConfigVersion.cmake"
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/marti)
