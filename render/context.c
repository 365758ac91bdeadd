/* An offscreen OpenGL context; see context.h. */
#include "render/context.h"

#include "render/fail.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { most_devices = 16 };

struct render_context {
    EGLDisplay display;
    EGLContext context;
    render_messages messages;
    char name[256];
};

static const char *egl_text(EGLint code) {
    switch (code) {
    case EGL_SUCCESS: return "no reason given";
    case EGL_NOT_INITIALIZED: return "no driver";
    case EGL_BAD_ACCESS: return "no access";
    case EGL_BAD_ALLOC: return "out of memory";
    case EGL_BAD_MATCH: return "OpenGL 4.5 is not supported";
    case EGL_BAD_CONFIG: return "no configuration";
    case EGL_BAD_DISPLAY: return "no display";
    default: return "it failed";
    }
}

/* Adds "platform: reason" to the list of what was tried. */
static bool give_up(char *tried, size_t room, const char *platform, const char *reason) {
    size_t length = strlen(tried);
    snprintf(tried + length, room - length, "%s%s: %s", length ? "; " : "", platform, reason);
    return false;
}

/* Makes a 4.5 core context of the display current, without any surface. */
static bool make_context(render_context *context, const char **reason) {
    // clang-format off
    static const EGLint attributes[] = {
        EGL_CONTEXT_MAJOR_VERSION, 4,
        EGL_CONTEXT_MINOR_VERSION, 5,
        EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
        EGL_CONTEXT_OPENGL_DEBUG, EGL_TRUE,
        EGL_NONE,
    };
    // clang-format on
    static const EGLint wanted[] = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
    EGLConfig config = EGL_NO_CONFIG_KHR;
    EGLint config_count = 0;

    if (!epoxy_has_egl_extension(context->display, "EGL_KHR_surfaceless_context")) {
        *reason = "it cannot draw without a surface";
        return false;
    }
    if (!eglBindAPI(EGL_OPENGL_API)) {
        *reason = "it has no OpenGL";
        return false;
    }
    if (!epoxy_has_egl_extension(context->display, "EGL_KHR_no_config_context")) {
        eglChooseConfig(context->display, wanted, &config, 1, &config_count);
    }
    context->context = eglCreateContext(context->display, config, EGL_NO_CONTEXT, attributes);
    if (context->context == EGL_NO_CONTEXT) {
        *reason = egl_text(eglGetError());
        return false;
    }
    if (!eglMakeCurrent(context->display, EGL_NO_SURFACE, EGL_NO_SURFACE, context->context)) {
        *reason = egl_text(eglGetError());
        eglDestroyContext(context->display, context->context);
        return false;
    }
    return true;
}

/* Tries one display. */
static bool try_display(render_context *context, EGLDisplay display, const char *platform, char *tried, size_t room) {
    EGLint major = 0, minor = 0;
    const char *reason = "";
    if (display == EGL_NO_DISPLAY) return give_up(tried, room, platform, egl_text(eglGetError()));
    if (!eglInitialize(display, &major, &minor)) return give_up(tried, room, platform, egl_text(eglGetError()));

    context->display = display;
    if (10 * major + minor < 15) {
        reason = "EGL is older than 1.5";
    } else if (make_context(context, &reason)) {
        snprintf(context->name, sizeof context->name, "%s: %s, %s", platform, (const char *)glGetString(GL_RENDERER),
                 (const char *)glGetString(GL_VERSION));
        return true;
    }
    return give_up(tried, room, platform, reason);
}

static bool try_surfaceless(render_context *context, char *tried, size_t room) {
    if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless")) {
        return give_up(tried, room, "surfaceless", "not offered");
    }
    EGLDisplay display = eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
    return try_display(context, display, "surfaceless", tried, room);
}

static bool try_devices(render_context *context, char *tried, size_t room) {
    EGLDeviceEXT devices[most_devices];
    EGLint count = 0;
    bool listed = epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_device") &&
                  (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_enumeration") ||
                   epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_base"));
    if (!listed || !eglQueryDevicesEXT(most_devices, devices, &count)) count = 0;
    for (EGLint i = 0; i < count; i++) {
        EGLDisplay display = eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[i], NULL);
        if (try_display(context, display, "device", tried, room)) return true;
    }
    return count > 0 ? false : give_up(tried, room, "devices", "none");
}

render_context *render_context_create(skein_error *error) {
    char tried[400] = "";
    const char *advice = "install Mesa's drivers (Debian: apt-get install libegl1 libgl1-mesa-dri)";
    if (!epoxy_has_egl()) {
        render_fail(error, SKEIN_ERROR_VALUE, "EGL", "libEGL is not here; %s", advice);
        return NULL;
    }
    render_context *context = calloc(1, sizeof *context);
    if (!context) {
        render_fail_memory(error, "the OpenGL context");
        return NULL;
    }

    // a client without extensions has the default display only
    bool platforms = epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_base");
    if ((platforms && try_surfaceless(context, tried, sizeof tried)) ||
        (platforms && try_devices(context, tried, sizeof tried)) ||
        try_display(context, eglGetDisplay(EGL_DEFAULT_DISPLAY), "default display", tried, sizeof tried)) {
        render_messages_attach(&context->messages);
        return context;
    }
    render_fail(error, SKEIN_ERROR_VALUE, "EGL", "no OpenGL 4.5 to draw with (%s); %s", tried, advice);
    free(context);
    return NULL;
}

/* The display stays as it is: EGL has one for the whole process, so ending it would end other contexts too
 * (and Mesa's driver, unloaded and loaded again, forgets a few tables each time). */
void render_context_destroy(render_context *context) {
    if (!context) return;
    eglMakeCurrent(context->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(context->display, context->context);
    eglReleaseThread();
    free(context);
}

const render_messages *render_context_messages(const render_context *context) {
    return &context->messages;
}

const char *render_context_name(const render_context *context) {
    return context->name;
}
