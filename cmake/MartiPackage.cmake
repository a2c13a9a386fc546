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

# What `cpack` packs: the program with its manual page, completions, configurations, documents and licence.
install(DIRECTORY "${PROJECT_SOURCE_DIR}/configs" DESTINATION "${CMAKE_INSTALL_DATADIR}/marti" COMPONENT program)
install(DIRECTORY "${PROJECT_SOURCE_DIR}/docs/" DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT program)
install(FILES "${PROJECT_SOURCE_DIR}/README.md" DESTINATION "${CMAKE_INSTALL_DOCDIR}" RENAME OVERVIEW.md
        COMPONENT program)
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION "${CMAKE_INSTALL_DOCDIR}" RENAME copyright
        COMPONENT program)

set(CPACK_GENERATOR DEB)
set(CPACK_COMPONENTS_ALL program)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME marti)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "The authors of marti <marti@localhost>")
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION "simulator of multiprocessor ray-tracing machines
 Renders a scene with a real ray tracer, records every step, and says how long the frame takes on machines of
 processor nodes with caches, interconnects and memory banks, and what would make it shorter.")
# The libraries that the program links to and those of its modules name their packages themselves.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
include(CPack)
