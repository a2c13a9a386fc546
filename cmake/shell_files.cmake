# cmake -DPROGRAM=marti -DDIRECTORY=dir -P shell_files.cmake: the manual page and the completion scripts, as the
# program prints them, under the names by which man and the shells find them.
cmake_minimum_required(VERSION 3.25)

file(MAKE_DIRECTORY "${DIRECTORY}")
function(print_to file)
  execute_process(COMMAND "${PROGRAM}" ${ARGN} OUTPUT_FILE "${DIRECTORY}/${file}" COMMAND_ERROR_IS_FATAL ANY)
endfunction()
print_to(marti.1 man)
print_to(marti completion bash)
print_to(_marti completion zsh)
print_to(marti.fish completion fish)
