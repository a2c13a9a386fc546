# cmake -P check_includes.cmake -- ROOT: does every #include of the project's folders point in an allowed
# direction, and does every other library's header stay where it belongs? All faults are listed.
cmake_minimum_required(VERSION 3.25)

math(EXPR last "${CMAKE_ARGC} - 1")
set(root "${CMAKE_ARGV${last}}")

set(folders sim scenes accel memory processors studies)
set(sim_may_include)
set(scenes_may_include sim)
set(accel_may_include scenes sim)
set(memory_may_include sim)
set(processors_may_include accel memory scenes sim)
set(studies_may_include accel memory processors scenes sim)

# A header pattern and the pattern of the files that may include it. C++'s own headers, which anyone may
# include, have neither dot nor slash.
set(patterns "")
set(places "")
macro(allow header_pattern file_pattern)
  list(APPEND patterns "${header_pattern}")
  list(APPEND places "${file_pattern}")
endmacro()
allow("^(sys/[a-z]+|fcntl|unistd|[a-z]mmintrin)[.]h$" ".")
allow("^glm/" "^(scenes|accel|processors|studies)/")
allow("^toml[+][+]/" "^sim/[a-z_]+[.]cpp$")
allow("^tiny_gltf[.]h$" "^scenes/gltf[a-z_]*[.](h|cpp)$")
allow("^(oneapi/)?tbb/" "^(scenes|accel|processors|studies)/[a-z_/]+[.]cpp$")
allow("^nlohmann/json_fwd[.]hpp$" "^studies/")
allow("^nlohmann/json[.]hpp$" "^(scenes|studies)/[a-z_/]+[.]cpp$")
allow("^fmt/" "^(scenes|processors|studies)/[a-z_/]+[.]cpp$")
allow("^sqlite3[.]h$" "^studies/results/sqlite[.]cpp$")
allow("^CLI/" "^studies/[a-z_]+[.]cpp$")
allow("^OpenImageIO/" "^studies/[a-z_]+[.]cpp$")

# What is computed and when it happens are two worlds that meet in the work log alone. Files, the headers
# they must not include, and why. The operation mixes are counted by running the tracer, hence the exception.
set(world_files
  "^processors/program/"
  "^processors/([a-np-z]|o[^p])[a-z_]*[.](h|cpp)$")
set(world_headers
  "^(memory/|processors/[^/]+$)"
  "^processors/program/(render|tracer|shading|recorder)[.]h$")
set(world_reasons
  "the ray-tracing program must not know the machine"
  "the machine must not know the ray-tracing program")

set(faults "")
set(checked 0)
foreach(folder IN LISTS folders)
  file(GLOB_RECURSE files RELATIVE "${root}" "${root}/${folder}/*.h" "${root}/${folder}/*.cpp")
  foreach(file IN LISTS files)
    math(EXPR checked "${checked} + 1")
    file(READ "${root}/${file}" text)
    string(REGEX REPLACE "[][;\\\\]" "_" text "${text}")  # characters that CMake's lists treat specially
    string(REPLACE "\n" ";" lines "${text}")
    set(number 0)
    foreach(line IN LISTS lines)
      math(EXPR number "${number} + 1")
      if(line MATCHES "^[ \t]*#[ \t]*include[ \t]*\"([^\"]*)\"")
        set(header "${CMAKE_MATCH_1}")
        string(REGEX REPLACE "/.*" "" target "${header}")
        if(NOT target STREQUAL folder AND NOT target IN_LIST ${folder}_may_include)
          string(APPEND faults "${file}:${number}: ${folder} must not include ${target} (${header})\n")
        elseif(NOT EXISTS "${root}/${header}" AND NOT EXISTS "${root}/${header}.in")
          string(APPEND faults "${file}:${number}: there is no ${header}; includes start at the root\n")
        endif()
        foreach(files headers reason IN ZIP_LISTS world_files world_headers world_reasons)
          if(file MATCHES "${files}" AND header MATCHES "${headers}")
            string(APPEND faults "${file}:${number}: ${reason} (${header})\n")
          endif()
        endforeach()
      elseif(line MATCHES "^[ \t]*#[ \t]*include[ \t]*<([^>]*)>")
        set(header "${CMAKE_MATCH_1}")
        if(NOT header MATCHES "[./]")
          continue()
        endif()
        set(declared FALSE)
        foreach(pattern place IN ZIP_LISTS patterns places)
          if(header MATCHES "${pattern}")
            set(declared TRUE)
            if(NOT file MATCHES "${place}")
              string(APPEND faults "${file}:${number}: <${header}> belongs in ${place}\n")
            endif()
            break()
          endif()
        endforeach()
        if(NOT declared)
          string(APPEND faults "${file}:${number}: <${header}> is not a declared library of the project\n")
        endif()
      endif()
    endforeach()
  endforeach()
endforeach()

if(checked EQUAL 0)
  message(FATAL_ERROR "no sources below ${root}")
endif()
if(faults)
  # message() breaks long lines of an error; a notice keeps "file:line:" whole.
  message("${faults}")
  message(FATAL_ERROR "includes in a wrong direction (see above)")
endif()
message(STATUS "the includes of ${checked} files are in order")
