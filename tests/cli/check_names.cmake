# cmake -P check_names.cmake -- ROOT: do no two types of a folder's headers have one name? All are in the same namespace,
# and if no file includes both headers the compiler does not notice: the linker then uses the destructor of one type
# for the other.
cmake_minimum_required(VERSION 3.25)

math(EXPR last "${CMAKE_ARGC} - 1")
set(root "${CMAKE_ARGV${last}}")

set(faults "")
foreach(folder IN ITEMS sim scenes accel memory processors studies)
  file(GLOB_RECURSE headers RELATIVE "${root}" "${root}/${folder}/*.h")
  list(SORT headers)
  foreach(header IN LISTS headers)
    file(STRINGS "${root}/${header}" lines REGEX "^(struct|class|enum class) [A-Za-z_].*{")
    foreach(line IN LISTS lines)
      if(NOT line MATCHES "^(struct|class|enum class) (alignas[(][^)]*[)] )?([A-Za-z_]+)")
        continue()  # what followed a semicolon
      endif()
      set(name "${CMAKE_MATCH_3}")
      if(DEFINED first_${folder}_${name})
        string(APPEND faults "${header}: ${name} is a type of ${first_${folder}_${name}} already\n")
      else()
        set(first_${folder}_${name} "${header}")
      endif()
    endforeach()
  endforeach()
endforeach()

if(faults)
  message(FATAL_ERROR "${faults}")
endif()
