/* Textures for painting; see paints.h. */
#include "render/paints.h"

#include "render/fail.h"

#include <epoxy/gl.h>

enum { map_size = 256 };

void render_paints_create(render_paints *paints) {
    uint8_t pixels[RENDER_COLOUR_MAP_COUNT][map_size][4];
    for (int m = 0; m < RENDER_COLOUR_MAP_COUNT; m++) {
        for (int i = 0; i < map_size; i++) {
            float colour[3];
            render_map_colour((render_colour_map)m, (double)i / (map_size - 1), colour);
            for (int k = 0; k < 3; k++) pixels[m][i][k] = (uint8_t)(255 * colour[k] + 0.5f);
            pixels[m][i][3] = 255;
        }
    }
    glCreateTextures(GL_TEXTURE_1D_ARRAY, 1, &paints->maps);
    glTextureStorage2D(paints->maps, 1, GL_SRGB8_ALPHA8, map_size, RENDER_COLOUR_MAP_COUNT);
    glTextureSubImage2D(paints->maps, 0, 0, 0, map_size, RENDER_COLOUR_MAP_COUNT, GL_RGBA, GL_UNSIGNED_BYTE, pixels);
    glTextureParameteri(paints->maps, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTextureParameteri(paints->maps, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);

    // something to read where no frame has brought an image
    static const uint8_t white[4] = {255, 255, 255, 255};
    glCreateTextures(GL_TEXTURE_2D, 1, &paints->image);
    glTextureStorage2D(paints->image, 1, GL_SRGB8_ALPHA8, 1, 1);
    glTextureSubImage2D(paints->image, 0, 0, 0, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, white);
}

void render_paints_destroy(render_paints *paints) {
    glDeleteTextures(1, &paints->maps);
    glDeleteTextures(1, &paints->image);
    *paints = (render_paints){0};
}

skein_status render_paints_bring(render_paints *paints, const render_frame *frame, skein_error *error) {
    const render_image *image = frame->image;
    if (!image || paints->image_number == frame->image_number) return SKEIN_OK;
    GLint most = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
    if (image->width > most || image->height > most) {
        return render_fail(error, SKEIN_ERROR_VALUE, "image",
                           "the picture of %d x %d is too large; this driver has up to %d x %d", image->width,
                           image->height, most, most);
    }
    int levels = 1;
    while ((image->width | image->height) >> levels) levels++;
    glDeleteTextures(1, &paints->image);
    glCreateTextures(GL_TEXTURE_2D, 1, &paints->image);
    glTextureStorage2D(paints->image, levels, GL_SRGB8_ALPHA8, image->width, image->height);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTextureSubImage2D(paints->image, 0, 0, 0, image->width, image->height, GL_RGB, GL_UNSIGNED_BYTE, image->pixels);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glGenerateTextureMipmap(paints->image);
    glTextureParameteri(paints->image, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    if (epoxy_has_gl_extension("GL_EXT_texture_filter_anisotropic"))
        glTextureParameterf(paints->image, GL_TEXTURE_MAX_ANISOTROPY_EXT, 4);
    paints->image_number = frame->image_number;
    return SKEIN_OK;
}

void render_paints_bind(const render_paints *paints) {
    glBindTextureUnit(3, paints->maps);
    glBindSampler(3, 0);
    glBindTextureUnit(4, paints->image);
    glBindSampler(4, 0);
}

void render_set_material(unsigned program, const render_surface *surface) {
    const render_material *material = &surface->material;
    bool drawn = material->pattern == RENDER_VALUES ? surface->values != NULL : surface->uv != NULL;
    const float *const colours[3] = {material->colour, material->accent, material->lining};
    for (GLint i = 0; i < 3; i++) {
        float light[3];
        render_to_light(colours[i], 1, light);
        glProgramUniform3fv(program, 1 + i, 1, light);
    }
    glProgramUniform1i(program, 4, drawn ? (GLint)material->pattern : RENDER_PLAIN);
    glProgramUniform2fv(program, 5, 1, material->repeats);
    glProgramUniform1f(program, 6, material->translucency);
    glProgramUniform1i(program, 7, surface->rows_first);
    glProgramUniform1f(program, 8, (float)surface->map);
}
