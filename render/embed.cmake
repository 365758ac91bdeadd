# Turns shader files into one C file with an array for each, as render/shader.h declares them:
#     cmake -DOUTPUT=shaders.c "-DFILES=a.glsl;b.glsl" -P embed.cmake
# For the library, which declares them in a HEADER of its own, as an ARRAY of a TYPE, files are named by their path from
# the ROOT without ".glsl".
if(NOT HEADER)
    set(HEADER render/shader.h)
    set(TYPE render_shader_file)
    set(ARRAY render_shader_files)
endif()
# As numbers, not as a string literal: ISO C promises no more than 4095 characters of one.
set(arrays "")
set(rows "")
set(number 0)
foreach(file IN LISTS FILES)
    get_filename_component(name "${file}" NAME)
    if(ROOT)
        file(RELATIVE_PATH name "${ROOT}" "${file}")
        string(REGEX REPLACE "[.](glsl|c)$" "" name "${name}")
    endif()
    file(READ "${file}" bytes HEX)
    file(READ "${file}" text)
    string(FIND "${text}" "\n// ---- arithmetic ----\n" begin)
    if(begin GREATER -1) # of C what stands between two comments
        string(REGEX REPLACE "[.]h$" "" name "${name}")
        string(FIND "${text}" "// ---- end of arithmetic ----" end)
        math(EXPR length "${end} - ${begin}")
        string(SUBSTRING "${text}" ${begin} ${length} text)
        string(HEX "${text}" bytes)
    endif()
    string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
    string(REGEX REPLACE "(0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,)"
        "\\1\n" bytes "${bytes}")
    string(APPEND arrays "static const char text_${number}[] = {\n${bytes}0};\n\n")
    string(APPEND rows "    {\"${name}\", text_${number}},\n")
    math(EXPR number "${number} + 1")
endforeach()
file(WRITE "${OUTPUT}" "/* Made by render/embed.cmake; do not edit. */
#include \"${HEADER}\"

#include <stddef.h>

${arrays}const ${TYPE} ${ARRAY}[] = {
${rows}    {NULL, NULL},
};
")
