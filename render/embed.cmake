# Turns shader files into one C file with an array for each, as render/shader.h declares them:
#     cmake -DOUTPUT=shaders.c "-DFILES=a.glsl;b.glsl" -P embed.cmake
# As numbers, not as a string literal: ISO C promises no more than 4095 characters of one.
set(arrays "")
set(rows "")
set(number 0)
foreach(file IN LISTS FILES)
    get_filename_component(name "${file}" NAME)
    file(READ "${file}" bytes HEX)
    string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
    string(REGEX REPLACE "(0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,)"
        "\\1\n" bytes "${bytes}")
    string(APPEND arrays "static const char text_${number}[] = {\n${bytes}0};\n\n")
    string(APPEND rows "    {\"${name}\", text_${number}},\n")
    math(EXPR number "${number} + 1")
endforeach()
file(WRITE "${OUTPUT}" "/* Made by render/embed.cmake from render/shaders/; do not edit. */
#include \"render/shader.h\"

#include <stddef.h>

${arrays}const render_shader_file render_shader_files[] = {
${rows}    {NULL, NULL},
};
")
