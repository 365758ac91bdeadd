/* What the OpenGL driver has to say; see messages.h. */
#include "render/messages.h"

#include <epoxy/gl.h>
#include <stdio.h>
#include <string.h>

static void GLAPIENTRY collect(GLenum source, GLenum type, GLuint id, GLenum severity, GLsizei length,
                               const GLchar *text, const void *user) {
    render_messages *messages = (render_messages *)user;
    (void)source, (void)id, (void)length;
    // NVIDIA's driver tells of each framebuffer's storage so
    bool told = severity == GL_DEBUG_SEVERITY_LOW && type == GL_DEBUG_TYPE_OTHER;
    if (told || severity == GL_DEBUG_SEVERITY_NOTIFICATION) return;

    if (type == GL_DEBUG_TYPE_ERROR || type == GL_DEBUG_TYPE_UNDEFINED_BEHAVIOR || severity == GL_DEBUG_SEVERITY_HIGH) {
        messages->errors++;
    } else if (type == GL_DEBUG_TYPE_PERFORMANCE) {
        return;
    } else {
        messages->warnings++;
    }
    snprintf(messages->last, sizeof messages->last, "%s", text);
}

void render_messages_attach(render_messages *messages) {
    memset(messages, 0, sizeof *messages);
    glEnable(GL_DEBUG_OUTPUT);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    glDebugMessageControl(GL_DONT_CARE, GL_DONT_CARE, GL_DONT_CARE, 0, NULL, GL_TRUE);
    glDebugMessageCallback(collect, messages);
}
