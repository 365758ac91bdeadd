# Builds the library for 64-bit ARM: Debian's cross compiler, and qemu to run the tests. Used by the preset `aarch64`.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY NEVER)
find_program(SKEIN_QEMU NAMES qemu-aarch64-static qemu-aarch64)
set(CMAKE_CROSSCOMPILING_EMULATOR ${SKEIN_QEMU})
set(CMAKE_EXE_LINKER_FLAGS_INIT "-static") # qemu has no libraries of that machine
