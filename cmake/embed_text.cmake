# cmake -DINPUT=file -DROOM=room -DNAME=function [-DSCRIPT=ON] -DOUTPUT=file.cpp -P embed_text.cmake: a text file as a
# function std::string_view marti::studies::ROOM::NAME() of the program; with SCRIPT as a Script of the room `report`,
# which is a text with its hash.
cmake_minimum_required(VERSION 3.25)

file(READ "${INPUT}" text)
string(LENGTH "${text}" length)
# The length of a literal that every compiler accepts.
if(text MATCHES "[)]text\"" OR length GREATER 65536)
  message(FATAL_ERROR "${INPUT}: cannot be put between R\"text( and )text\"")
endif()
set(type std::string_view)
set(value "R\"text(${text})text\"")
set(header <string_view>)
if(SCRIPT)
  string(TOLOWER "${text}" lower)
  if(lower MATCHES "</script|</style|<!--")
    message(FATAL_ERROR "${INPUT}: cannot stand in a page")
  endif()
  # A page names a hash in base64: of each three bytes four characters. The last three are two and a zero, and the
  # character that this zero gives is "=".
  string(SHA256 hash "${text}")
  set(characters ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/)
  set(base64 "")
  foreach(at RANGE 0 60 6)
    string(SUBSTRING "${hash}00" ${at} 6 bytes)
    foreach(shift IN ITEMS 18 12 6 0)
      math(EXPR index "0x${bytes} >> ${shift} & 63")
      string(SUBSTRING ${characters} ${index} 1 character)
      string(APPEND base64 "${character}")
    endforeach()
  endforeach()
  string(REGEX REPLACE ".$" "=" base64 "${base64}")
  set(type report::Script)
  set(value "{${value}, \"${base64}\"}")
  set(header "\"studies/report/plots/vega_bundle.h\"")
endif()
file(WRITE "${OUTPUT}.new" "// Made by cmake/embed_text.cmake.
#include ${header}

namespace marti::studies::${ROOM} {

${type} ${NAME}();
${type} ${NAME}() { return ${value}; }

}  // namespace marti::studies::${ROOM}
")
file(COPY_FILE "${OUTPUT}.new" "${OUTPUT}")
