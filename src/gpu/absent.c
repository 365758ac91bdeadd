/* The graphics card's functions in a library built without OpenGL: they report that there is only the processor. */
#include "world/world.h"

skein_status skein_world_device_set(skein_world *world, skein_device device) {
    SK_NEED(world, world);
    if (device == SKEIN_DEVICE_CPU) return sk_world_set_device(world, NULL);
    return sk_fail(sk_world_error(world), SKEIN_ERROR_VALUE, "device",
                   "this build cannot run on graphics cards: build it with -DSKEIN_GPU=ON, which needs libepoxy "
                   "(Debian: libepoxy-dev, libegl-dev)");
}

skein_device_info skein_world_device(const skein_world *world) {
    if (!world) return (skein_device_info){.name = ""};
    if (world->device) return (skein_device_info){.device = SKEIN_DEVICE_SHARED, .name = world->device->name};
    return (skein_device_info){.device = SKEIN_DEVICE_CPU, .name = "processor"};
}
