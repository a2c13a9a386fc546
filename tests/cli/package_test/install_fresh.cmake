# cmake -P install_fresh.cmake -- BUILD PREFIX: installs into an empty directory, so that nothing installed
# earlier can stand in for what is missing now.
cmake_minimum_required(VERSION 3.25)
math(EXPR build "${CMAKE_ARGC} - 2")
math(EXPR prefix "${CMAKE_ARGC} - 1")
set(build "${CMAKE_ARGV${build}}")
set(prefix "${CMAKE_ARGV${prefix}}")
file(REMOVE_RECURSE "${prefix}")
execute_process(COMMAND "${CMAKE_COMMAND}" --install "${build}" --prefix "${prefix}"
                COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
