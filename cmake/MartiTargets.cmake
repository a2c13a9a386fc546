# How every target of the project is compiled, and the helpers that make one.
include(GNUInstallDirs)
find_package(Threads REQUIRED)

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Kind of build" FORCE)
endif()

find_program(MARTI_CCACHE ccache)
if(MARTI_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # Paths below the project count relative to the build directory, so that a clone elsewhere finds what this one has
  # compiled.
  set(CMAKE_CXX_COMPILER_LAUNCHER
    "${CMAKE_COMMAND}" -E env "CCACHE_BASEDIR=${PROJECT_SOURCE_DIR}" CCACHE_NOHASHDIR=1 "${MARTI_CCACHE}")
endif()

# All code may become part of the shared library (marti/CMakeLists.txt). Nobody puts other functions in the place of
# ours, so they are called and inlined as in a program.
set(CMAKE_POSITION_INDEPENDENT_CODE ON)

# Where the programs of the build tree find what they load while they run (studies/CMakeLists.txt).
set(MARTI_MODULES "${PROJECT_BINARY_DIR}/modules")
list(APPEND CMAKE_BUILD_RPATH "${MARTI_MODULES}")

# Warnings and floating-point rules. -ffp-contract=off: a fused multiply-add in an edge function changes
# the sign of near-zero areas, and watertightness rests on those signs.
add_library(marti_options INTERFACE)
target_compile_options(marti_options INTERFACE
  -Wall -Wextra -Wshadow -Wconversion -Wnon-virtual-dtor -Wold-style-cast -Wno-psabi -ffp-contract=off
  -fno-semantic-interposition)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # GCC bug 105329: false warnings about operator+ of std::string.
  target_compile_options(marti_options INTERFACE -Wno-restrict)
endif()
if(CMAKE_UNITY_BUILD)
  # Files that are compiled as one see each other's local names.
  target_compile_options(marti_options INTERFACE
    -Wno-shadow $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endif()
if(MARTI_SANITIZE)
  target_compile_options(marti_options INTERFACE
    -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
  # These four check every access through a pointer: they take 40 % of the time to compile, and the address
  # sanitizer ends the program at a null pointer all the same.
  target_compile_options(marti_options INTERFACE -fno-sanitize=null,alignment,object-size,vptr)
  if(NOT MARTI_SANITIZE_SCOPES)
    # This check takes a quarter of the time to compile, so only ./test --full asks for it.
    target_compile_options(marti_options INTERFACE -fno-sanitize-address-use-after-scope)
  endif()
  # Checks of memory as calls instead of inline: a tenth less to compile, for code that is not called often.
  set(MARTI_SANITIZE_BY_CALLS $<$<CXX_COMPILER_ID:GNU>:--param=asan-instrumentation-with-call-threshold=0>)
  target_link_options(marti_options INTERFACE -fsanitize=address,undefined)
  # dlopen() looks where the library that calls it says. The sanitizers' dlopen() calls it for the program, whose paths
  # count for its libraries too only in the older of the two forms.
  target_link_options(marti_options INTERFACE LINKER:--disable-new-dtags)
endif()
if(MARTI_FUZZ)
  target_compile_options(marti_options INTERFACE -fsanitize=fuzzer-no-link)
endif()

# The folders that are installed as libraries, each a component of the package (cmake/MartiPackage.cmake).
set(MARTI_COMPONENTS sim scenes accel memory processors)

# For text and tests, which take longer to compile than to run: they are hardly optimised, and GCC, half of whose time there
# goes into headers and templates, looks for unused memory less often (a fifth of its time, for a tenth more memory).
set(MARTI_QUICK_TO_COMPILE $<$<CONFIG:Release>:-O1> $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-expand=400>)

# marti_add_library(<folder> [PUBLIC libs...] [PRIVATE libs...]): the static library of all sources of one folder,
# target marti_<folder>, alias marti::<folder>. Headers are included from the project's root.
function(marti_add_library folder)
  cmake_parse_arguments(ARG "" "" "PUBLIC;PRIVATE" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS "${CMAKE_CURRENT_SOURCE_DIR}/*.cpp")
  add_library(marti_${folder} STATIC ${sources})
  add_library(marti::${folder} ALIAS marti_${folder})
  set_target_properties(marti_${folder} PROPERTIES EXPORT_NAME ${folder})
  target_include_directories(marti_${folder} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/marti>)
  target_compile_features(marti_${folder} PUBLIC cxx_std_20)
  target_link_libraries(marti_${folder} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE} $<BUILD_INTERFACE:marti_options>)
  if(folder IN_LIST MARTI_COMPONENTS)
    # An export set of its own, so that a component can be loaded without the packages of the others.
    install(TARGETS marti_${folder} EXPORT marti-${folder} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
    install(EXPORT marti-${folder} NAMESPACE marti:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/marti)
    install(DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/marti/${folder}
            FILES_MATCHING PATTERN "*.h")
  endif()
endfunction()

# marti_add_test(<name> SOURCES ... [LIBS ...] [SHARDS n]): one GoogleTest program. CTest runs it as
# one test or, where it takes long, as n tests that share its cases among them, so that they can run side by side.
function(marti_add_test name)
  cmake_parse_arguments(ARG "" "SHARDS" "SOURCES;LIBS" ${ARGN})
  if(NOT ARG_SHARDS)
    set(ARG_SHARDS 1)
  endif()
  set(timeout 300)
  if(MARTI_SANITIZE)
    set(timeout 1500)  # the sanitizers slow some tests down by thirty
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_LIBS} marti_options GTest::gtest_main)
  target_compile_options(${name} PRIVATE ${MARTI_QUICK_TO_COMPILE} ${MARTI_SANITIZE_BY_CALLS})
  math(EXPR last "${ARG_SHARDS} - 1")
  foreach(shard RANGE ${last})
    set(test ${name})
    if(ARG_SHARDS GREATER 1)
      set(test ${name}_${shard})
    endif()
    add_test(NAME ${test} COMMAND ${name})
    set_tests_properties(${test} PROPERTIES TIMEOUT ${timeout}
      ENVIRONMENT "GTEST_TOTAL_SHARDS=${ARG_SHARDS};GTEST_SHARD_INDEX=${shard}")
  endforeach()
endfunction()
