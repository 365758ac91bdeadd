/* Boxes, rods and bowls; see solids.h. */
#include "render/solids.h"

#include "render/colours.h"
#include "render/shader.h"

#include <epoxy/gl.h>
#include <string.h>

enum { SOLID, ROD, BOWL, GLASS, SOLID_DEPTH, BOWL_DEPTH, PROGRAM_COUNT };

/* ---- Making --------------------------------------------------------------------------------- */

skein_status render_solids_create(render_solids *solids, skein_error *error) {
    static const char *const stages[PROGRAM_COUNT][2] = {
        [SOLID] = {"solid.vert", "display,light,glaze,solid.frag"},
        [ROD] = {"fine,light,solid.vert", "fine,display,solid.frag"},
        [BOWL] = {"bowl.vert", "display,light,glaze,bowl.frag"},
        [GLASS] = {"bowl.vert", "glass,display,glaze,bowl.frag"},
        [SOLID_DEPTH] = {"solid.vert", NULL},
        [BOWL_DEPTH] = {"bowl.vert", NULL},
    };
    for (int i = 0; i < PROGRAM_COUNT; i++) {
        solids->programs[i] = render_shader_link(stages[i][0], stages[i][1], error);
        if (!solids->programs[i]) return SKEIN_ERROR_VALUE;
    }
    skein_status status = render_shape_solid(&solids->block, true, error);
    if (status == SKEIN_OK) status = render_shape_solid(&solids->piece, false, error);
    if (status == SKEIN_OK) status = render_shape_bowl(&solids->bowl, error);
    if (status != SKEIN_OK) return status;
    render_instances_make_solids(&solids->solids, &solids->block);
    render_instances_make_solids(&solids->rods, &solids->piece);
    return SKEIN_OK;
}

void render_solids_destroy(render_solids *solids) {
    for (int i = 0; i < PROGRAM_COUNT; i++) {
        if (solids->programs[i]) glDeleteProgram(solids->programs[i]);
    }
    render_instances_destroy(&solids->solids);
    render_instances_destroy(&solids->rods);
    render_shape_destroy(&solids->block);
    render_shape_destroy(&solids->piece);
    render_shape_destroy(&solids->bowl);
    memset(solids, 0, sizeof *solids);
}

skein_status render_solids_bring(render_solids *solids, const render_frame *frame, skein_error *error) {
    skein_status status = render_instances_bring_solids(&solids->solids, frame->solids, frame->solid_count, error);
    return status ? status : render_instances_bring_solids(&solids->rods, frame->rods, frame->rod_count, error);
}

/* ---- Drawing -------------------------------------------------------------------------------- */

static void draw_instances(const render_shape *shape, const render_instances *instances, GLuint program) {
    if (instances->count == 0) return;
    glUseProgram(program);
    glBindVertexArray(instances->arrays);
    glDrawElementsInstanced(GL_TRIANGLES, shape->index_count, GL_UNSIGNED_SHORT, NULL, (GLsizei)instances->count);
}

static void draw_bowls(const render_solids *solids, const render_frame *frame, GLuint program) {
    glUseProgram(program);
    glBindVertexArray(solids->bowl.arrays);
    for (size_t i = 0; i < frame->bowl_count; i++) {
        const render_bowl *bowl = &frame->bowls[i];
        glProgramUniform4f(program, 0, (float)bowl->centre[0], (float)bowl->centre[1], (float)bowl->centre[2],
                           (float)bowl->radius);
        if (program != solids->programs[BOWL_DEPTH]) {
            float paint[3];
            render_to_light(bowl->colour, 1, paint);
            glProgramUniform3fv(program, 1, 1, paint);
            glProgramUniform1f(program, 3, (float)(render_bowl_height - 1));
        }
        if (program == solids->programs[BOWL]) {
            float marking[3], turned[9];
            render_to_light(bowl->marking, 1, marking);
            for (int k = 0; k < 9; k++) turned[k] = (float)bowl->rotation[k];
            glProgramUniform3fv(program, 2, 1, marking);
            glProgramUniformMatrix3fv(program, 4, 1, GL_TRUE, turned);
        }
        glDrawElements(GL_TRIANGLES, solids->bowl.index_count, GL_UNSIGNED_SHORT, NULL);
    }
}

void render_solids_draw_depth(const render_solids *solids, const render_frame *frame) {
    glEnable(GL_CULL_FACE);
    draw_instances(&solids->block, &solids->solids, solids->programs[SOLID_DEPTH]);
    draw_instances(&solids->piece, &solids->rods, solids->programs[SOLID_DEPTH]);
    glDisable(GL_CULL_FACE);
    draw_bowls(solids, frame, solids->programs[BOWL_DEPTH]);
}

void render_solids_draw(const render_solids *solids, const render_frame *frame) {
    glEnable(GL_CULL_FACE);
    draw_instances(&solids->block, &solids->solids, solids->programs[SOLID]);
    draw_instances(&solids->piece, &solids->rods, solids->programs[ROD]);
    // the walls that we see from within
    glCullFace(GL_FRONT);
    draw_bowls(solids, frame, solids->programs[BOWL]);
    glCullFace(GL_BACK);
    glDisable(GL_CULL_FACE);
}

/* One bowl before another is right only in the order of the frame; bowls stand apart. */
void render_solids_draw_glass(const render_solids *solids, const render_frame *frame) {
    if (frame->bowl_count == 0) return;
    glEnable(GL_CULL_FACE);
    glEnable(GL_BLEND);
    glBlendEquation(GL_FUNC_ADD);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    glDepthMask(GL_FALSE);
    draw_bowls(solids, frame, solids->programs[GLASS]);
    glDepthMask(GL_TRUE);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
}
