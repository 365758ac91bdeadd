/* WebAssembly has none; see cmocka.h. */
