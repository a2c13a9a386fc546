# cmake -DINPUT=file -DNAME=function -DOUTPUT=file.cpp -P embed_text.cmake: a text file as a function
# std::string_view marti::studies::NAME() of the program.
cmake_minimum_required(VERSION 3.25)

file(READ "${INPUT}" text)
string(LENGTH "${text}" length)
# The length of a literal that every compiler accepts.
if(text MATCHES "[)]text\"" OR length GREATER 65536)
  message(FATAL_ERROR "${INPUT}: cannot be put between R\"text( and )text\"")
endif()
file(WRITE "${OUTPUT}.new" "// Made by cmake/embed_text.cmake.
#include <string_view>

namespace marti::studies {

std::string_view ${NAME}();
std::string_view ${NAME}() { return R\"text(${text})text\"; }

}  // namespace marti::studies
")
file(COPY_FILE "${OUTPUT}.new" "${OUTPUT}")
