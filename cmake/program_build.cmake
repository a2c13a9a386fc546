# cmake -DROOT=... -DFOLDERS=... -DVERSION=... -DOUTPUT=... -P program_build.cmake: writes the source with the hash of
# the sources in these folders of ROOT. Paths are hashed too; the output changes only when a path or the content of a
# file does.
cmake_minimum_required(VERSION 3.25)

set(files "")
foreach(folder IN LISTS FOLDERS)
  file(GLOB_RECURSE found RELATIVE "${ROOT}" "${ROOT}/${folder}/*.h" "${ROOT}/${folder}/*.cpp")
  list(APPEND files ${found})
endforeach()
list(SORT files)
set(hashes "")
foreach(file IN LISTS files)
  file(SHA256 "${ROOT}/${file}" hash)
  string(APPEND hashes "${file} ${hash}\n")
endforeach()
string(SHA256 hash "${hashes}")
string(SUBSTRING "${hash}" 0 16 digits)
file(CONFIGURE OUTPUT "${OUTPUT}" @ONLY CONTENT [[
#include "studies/host/program_build.h"

namespace marti::studies::host {

std::string_view build_of_program() { return "marti @VERSION@ @digits@"; }

}  // namespace marti::studies::host
]])
