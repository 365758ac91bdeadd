/* Making a context through EGL without a window, and entering and leaving it. */
#include "gpu/context.h"

#include <dlfcn.h>
#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <stdio.h>
#include <string.h>

#include "base/status.h"

enum { MOST_DEVICES = 16 };

/* Fills in the names; refuses OpenGL older than 4.5. The context must be current. */
static skein_status look_at(sk_gpu_context *context, skein_error *error) {
    const char *renderer = (const char *)glGetString(GL_RENDERER), *version = (const char *)glGetString(GL_VERSION);
    if (!renderer || !version || epoxy_gl_version() < 45 || !epoxy_is_desktop_gl())
        return sk_fail(error, SKEIN_ERROR_VALUE, "device", "steps on a graphics card need OpenGL 4.5; here is %s",
                       version ? version : "none");
    snprintf(context->name, sizeof context->name, "%s, %s", renderer, version);
    context->software = strstr(renderer, "llvmpipe") || strstr(renderer, "softpipe") || strstr(renderer, "Software");
    return SKEIN_OK;
}

/* Makes a 4.5 core context on a display, and checks it. It is not current afterwards. */
static bool try_display(sk_gpu_context *context, EGLDisplay display, skein_error *error) {
    static const EGLint wanted[] = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
    static const EGLint attributes[] = {
        EGL_CONTEXT_MAJOR_VERSION,           4,       EGL_CONTEXT_MINOR_VERSION, 5, EGL_CONTEXT_OPENGL_PROFILE_MASK,
        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
    EGLint major, minor, count = 0;
    if (display == EGL_NO_DISPLAY || !eglInitialize(display, &major, &minor) || 10 * major + minor < 15 ||
        !epoxy_has_egl_extension(display, "EGL_KHR_surfaceless_context") || !eglBindAPI(EGL_OPENGL_API))
        return false;
    EGLConfig config = EGL_NO_CONFIG_KHR;
    if (!epoxy_has_egl_extension(display, "EGL_KHR_no_config_context"))
        eglChooseConfig(display, wanted, &config, 1, &count);
    EGLContext made = eglCreateContext(display, config, EGL_NO_CONTEXT, attributes);
    if (made == EGL_NO_CONTEXT) return false;
    context->display = display;
    context->context = made;
    context->own = true;
    sk_gpu_context_enter(context);
    bool good = eglGetCurrentContext() == made && !look_at(context, error);
    sk_gpu_context_leave(context);
    if (!good) eglDestroyContext(display, made);
    return good;
}

/* Tries the graphics cards; or, if `software`, the devices that render on the processor. */
static bool try_devices(sk_gpu_context *context, bool software, skein_error *error) {
    EGLDeviceEXT devices[MOST_DEVICES];
    EGLint count = 0;
    if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_device") ||
        !(epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_enumeration") ||
          epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_base")) ||
        !eglQueryDevicesEXT(MOST_DEVICES, devices, &count))
        return false;
    for (EGLint i = 0; i < count; i++) {
        const char *words = eglQueryDeviceStringEXT(devices[i], EGL_EXTENSIONS);
        if ((words && strstr(words, "EGL_MESA_device_software")) != software) continue;
        if (try_display(context, eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[i], NULL), error))
            return true;
    }
    return false;
}

skein_status sk_gpu_context_create(sk_gpu_context *context, skein_error *error) {
    *context = (sk_gpu_context){.own = true};
    if (!epoxy_has_egl())
        return sk_fail(error, SKEIN_ERROR_VALUE, "device",
                       "no graphics card can be reached: libEGL is not here (Debian: apt-get install libegl1)");
    bool platforms = epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_base");
    if (platforms && try_devices(context, false, error)) return SKEIN_OK;
    if (platforms && epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless") &&
        try_display(context, eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL), error))
        return SKEIN_OK;
    if (platforms && try_devices(context, true, error)) return SKEIN_OK;
    if (try_display(context, eglGetDisplay(EGL_DEFAULT_DISPLAY), error)) return SKEIN_OK;
    return sk_fail(error, SKEIN_ERROR_VALUE, "device",
                   "no graphics card with OpenGL 4.5 was found through EGL; its driver may be missing "
                   "(Debian: apt-get install libegl1 libgl1-mesa-dri, for software and open drivers)");
}

/* Whether GLX has a current context, found without linking to X. */
static bool glx_is_current(void) {
    void *library = dlopen("libGLX.so.0", RTLD_NOLOAD | RTLD_NOW);
    if (!library) library = dlopen("libGL.so.1", RTLD_NOLOAD | RTLD_NOW);
    if (!library) return false;
    void *(*current)(void) = NULL;
    void *found = dlsym(library, "glXGetCurrentContext");
    memcpy(&current, &found, sizeof found);
    bool is = current && current();
    dlclose(library);
    return is;
}

skein_status sk_gpu_context_adopt(sk_gpu_context *context, skein_error *error) {
    *context = (sk_gpu_context){.own = false};
    if (!(epoxy_has_egl() && eglGetCurrentContext() != EGL_NO_CONTEXT) && !glx_is_current())
        return sk_fail(error, SKEIN_ERROR_VALUE, "device", "no OpenGL context is current on this thread");
    return look_at(context, error);
}

void sk_gpu_context_release(sk_gpu_context *context) {
    if (context->own && context->context) eglDestroyContext(context->display, context->context);
    context->context = NULL;
}

void sk_gpu_context_enter(sk_gpu_context *context) {
    if (!context->own) return;
    context->before.display = eglGetCurrentDisplay();
    context->before.draw = eglGetCurrentSurface(EGL_DRAW);
    context->before.read = eglGetCurrentSurface(EGL_READ);
    context->before.context = eglGetCurrentContext();
    eglBindAPI(EGL_OPENGL_API);
    eglMakeCurrent(context->display, EGL_NO_SURFACE, EGL_NO_SURFACE, context->context);
}

void sk_gpu_context_leave(sk_gpu_context *context) {
    if (!context->own) return;
    eglMakeCurrent(context->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (context->before.context != EGL_NO_CONTEXT)
        eglMakeCurrent(context->before.display, context->before.draw, context->before.read, context->before.context);
}
