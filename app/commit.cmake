# Writes OUTPUT, a C file with the commit that SOURCE is at, if it is another than before: cmake -P commit.cmake
set(commit unknown)
find_package(Git QUIET)
if(GIT_FOUND)
    execute_process(COMMAND ${GIT_EXECUTABLE} describe --always --exclude=* --abbrev=12 --dirty=-changed
        WORKING_DIRECTORY ${SOURCE} OUTPUT_VARIABLE found RESULT_VARIABLE fault ERROR_QUIET
        OUTPUT_STRIP_TRAILING_WHITESPACE)
    # not that of a repository in which an unpacked archive happens to lie
    execute_process(COMMAND ${GIT_EXECUTABLE} rev-parse --show-prefix WORKING_DIRECTORY ${SOURCE}
        OUTPUT_VARIABLE prefix ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
    if(NOT fault AND found AND NOT prefix)
        set(commit ${found})
    endif()
endif()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "#include \"app/command.h\"\n\nconst char app_commit[] = \"${commit}\";\n")
