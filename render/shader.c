/* Shader programs; see shader.h. */
#include "render/shader.h"

#include "render/fail.h"

#include <epoxy/gl.h>
#include <stdio.h>
#include <string.h>

enum { most_files = 8 };

static const char *find_text(const char *name, size_t length) {
    for (const render_shader_file *file = render_shader_files; file->name; file++) {
        if (strncmp(file->name, name, length) == 0 && strcmp(file->name + length, ".glsl") == 0) return file->text;
    }
    return NULL;
}

/* The texts of "a,b", with common.glsl before them; returns how many, 0 where one is missing. */
static GLsizei gather(const char *files, const char *texts[most_files]) {
    GLsizei count = 0;
    texts[count++] = find_text("common", 6);
    while (*files && count < most_files) {
        size_t length = strcspn(files, ",");
        texts[count] = find_text(files, length);
        if (!texts[count++]) return 0;
        files += length;
        if (*files) files++;
    }
    return texts[0] ? count : 0;
}

static GLuint compile(GLenum stage, const char *files, skein_error *error) {
    const char *texts[most_files];
    GLsizei count = gather(files, texts);
    if (count == 0) {
        render_fail(error, SKEIN_ERROR_NAME, files, "no such shader file in this build");
        return 0;
    }
    GLuint shader = glCreateShader(stage);
    glShaderSource(shader, count, texts, NULL);
    glCompileShader(shader);

    GLint fine = 0;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &fine);
    if (!fine) {
        char log[400] = "";
        glGetShaderInfoLog(shader, sizeof log, NULL, log);
        render_fail(error, SKEIN_ERROR_VALUE, files, "the driver cannot compile the shader: %s", log);
        glDeleteShader(shader);
        return 0;
    }
    return shader;
}

/* Links what is attached, or deletes the program; 0 on failure. */
static GLuint finish(GLuint program, const char *files, skein_error *error) {
    GLint fine = 0;
    glLinkProgram(program);
    glGetProgramiv(program, GL_LINK_STATUS, &fine);
    if (fine) return program;
    char log[400] = "";
    glGetProgramInfoLog(program, sizeof log, NULL, log);
    render_fail(error, SKEIN_ERROR_VALUE, files, "the driver cannot link the shaders: %s", log);
    glDeleteProgram(program);
    return 0;
}

unsigned render_shader_link(const char *vertex, const char *fragment, skein_error *error) {
    GLuint vertex_shader = compile(GL_VERTEX_SHADER, vertex, error), fragment_shader = 0, program = 0;
    if (vertex_shader && fragment) fragment_shader = compile(GL_FRAGMENT_SHADER, fragment, error);
    if (vertex_shader && (fragment_shader || !fragment)) {
        program = glCreateProgram();
        glAttachShader(program, vertex_shader);
        if (fragment_shader) glAttachShader(program, fragment_shader);
        program = finish(program, vertex, error);
    }
    glDeleteShader(vertex_shader);
    glDeleteShader(fragment_shader);
    return program;
}

unsigned render_shader_link_compute(const char *files, skein_error *error) {
    GLuint shader = compile(GL_COMPUTE_SHADER, files, error), program = 0;
    if (!shader) return 0;
    program = glCreateProgram();
    glAttachShader(program, shader);
    glDeleteShader(shader); // with the program
    return finish(program, files, error);
}
