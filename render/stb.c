/* stb's code, compiled here and nowhere else, with warnings off (CMakeLists.txt); see stb.h. */
#include "render/stb.h"

#include <stdlib.h>
#include <zlib.h>

/* zlib in the place of stb's own compressor, whose PNGs are a third larger. */
static unsigned char *compress_with_zlib(unsigned char *data, int length, int *out_length, int quality) {
    uLongf size = compressBound((uLong)length);
    unsigned char *out = malloc(size);
    if (!out || compress2(out, &size, data, (uLong)length, quality) != Z_OK) {
        free(out);
        return NULL;
    }
    *out_length = (int)size;
    return out;
}
#define STBIW_ZLIB_COMPRESS compress_with_zlib
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>

#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#include <stb/stb_image.h>

uint8_t *render_stb_encode_png(const uint8_t *pixels, int width, int height, int *length) {
    return stbi_write_png_to_mem(pixels, 3 * width, width, height, 3, length);
}

bool render_stb_measure(FILE *file, int *width, int *height, const char **problem) {
    int channels = 0;
    bool good = stbi_info_from_file(file, width, height, &channels) != 0;
    if (!good) *problem = stbi_failure_reason();
    return good;
}

uint8_t *render_stb_decode(FILE *file, int *width, int *height, const char **problem) {
    int channels = 0;
    uint8_t *pixels = stbi_load_from_file(file, width, height, &channels, 3);
    if (!pixels) *problem = stbi_failure_reason();
    return pixels;
}
