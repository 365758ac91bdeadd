# Builds for WebAssembly: clang, its own runtime (libclang-rt-*-dev-wasm32) and wasi-libc. SIMD of 128 bits, one thread. Used
# by the preset `wasm`; what comes out runs in browsers and in node (tests/wasm/run.mjs). The preset `wasm-threads` is the
# package's other flavour, over shared memory, with workers as threads (bindings/js).
set(CMAKE_SYSTEM_NAME WASI)
set(CMAKE_SYSTEM_PROCESSOR wasm32)
if(NOT CMAKE_C_COMPILER)
    find_program(SKEIN_WASM_CLANG NAMES clang clang-14 clang-19 clang-16 REQUIRED)
    set(CMAKE_C_COMPILER ${SKEIN_WASM_CLANG})
endif()
set(CMAKE_C_COMPILER_TARGET wasm32-wasi)
set(CMAKE_C_FLAGS_INIT "-msimd128")
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
# The libraries of this machine are no use there.
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY NEVER)
set(CMAKE_EXECUTABLE_SUFFIX .wasm)
set(CMAKE_EXE_LINKER_FLAGS_INIT "-Wl,-z,stack-size=1048576")
