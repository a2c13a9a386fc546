# cmake -DDIRECTORY=dir -DROOM=room -DFUNCTION=name -DHEADER=file.h -DOUTPUT=file.cpp -P embed_charts.cmake: the chart
# and table specifications of a directory as the C++ source of FUNCTION, which HEADER declares in the namespace of ROOM.
cmake_minimum_required(VERSION 3.25)

file(GLOB charts "${DIRECTORY}/*.json")
list(SORT charts)
set(entries "")
foreach(chart IN LISTS charts)
  get_filename_component(file "${chart}" NAME)
  string(REGEX REPLACE "[.].*" "" name "${file}")
  file(READ "${chart}" text)
  if(text MATCHES "[)]chart\"")
    message(FATAL_ERROR "${chart}: cannot be put between R\"chart( and )chart\"")
  endif()
  # A quarter of the 65,536 characters that every compiler accepts in one literal.
  string(LENGTH "${text}" length)
  if(length GREATER 16384)
    message(FATAL_ERROR "${chart}: ${length} characters are too many for a specification")
  endif()
  string(APPEND entries "    {\"${name}\", R\"chart(${text})chart\"},\n")
endforeach()
list(LENGTH charts count)
file(WRITE "${OUTPUT}.new" "// Made by cmake/embed_charts.cmake.
#include <array>

#include \"${HEADER}\"

namespace marti::studies::${ROOM} {

std::span<const tables::ChartSpecification> ${FUNCTION}() {
  static constexpr std::array<tables::ChartSpecification, ${count}> charts{{
${entries}}};
  return charts;
}

}  // namespace marti::studies::${ROOM}
")
file(COPY_FILE "${OUTPUT}.new" "${OUTPUT}")
