/* Shadow and occlusion maps; see light.h. */
#include "render/light.h"

#include "render/fail.h"
#include "render/linear.h"
#include "render/shader.h"

#include <epoxy/gl.h>
#include <math.h>
#include <string.h>

/* Texels along a side. On llvmpipe the sun's map takes 20 ms of one core, the lower one 8. */
enum { sun_size = 1024, under_size = 160 };

/* The share of the lower map's side that is left free around the things, as far as taps reach. */
static const double under_margin = 0.22;

/* ---- Making --------------------------------------------------------------------------------- */

static GLuint make_texture(GLenum format, GLsizei size) {
    static const float white[4] = {1, 1, 1, 1};
    GLuint texture = 0;
    glCreateTextures(GL_TEXTURE_2D, 1, &texture);
    glTextureStorage2D(texture, 1, format, size, size);
    glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTextureParameteri(texture, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
    glTextureParameteri(texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
    glTextureParameterfv(texture, GL_TEXTURE_BORDER_COLOR, white);
    return texture;
}

static GLuint make_framebuffer(GLenum attachment, GLuint texture) {
    GLuint framebuffer = 0;
    glCreateFramebuffers(1, &framebuffer);
    glNamedFramebufferTexture(framebuffer, attachment, texture, 0);
    if (attachment == GL_DEPTH_ATTACHMENT) {
        glNamedFramebufferDrawBuffer(framebuffer, GL_NONE);
        glNamedFramebufferReadBuffer(framebuffer, GL_NONE);
    }
    return framebuffer;
}

static bool complete(GLuint framebuffer) {
    return glCheckNamedFramebufferStatus(framebuffer, GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

skein_status render_light_create(render_light *light, skein_error *error) {
    static const float white[4] = {1, 1, 1, 1};
    light->sun_depth = make_texture(GL_DEPTH_COMPONENT32F, sun_size);
    light->below_depth = make_texture(GL_DEPTH_COMPONENT32F, under_size);
    light->under_light = make_texture(GL_R16, under_size);
    glTextureParameteri(light->sun_depth, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTextureParameteri(light->sun_depth, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTextureParameteri(light->below_depth, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTextureParameteri(light->below_depth, GL_TEXTURE_MAG_FILTER, GL_NEAREST);

    light->sun_framebuffer = make_framebuffer(GL_DEPTH_ATTACHMENT, light->sun_depth);
    light->below_framebuffer = make_framebuffer(GL_DEPTH_ATTACHMENT, light->below_depth);
    light->under_framebuffer = make_framebuffer(GL_COLOR_ATTACHMENT0, light->under_light);
    if (!complete(light->sun_framebuffer) || !complete(light->below_framebuffer) ||
        !complete(light->under_framebuffer)) {
        return render_fail(error, SKEIN_ERROR_MEMORY, "", "the driver has no room for the shadow map");
    }

    // the second way to read the sun's map: compared, and smoothed over four texels
    glCreateSamplers(1, &light->compare_sampler);
    glSamplerParameteri(light->compare_sampler, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    glSamplerParameteri(light->compare_sampler, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
    glSamplerParameteri(light->compare_sampler, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glSamplerParameteri(light->compare_sampler, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glSamplerParameteri(light->compare_sampler, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
    glSamplerParameteri(light->compare_sampler, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
    glSamplerParameterfv(light->compare_sampler, GL_TEXTURE_BORDER_COLOR, white);

    glCreateVertexArrays(1, &light->no_arrays);
    light->under_program = render_shader_link("sky.vert", "under.frag", error);
    return light->under_program ? SKEIN_OK : SKEIN_ERROR_VALUE;
}

void render_light_destroy(render_light *light) {
    const GLuint framebuffers[3] = {light->sun_framebuffer, light->below_framebuffer, light->under_framebuffer};
    const GLuint textures[3] = {light->sun_depth, light->below_depth, light->under_light};
    glDeleteFramebuffers(3, framebuffers);
    glDeleteTextures(3, textures);
    glDeleteSamplers(1, &light->compare_sampler);
    glDeleteVertexArrays(1, &light->no_arrays);
    if (light->under_program) glDeleteProgram(light->under_program);
    memset(light, 0, sizeof *light);
}

/* ---- Aiming --------------------------------------------------------------------------------- */

/* Rounds up to a quarter of an octave, so that the map keeps its scale while things move a little. */
static double round_up(double x) {
    return x > 0 ? exp2(ceil(4 * log2(x)) / 4) : 1;
}

static void aim_sun(const double sun[3], double tangent, const render_bounds *casters, const double *ground,
                    render_scene_block *block, double clip[16]) {
    double right[3], up[3], centre[3], view[16], half = 0, high = -INFINITY, low = INFINITY;
    render_bounds_centre(casters, centre);
    render_basis(sun, right, up);
    for (int i = 0; i < 8; i++) {
        double d[3];
        for (int k = 0; k < 3; k++) d[k] = ((i >> k & 1) ? casters->most[k] : casters->least[k]) - centre[k];
        double along = render_dot(d, sun);
        half = fmax(half, fmax(fabs(render_dot(d, right)), fabs(render_dot(d, up))));
        high = fmax(high, along), low = fmin(low, along);
        // where this corner's shadow falls
        if (ground && sun[1] > 0.05) low = fmin(low, along - fmax(d[1] + centre[1] - *ground, 0) / sun[1]);
    }

    // soft edges reach out further; a step of texels, so that edges stand still while things move
    double reach = fmin(tangent * (high - low), 0.5 * half);
    half = round_up(1.02 * (half + reach) + 1e-9);
    double texel = 2 * half / sun_size, range = (high - low) * 1.02 + 0.02 * half;
    double x = texel * round(render_dot(centre, right) / texel), y = texel * round(render_dot(centre, up) / texel);
    double top = render_dot(centre, sun) + high + 0.01 * half;
    const double origin[3] = {0, 0, 0};
    render_look_along(right, up, sun, origin, view);
    double scale[16] = {1 / half, 0, 0,          0, 0,         1 / half,  0,           0,
                        0,        0, -1 / range, 0, -x / half, -y / half, top / range, 1};
    render_multiply(scale, view, clip);

    // clip space is -1 to 1 across, textures 0 to 1
    static const double to_uv[16] = {0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 1, 0, 0.5, 0.5, 0, 1};
    double map[16];
    render_multiply(to_uv, clip, map);
    for (int i = 0; i < 16; i++) block->to_sun[i] = (float)map[i];
    block->sun_map[0] = (float)(0.5 / half);
    block->sun_map[1] = (float)range;
    block->sun_map[2] = 1.0f / (float)sun_size;
    block->sun_map[3] = 1.0f;
}

static void aim_below(render_light *light, const render_bounds *casters, double ground, render_scene_block *block,
                      double clip[16]) {
    double wide = fmax(casters->most[0] - casters->least[0], casters->most[2] - casters->least[2]);
    double high = fmax(casters->most[1] - ground, 1e-6);
    wide = round_up(fmax(wide, 0.1 * high));
    double side = wide / (1 - 2 * under_margin), height = fmin(high, side);
    double x = 0.5 * (casters->least[0] + casters->most[0]) - 0.5 * side;
    double z = 0.5 * (casters->least[2] + casters->most[2]) - 0.5 * side;

    // world (x, y, z) to clip (x, z, height above the ground)
    memset(clip, 0, 16 * sizeof *clip);
    clip[0] = 2 / side, clip[12] = -2 * x / side - 1;
    clip[9] = 2 / side, clip[13] = -2 * z / side - 1;
    clip[6] = 1 / height, clip[14] = -ground / height;
    clip[15] = 1;
    light->under_side = side, light->under_height = height;
    block->under_map[0] = (float)x, block->under_map[1] = (float)z;
    block->under_map[2] = (float)(1 / side);
    block->under_map[3] = 1.0f;
}

void render_light_aim(render_light *light, const double sun[3], double spread, const render_bounds *casters,
                      const double *ground, render_scene_block *block, double sun_clip[16], double below_clip[16]) {
    light->has_sun = !render_bounds_empty(casters);
    light->has_under = light->has_sun && ground && casters->most[1] > *ground;
    memset(sun_clip, 0, 16 * sizeof *sun_clip);
    memset(below_clip, 0, 16 * sizeof *below_clip);
    if (light->has_sun) aim_sun(sun, spread, casters, ground, block, sun_clip);
    if (light->has_under) aim_below(light, casters, *ground, block, below_clip);
}

/* ---- Passes --------------------------------------------------------------------------------- */

static void begin(GLuint framebuffer, GLsizei size) {
    static const float far_away = 1.0f;
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glViewport(0, 0, size, size);
    glEnable(GL_DEPTH_TEST);
    glEnable(GL_DEPTH_CLAMP);
    glDepthFunc(GL_LESS);
    glDepthMask(GL_TRUE);
    glClearNamedFramebufferfv(framebuffer, GL_DEPTH, 0, &far_away);
}

bool render_light_begin_sun(const render_light *light) {
    if (light->has_sun) begin(light->sun_framebuffer, sun_size);
    return light->has_sun;
}

bool render_light_begin_below(const render_light *light) {
    if (light->has_under) begin(light->below_framebuffer, under_size);
    return light->has_under;
}

void render_light_end_below(const render_light *light) {
    glBindFramebuffer(GL_FRAMEBUFFER, light->under_framebuffer);
    glViewport(0, 0, under_size, under_size);
    glDisable(GL_DEPTH_TEST);
    glBindTextureUnit(0, light->below_depth);
    glBindSampler(0, 0);
    glUseProgram(light->under_program);
    glProgramUniform3f(light->under_program, 0, (float)light->under_side, (float)light->under_height,
                       (float)(light->under_side / under_size));
    glBindVertexArray(light->no_arrays);
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

void render_light_bind(const render_light *light) {
    glBindTextureUnit(0, light->sun_depth);
    glBindSampler(0, light->compare_sampler);
    glBindTextureUnit(1, light->sun_depth);
    glBindSampler(1, 0);
    glBindTextureUnit(2, light->under_light);
    glBindSampler(2, 0);
}
