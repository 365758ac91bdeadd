/* Joining texts, compiling them, and keeping programs by their text, so that none is compiled twice. */
#include "gpu/program.h"

#include <epoxy/gl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/status.h"

/* ---- texts ---- */

static void add(sk_gpu_text *text, const char *chars, size_t length) {
    if (text->no_memory) return;
    if (!sk_reserve(text->allocator, (void **)&text->data, &text->capacity, text->count + length + 1, 1)) {
        text->no_memory = true;
        return;
    }
    memcpy(text->data + text->count, chars, length);
    text->data[text->count += length] = 0;
}

void sk_gpu_put(sk_gpu_text *text, const char *format, ...) {
    char line[1024];
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    if (length > 0) add(text, line, (size_t)length < sizeof line ? (size_t)length : sizeof line - 1);
}

static const char *file_text(const char *name) {
    for (const sk_gpu_file *file = sk_gpu_files; file->name; file++)
        if (!strcmp(file->name, name)) return file->text;
    fprintf(stderr, "skein: src/%s is not among the shaders in this build\n", name);
    abort();
}

void sk_gpu_put_text(sk_gpu_text *text, const char *from, size_t number) {
    char digits[24];
    int length = snprintf(digits, sizeof digits, "%zu", number);
    for (const char *rest = from; *rest;) {
        size_t plain = strcspn(rest, "@");
        add(text, rest, plain);
        rest += plain;
        if (!*rest) break;
        add(text, digits, (size_t)length);
        rest++;
    }
}

void sk_gpu_put_file(sk_gpu_text *text, const char *name, size_t number) {
    sk_gpu_put_text(text, file_text(name), number);
    sk_gpu_put_text(text, "\n", number);
}

/* ---- programs ---- */

static skein_status compile(const char *text, const char *what, unsigned *name, skein_error *error) {
    char log[400] = "";
    GLint fine = 0;
    GLuint shader = glCreateShader(GL_COMPUTE_SHADER), program = glCreateProgram();
    glShaderSource(shader, 1, &text, NULL);
    glCompileShader(shader);
    glGetShaderiv(shader, GL_COMPILE_STATUS, &fine);
    if (!fine) {
        glGetShaderInfoLog(shader, sizeof log, NULL, log);
    } else {
        glAttachShader(program, shader);
        glLinkProgram(program);
        glGetProgramiv(program, GL_LINK_STATUS, &fine);
        if (!fine) glGetProgramInfoLog(program, sizeof log, NULL, log);
    }
    glDeleteShader(shader);
    if (fine) return *name = program, SKEIN_OK;
    glDeleteProgram(program);
    return sk_fail(error, SKEIN_ERROR_VALUE, "device", "%s: the driver cannot compile the shader: %s", what, log);
}

skein_status sk_gpu_program(sk_gpu_programs *programs, sk_allocator *allocator, sk_gpu_text *text, const char *what,
                            unsigned *name, skein_error *error) {
    if (text->no_memory || !SK_RESERVE(allocator, programs, programs->count + 1))
        return sk_fail_memory(error, "a shader");
    for (size_t i = 0; i < programs->count; i++)
        if (!strcmp(programs->data[i].text, text->data)) return *name = programs->data[i].name, SKEIN_OK;
    char *kept = sk_copy_text(allocator, text->data);
    if (!kept) return sk_fail_memory(error, "a shader");
    skein_status status = compile(kept, what, name, error);
    if (status) return sk_release(allocator, kept), status;
    programs->data[programs->count].text = kept;
    programs->data[programs->count++].name = *name;
    return SKEIN_OK;
}

void sk_gpu_programs_release(sk_gpu_programs *programs, sk_allocator *allocator) {
    for (size_t i = 0; i < programs->count; i++) {
        glDeleteProgram(programs->data[i].name);
        sk_release(allocator, programs->data[i].text);
    }
    sk_release(allocator, programs->data);
    *programs = (sk_gpu_programs){NULL, 0, 0};
}
