# Builds the library for Windows on x86-64: mingw-w64's gcc with POSIX threads, and Wine to run the tests. Used by the
# preset `mingw`.
set(CMAKE_SYSTEM_NAME Windows)
set(CMAKE_SYSTEM_PROCESSOR x86_64)
find_program(SKEIN_MINGW_CC NAMES x86_64-w64-mingw32-gcc-posix x86_64-w64-mingw32-gcc REQUIRED)
set(CMAKE_C_COMPILER ${SKEIN_MINGW_CC})
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY NEVER)
find_program(SKEIN_WINE NAMES wine64 wine HINTS /usr/lib/wine)
if(SKEIN_WINE)
    set(CMAKE_CROSSCOMPILING_EMULATOR ${SKEIN_WINE})
endif()
set(CMAKE_EXE_LINKER_FLAGS_INIT "-static")
