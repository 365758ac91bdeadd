/* A picture on the card; see target.h. */
#include "render/target.h"

#include "render/fail.h"

#include <epoxy/gl.h>
#include <stdlib.h>
#include <string.h>

/* The most samples up to `wanted` that both formats can have; 1 where there is no multisampling. */
static int supported_samples(int wanted) {
    static const GLenum formats[2] = {GL_SRGB8_ALPHA8, GL_DEPTH_COMPONENT32F};
    int samples = wanted;
    for (int f = 0; f < 2; f++) {
        GLint offered[32] = {0};
        GLint count = 0, best = 1;
        glGetInternalformativ(GL_RENDERBUFFER, formats[f], GL_NUM_SAMPLE_COUNTS, 1, &count);
        glGetInternalformativ(GL_RENDERBUFFER, formats[f], GL_SAMPLES, count < 32 ? count : 32, offered);
        for (int i = 0; i < count && i < 32; i++) {
            if (offered[i] <= samples && offered[i] > best) best = offered[i];
        }
        samples = best;
    }
    return samples;
}

static GLuint make_buffer(GLenum format, int width, int height, int samples) {
    GLuint buffer = 0;
    glCreateRenderbuffers(1, &buffer);
    if (samples > 1) {
        glNamedRenderbufferStorageMultisample(buffer, samples, format, width, height);
    } else {
        glNamedRenderbufferStorage(buffer, format, width, height);
    }
    return buffer;
}

skein_status render_target_create(render_target *target, int width, int height, int samples, skein_error *error) {
    GLint most = 0;
    glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &most);
    if (width < 1 || height < 1 || width > most || height > most) {
        return render_fail(error, SKEIN_ERROR_VALUE, "size",
                           "a picture of %d x %d cannot be drawn; this driver has 1 x 1 to %d x %d", width, height,
                           most, most);
    }

    memset(target, 0, sizeof *target);
    target->width = width, target->height = height;
    target->samples = supported_samples(samples);
    target->colour = make_buffer(GL_SRGB8_ALPHA8, width, height, target->samples);
    target->depth = make_buffer(GL_DEPTH_COMPONENT32F, width, height, target->samples);
    target->plain = make_buffer(GL_SRGB8_ALPHA8, width, height, 1);
    glCreateFramebuffers(1, &target->framebuffer);
    glNamedFramebufferRenderbuffer(target->framebuffer, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, target->colour);
    glNamedFramebufferRenderbuffer(target->framebuffer, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, target->depth);
    glCreateFramebuffers(1, &target->plain_framebuffer);
    glNamedFramebufferRenderbuffer(target->plain_framebuffer, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, target->plain);

    if (glCheckNamedFramebufferStatus(target->framebuffer, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE ||
        glCheckNamedFramebufferStatus(target->plain_framebuffer, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
        render_target_destroy(target);
        return render_fail(error, SKEIN_ERROR_MEMORY, "size",
                           "the driver has no room for a picture of %d x %d with %d samples; ask for less", width,
                           height, samples);
    }
    return SKEIN_OK;
}

void render_target_destroy(render_target *target) {
    glDeleteFramebuffers(1, &target->framebuffer);
    glDeleteFramebuffers(1, &target->plain_framebuffer);
    glDeleteRenderbuffers(1, &target->colour);
    glDeleteRenderbuffers(1, &target->depth);
    glDeleteRenderbuffers(1, &target->plain);
    memset(target, 0, sizeof *target);
}

skein_status render_target_read(const render_target *target, render_image *image, skein_error *error) {
    int width = target->width, height = target->height;
    size_t row = (size_t)width * 3;
    skein_status status = render_image_resize(image, width, height, error);
    if (status != SKEIN_OK) return status;
    uint8_t *swap = malloc(row);
    if (!swap) return render_fail_memory(error, "a row of the picture");

    glEnable(GL_FRAMEBUFFER_SRGB);
    glBlitNamedFramebuffer(target->framebuffer, target->plain_framebuffer, 0, 0, width, height, 0, 0, width, height,
                           GL_COLOR_BUFFER_BIT, GL_NEAREST);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, target->plain_framebuffer);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, image->pixels);

    // OpenGL's rows start at the bottom
    for (int y = 0; y < height / 2; y++) {
        uint8_t *upper = image->pixels + (size_t)y * row, *lower = image->pixels + (size_t)(height - 1 - y) * row;
        memcpy(swap, upper, row);
        memcpy(upper, lower, row);
        memcpy(lower, swap, row);
    }
    free(swap);
    return SKEIN_OK;
}
