# cmake -P check_names.cmake -- ROOT: does each file stand in the namespace of its folder, in processors/ and studies/ of
# its room, and do no two types of a namespace's headers have one name? If no file includes both headers the compiler
# does not notice: the linker then uses the destructor of one type for the other. And does every test ask for the result of
# its rc::check()? That prints a failure and returns false; the test goes on. All faults are listed.
cmake_minimum_required(VERSION 3.25)

math(EXPR last "${CMAKE_ARGC} - 1")
set(root "${CMAKE_ARGV${last}}")

# It holds only what the run-time library calls.
set(without_namespace "^studies/cli/last_words[.]cpp$")

set(faults "")
foreach(folder IN ITEMS sim scenes accel memory processors studies)
  file(GLOB_RECURSE files RELATIVE "${root}" "${root}/${folder}/*.h" "${root}/${folder}/*.cpp")
  list(SORT files)
  foreach(file IN LISTS files)
    set(namespace ${folder})
    if(file MATCHES "^(processors|studies)/([a-z_]+)/")
      set(namespace "${folder}::${CMAKE_MATCH_2}")
      file(READ "${root}/${file}" text)
      if(NOT text MATCHES "\nnamespace marti::${namespace} {" AND NOT file MATCHES "${without_namespace}")
        string(APPEND faults "${file}: is not in the namespace marti::${namespace}\n")
      endif()
      if(text MATCHES "\nnamespace marti::${folder} {")
        string(APPEND faults "${file}: opens the namespace marti::${folder}, which belongs to no room\n")
      endif()
    endif()
    if(NOT file MATCHES "[.]h$")
      continue()
    endif()
    file(STRINGS "${root}/${file}" lines REGEX "^(struct|class|enum class) [A-Za-z_].*{")
    foreach(line IN LISTS lines)
      if(NOT line MATCHES "^(struct|class|enum class) (alignas[(][^)]*[)] )?([A-Za-z_]+)")
        continue()  # what followed a semicolon
      endif()
      set(name "${namespace}::${CMAKE_MATCH_3}")
      if(DEFINED "first_${name}")
        string(APPEND faults "${file}: ${name} is a type of ${first_${name}} already\n")
      else()
        set("first_${name}" "${file}")
      endif()
    endforeach()
  endforeach()
endforeach()

file(GLOB_RECURSE files RELATIVE "${root}" "${root}/tests/*.h" "${root}/tests/*.cpp")
list(FILTER files EXCLUDE REGEX "/fixtures/")
foreach(file IN LISTS files)
  file(STRINGS "${root}/${file}" lines REGEX "^ *rc::check[(]")
  if(lines)
    string(APPEND faults "${file}: does not ask for the result of rc::check()\n")
  endif()
endforeach()

if(faults)
  message("${faults}")
  message(FATAL_ERROR "names in a wrong place, or properties that cannot fail (see above)")
endif()
