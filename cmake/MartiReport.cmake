# The npm packages with which `marti report` draws charts, as cmake/npm/package-lock.json pins them. Sets
#   MARTI_VEGA_BUNDLE   the source that defines studies/report/plots/vega_bundle.h,
#   MARTI_VEGA_SCRIPTS  the files that this source embeds, and
#   MARTI_NODE, MARTI_NODE_MODULES  node and the folder of the packages, with the tests'; empty without npm.
# All of it happens in the build directory, when cmake configures, so that a machine without npm or without
# network builds a program that only lacks the report.
option(MARTI_REPORT "Put the scripts of marti report, which npm fetches, into the program" ON)

set(MARTI_VEGA_BUNDLE "${CMAKE_CURRENT_LIST_DIR}/../studies/report/plots/no_vega_bundle.cpp")
set(MARTI_VEGA_SCRIPTS "")
set(MARTI_NODE_MODULES "")

# marti_fetch_vega(<error>): runs npm ci and bundles the packages, only when something has changed.
function(marti_fetch_vega error)
  set(from "${PROJECT_SOURCE_DIR}/cmake/npm")
  set(here "${PROJECT_BINARY_DIR}/npm")
  if(MARTI_TESTS AND NOT MARTI_SANITIZE)
    set(packages --include=dev)
  else()
    set(packages --omit=dev)
  endif()
  set(wanted "${packages} ${here}")
  foreach(file IN ITEMS package.json package-lock.json bundle.mjs)
    configure_file("${from}/${file}" "${here}/${file}" COPYONLY)
    file(SHA256 "${from}/${file}" hash)
    string(APPEND wanted " ${hash}")
  endforeach()
  set(stamp "${here}/made_of.txt")
  set(made "")
  if(EXISTS "${stamp}")
    file(READ "${stamp}" made)
  endif()
  if(made STREQUAL wanted)
    set(${error} "" PARENT_SCOPE)
    return()
  endif()
  file(REMOVE "${stamp}")
  message(STATUS "npm fetches what marti report draws with")
  # Short timeouts, so that a machine without network soon goes on without the packages.
  execute_process(
    COMMAND "${MARTI_NPM}" ci --ignore-scripts --no-audit --no-fund --no-update-notifier --prefer-offline
      --fetch-retries=1 --fetch-retry-mintimeout=2000 --fetch-timeout=60000 ${packages}
    WORKING_DIRECTORY "${here}" TIMEOUT 300 RESULT_VARIABLE result OUTPUT_QUIET ERROR_VARIABLE text)
  if(result EQUAL 0)
    execute_process(COMMAND "${MARTI_NODE}" bundle.mjs "${here}/node_modules" "${here}"
      WORKING_DIRECTORY "${here}" TIMEOUT 60 RESULT_VARIABLE result OUTPUT_QUIET ERROR_VARIABLE text)
  endif()
  if(result EQUAL 0)
    file(WRITE "${stamp}" "${wanted}")
    set(${error} "" PARENT_SCOPE)
  else()
    set(${error} "npm could not fetch its scripts (${result}):\n${text}" PARENT_SCOPE)
  endif()
endfunction()

if(MARTI_REPORT)
  find_program(MARTI_NODE NAMES node nodejs)
  find_program(MARTI_NPM npm)
  if(MARTI_NODE AND MARTI_NPM)
    marti_fetch_vega(fault)
  else()
    set(fault "node or npm was not found (Debian: nodejs, npm)")
  endif()
  if(fault)
    message(STATUS "marti is built without its report: ${fault}")
  else()
    set(MARTI_VEGA_BUNDLE "${PROJECT_BINARY_DIR}/npm/vega_bundle.cpp")
    foreach(name IN ITEMS vega vega-lite vega-interpreter)
      list(APPEND MARTI_VEGA_SCRIPTS "${PROJECT_BINARY_DIR}/npm/${name}.js")
    endforeach()
    set(MARTI_NODE_MODULES "${PROJECT_BINARY_DIR}/npm/node_modules")
  endif()
endif()
