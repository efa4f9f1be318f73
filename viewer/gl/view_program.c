/* The program of the methods that draw the whole picture with one: as fits the volume, and given all that it reads. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "gl_private.h"
#include "shape/random.h"

bool gl_is_paper(const shape_gl_renderer *renderer)
{
    return renderer->options.method == SHAPE_GL_PAPER || renderer->options.method == SHAPE_GL_PAPER_NDT;
}

static const char *view_shader(const shape_gl_renderer *renderer)
{
    if (gl_is_paper(renderer))
        return "view/paper.frag";
    return "view/march.frag";
}

static bool is_plain(const shape_volume *volume)
{
    for (size_t i = 0; i < volume->cloud_count; i++)
        if (volume->clouds[i].detailed || volume->clouds[i].field.model == SHAPE_MODEL_METABALL ||
            volume->clouds[i].field.model == SHAPE_MODEL_GRID)
            return false;
    return true;
}

/* What the shaders of the whole picture may leave out for a volume: a number for each such set of lines. */
static int view_defines(const shape_gl_renderer *renderer, char *defines, size_t size)
{
    const shape_volume *volume = renderer->volume;
    bool air = gl_has_air(renderer);
    const shape_volume_cloud *c = volume->cloud_count == 1 ? &volume->clouds[0] : NULL;
    bool plain = is_plain(volume), spheres = c && !c->list->ellipsoid_count;
    int octaves = c ? c->field.octaves : 0;
    snprintf(defines, size, "%s%s%s%s", plain ? "#define FIELD_PLAIN\n" : "", c ? "#define ONE_CLOUD\n" : "",
             spheres ? "#define SPHERES_ONLY\n" : "", air ? "#define AIR\n" : "");
    if (c)
        snprintf(defines + strlen(defines), size - strlen(defines), "#define OCTAVES %d\n", octaves);
    gl_law_define(renderer, defines, size);
    return 1 + plain + 2 * spheres + 4 * air + 8 * octaves + 1024 * (int)gl_law(renderer);
}

/* The view program of the methods that have one for the whole picture, as fits the volume; listed: the one that reads
 * lists of primitives. */
static shape_status find_program(shape_gl_renderer *renderer, bool listed, GLuint *program,
                                 shape_error *error)
{
    enum { ROOM = 160 };
    char defines[ROOM];
    int kind = view_defines(renderer, defines, ROOM);
    GLuint *known = &renderer->view_programs[listed];
    if (renderer->view_kinds[listed] != kind) {
        glDeleteProgram(*known);
        *known = 0;
        renderer->view_kinds[listed] = 0;
        if (listed)
            strcat(defines, "#define LISTED\n");
        shape_status status = gl_program_create(renderer->options.shader_folder, "view/fullscreen.vert",
                                                view_shader(renderer), defines, known, error);
        if (status)
            return status;
        renderer->view_kinds[listed] = kind;
    }
    *program = *known;
    return SHAPE_OK;
}

shape_status gl_prepare_view(shape_gl_renderer *renderer, shape_error *error)
{
    GLuint program;
    if (renderer->options.method == SHAPE_GL_DEFAULT)
        return SHAPE_OK;
    bool listed = renderer->options.method == SHAPE_GL_EXACT && gl_tiles_can_list(renderer->volume);
    return find_program(renderer, listed, &program, error);
}

void gl_set_method(const shape_gl_renderer *r, const shape_view *view, GLuint program)
{
    bool exact = r->options.method == SHAPE_GL_EXACT;
    double pixel = 2 * tan(view->fov * 3.14159265358979 / 360) / view->height;
    /* exact: cells of the noise; default: voxels. */
    gl_set_float(program, "step_scale", exact ? 0.4f : 1.5f);
    gl_set_float(program, "step_deep", exact ? 1.0f : 0.0f);
    gl_set_int(program, "seed", (int)(uint32_t)(shape_hash(r->options.seed) ^ shape_hash(1)));
    gl_set_float(program, "window_length", r->window_length);
    gl_set_float(program, "step_depth", 0.25f);
    gl_set_float(program, "step_growth", (float)pixel * (exact ? 1.5f : 2.0f));
    gl_set_float(program, "transmittance_end", exact ? 1e-4f : 4e-3f);
    gl_set_int(program, "paper_sweep", r->options.method == SHAPE_GL_PAPER_NDT);
    gl_set_int(program, "paper_lod", r->options.paper_lod);
}

shape_status gl_use_view(shape_gl_renderer *renderer, const gl_frame *frame, bool listed, GLuint *used,
                         shape_error *error)
{
    GLuint program;
    shape_status status = find_program(renderer, listed, &program, error);
    if (status)
        return status;
    glUseProgram(program);
    glViewport(0, 0, frame->part->width, frame->part->height);
    gl_set_scene(&renderer->scene, program);
    gl_set_grids(&renderer->grids, program);
    gl_set_law(renderer, &renderer->grids, program);
    gl_set_tiles(frame->tiles, program);
    gl_set_light(renderer, program);
    gl_set_camera(frame, program);
    gl_set_method(renderer, frame->view, program);
    gl_set_surface(renderer, program);
    gl_set_air(renderer, program, frame->camera->origin);
    if (gl_has_air(renderer)) /* it lights the air even where it is not seen */
        gl_set_int(program, "sky_kind", (int)renderer->sky.kind);
    *used = program;
    return SHAPE_OK;
}
