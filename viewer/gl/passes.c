/* The passes: light (on the CPU), view, accumulation, tone mapping. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "gl_private.h"
#include "shape/random.h"

struct shape_gl_renderer {
    shape_gl_options options;
    const shape_volume *volume;
    gl_scene scene;
    gl_grids grids;
    shape_light light;
    shape_sky sky;
    float sky_upper[3], sky_lower[3];
    GLuint view_program, tonemap, density, empty_array;
    GLuint copy, query;
    gl_target mean, parts[2]; /* the picture; two to draw a long sample in parts, each from the other */
    int width, height;
    float window_length; /* of the exact view's candidates [m] */
    shape_gl_costs costs;
};

static double now_ms(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return 1e3 * (double)time.tv_sec + 1e-6 * (double)time.tv_nsec;
}

shape_gl_options shape_gl_defaults(void)
{
    shape_gl_options options = {
        .method = SHAPE_GL_DEFAULT, .light = shape_lightgrid_defaults(), .bake_voxels = 12000000, .seed = 1};
    return options;
}

static bool is_paper(const shape_gl_renderer *renderer)
{
    return renderer->options.method == SHAPE_GL_PAPER || renderer->options.method == SHAPE_GL_PAPER_NDT;
}

/* Whether a sample is drawn in parts: only the exact view walks trees and may take long for a pixel. */
static bool in_parts(const shape_gl_renderer *renderer)
{
    return renderer->options.method == SHAPE_GL_EXACT;
}

static const char *view_shader(const shape_gl_renderer *renderer)
{
    if (is_paper(renderer))
        return "view/paper.frag";
    return renderer->options.method == SHAPE_GL_EXACT ? "view/march.frag" : "view/preview.frag";
}

shape_status shape_gl_create(const shape_gl_options *options, shape_gl_renderer **renderer,
                             shape_error *error)
{
    shape_gl_renderer *made = calloc(1, sizeof *made);
    if (!made)
        return shape_error_memory(error);
    made->options = *options;
    const char *folder = options->shader_folder;
    shape_status status = gl_program_create(folder, view_shader(made), &made->view_program, error);
    if (!status)
        status = gl_program_create(folder, "view/tonemap.frag", &made->tonemap, error);
    if (!status)
        status = gl_program_create(folder, "view/copy.frag", &made->copy, error);
    if (status) {
        shape_gl_destroy(made);
        return status;
    }
    glGenVertexArrays(1, &made->empty_array);
    glGenQueries(1, &made->query);
    *renderer = made;
    return SHAPE_OK;
}

void shape_gl_destroy(shape_gl_renderer *renderer)
{
    if (!renderer)
        return;
    gl_scene_free(&renderer->scene);
    gl_grids_free(&renderer->grids);
    glDeleteProgram(renderer->view_program);
    glDeleteProgram(renderer->tonemap);
    glDeleteProgram(renderer->density);
    glDeleteProgram(renderer->copy);
    glDeleteQueries(1, &renderer->query);
    gl_target_free(&renderer->mean);
    gl_target_free(&renderer->parts[0]);
    gl_target_free(&renderer->parts[1]);
    glDeleteVertexArrays(1, &renderer->empty_array);
    free(renderer);
}

/* A window that few of very many primitives begin in, if they lie evenly; see shaders/field/interval.glsl. */
static float window_length(const shape_volume *volume)
{
    enum { MANY = 2000, IN_A_WINDOW = 16 };
    double extent = 0, count = 0;
    for (size_t i = 0; i < volume->cloud_count; i++) {
        shape_dvec3 min, max;
        shape_frame_box(&volume->clouds[i].frame, volume->clouds[i].box, &min, &max);
        extent = fmax(extent, shape_dvec3_length(shape_dvec3_sub(max, min)));
        count += (double)shape_primitives_count(volume->clouds[i].list);
    }
    return count > MANY ? (float)(extent * IN_A_WINDOW / count) : 1e30f;
}

shape_status shape_gl_load(shape_gl_renderer *renderer, const shape_volume *volume, shape_error *error)
{
    double start = now_ms();
    renderer->volume = volume;
    renderer->window_length = window_length(volume);
    for (size_t i = 0; i < volume->cloud_count; i++)
        if (is_paper(renderer) && volume->clouds[i].field.model == SHAPE_MODEL_GRID)
            return shape_error_set(
                error, SHAPE_ERROR_ARGUMENT,
                "the paper's methods draw primitives, not voxel grids (choose another --method)");
    shape_status status = gl_scene_load(&renderer->scene, volume, error);
    if (!status && renderer->options.method == SHAPE_GL_EXACT)
        status = gl_volumes_load(&renderer->scene, volume, error);
    renderer->costs.upload_ms = now_ms() - start;
    return status;
}

static shape_status build_light(const shape_gl_renderer *renderer, size_t cloud, shape_lightgrid *grid,
                                shape_error *error)
{
    const shape_lightgrid_options *options = &renderer->options.light;
    if (is_paper(renderer))
        return shape_lightgrid_build_2018(renderer->volume, cloud, &renderer->light, options->resolution,
                                          0.1f, grid, error);
    return shape_lightgrid_build(renderer->volume, cloud, &renderer->light, options, grid, error);
}

shape_status shape_gl_light(shape_gl_renderer *renderer, const shape_light *light, shape_error *error)
{
    double start = now_ms();
    size_t count = renderer->volume->cloud_count;
    renderer->light = *light;
    renderer->sky = shape_sky_make(light);
    shape_sky_mean(&renderer->sky, renderer->sky_upper, renderer->sky_lower);
    shape_lightgrid *grids = calloc(count + 1, sizeof *grids);
    if (!grids)
        return shape_error_memory(error);
    shape_status status = SHAPE_OK;
    for (size_t i = 0; i < count && !status; i++)
        status = build_light(renderer, i, &grids[i], error);
    if (status) {
        for (size_t i = 0; i < count; i++)
            shape_lightgrid_free(&grids[i]);
        free(grids);
    } else {
        status = gl_grids_set_light(&renderer->grids, &renderer->scene, renderer->volume, grids,
                                    renderer->options.method != SHAPE_GL_DEFAULT, error);
    }
    renderer->costs.light_ms = now_ms() - start;
    return status;
}

/* The buffer that pictures are drawn into, remade where the size changes. */
/* The buffers that pictures are drawn into, remade where the size changes. */
static shape_status prepare_targets(shape_gl_renderer *renderer, int width, int height, shape_error *error)
{
    if (renderer->mean.framebuffer && renderer->width == width && renderer->height == height)
        return SHAPE_OK;
    GLint largest = 2048;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
    if (width > largest || height > largest)
        return shape_error_set(error, SHAPE_ERROR_LIMIT,
                               "a picture of %dx%d is larger than this GPU draws (%dx%d)", width, height,
                               (int)largest, (int)largest);
    shape_status status = gl_target_make(&renderer->mean, width, height, error);
    for (int i = 0; i < 2 && !status && in_parts(renderer); i++)
        status = gl_target_make(&renderer->parts[i], width, height, error);
    renderer->width = width;
    renderer->height = height;
    return status;
}

static void bind(GLuint program, const char *name, int unit, GLenum kind, GLuint texture)
{
    glActiveTexture(GL_TEXTURE0 + (GLenum)unit);
    glBindTexture(kind, texture);
    glUniform1i(glGetUniformLocation(program, name), unit);
}

static void set_vector(GLuint program, const char *name, const float *v)
{
    glUniform3fv(glGetUniformLocation(program, name), 1, v);
}

static void set_dvector(GLuint program, const char *name, shape_dvec3 v)
{
    glUniform3f(glGetUniformLocation(program, name), (float)v.x, (float)v.y, (float)v.z);
}

static void set_float(GLuint program, const char *name, float v)
{
    glUniform1f(glGetUniformLocation(program, name), v);
}

static void set_int(GLuint program, const char *name, int v)
{
    glUniform1i(glGetUniformLocation(program, name), v);
}

static void bind_scene(const gl_scene *scene, GLuint program)
{
    bind(program, "clouds", 0, GL_TEXTURE_2D, scene->clouds);
    bind(program, "spheres", 1, GL_TEXTURE_2D, scene->spheres);
    bind(program, "ellipsoids", 2, GL_TEXTURE_2D, scene->ellipsoids);
    bind(program, "nodes", 3, GL_TEXTURE_2D, scene->nodes);
    bind(program, "noise_cells", 4, GL_TEXTURE_3D, scene->noise_cells);
    set_int(program, "cloud_count", scene->shown_count);
    bind(program, "noise_linear", 5, GL_TEXTURE_3D, scene->noise_linear);
    bind(program, "grid_values", 14, GL_TEXTURE_3D, scene->grid_values);
}

static void bind_grids(const gl_grids *grids, GLuint program)
{
    bind(program, "light_a", 6, GL_TEXTURE_3D, grids->light_a);
    bind(program, "light_b", 7, GL_TEXTURE_3D, grids->light_b);
    bind(program, "light_seen", 9, GL_TEXTURE_3D, grids->light_seen);
    bind(program, "baked", 10, GL_TEXTURE_3D, grids->baked);
}

static void set_light(const shape_gl_renderer *r, GLuint program)
{
    static const float up[3] = {0, 1, 0};
    float perez[15];
    memcpy(perez, r->sky.perez, sizeof perez);
    set_int(program, "sky_kind", r->sky.kind);
    set_vector(program, "sky_constant", r->sky.constant);
    set_vector(program, "sky_sun", r->sky.sun);
    glUniform1fv(glGetUniformLocation(program, "sky_perez"), 15, perez);
    set_vector(program, "sky_zenith", r->sky.zenith);
    set_vector(program, "sky_ground", r->sky.ground);
    set_float(program, "sky_night", r->sky.night);
    set_vector(program, "sky_upper", r->sky_upper);
    set_vector(program, "sky_lower", r->sky_lower);
    set_dvector(program, "sun_direction", r->light.sun);
    set_vector(program, "sun_irradiance", r->light.sun_irradiance);
    set_vector(program, "world_up", up);
}

static void set_camera(const shape_view *view, const shape_camera *camera, int sample, GLuint program)
{
    set_dvector(program, "camera_forward", camera->forward);
    set_dvector(program, "camera_right", camera->right);
    set_dvector(program, "camera_up", camera->up);
    glUniform2f(glGetUniformLocation(program, "picture_size"), (float)view->width, (float)view->height);
    glUniform2f(glGetUniformLocation(program, "picture_origin"), 0, 0);
    /* Roberts' R2 sequence, beginning at the pixel's centre. */
    double x = 0.5 + 0.7548776662466927 * sample, y = 0.5 + 0.5698402909980532 * sample;
    glUniform2f(glGetUniformLocation(program, "pixel_shift"), (float)(x - floor(x)), (float)(y - floor(y)));
    set_int(program, "sample_number", sample);
}

static void set_method(const shape_gl_renderer *r, const shape_view *view, GLuint program)
{
    bool exact = r->options.method == SHAPE_GL_EXACT;
    double pixel = 2 * tan(view->fov * 3.14159265358979 / 360) / view->height;
    /* exact: cells of the noise; default: voxels. */
    set_float(program, "step_scale", exact ? 0.125f : 1.5f);
    set_int(program, "seed", (int)(uint32_t)(shape_hash(r->options.seed) ^ shape_hash(1)));
    set_float(program, "window_length", r->window_length);
    set_float(program, "step_depth", 0.25f);
    set_float(program, "step_growth", (float)pixel * (exact ? 0.5f : 2.0f));
    set_float(program, "transmittance_end", exact ? 1e-4f : 4e-3f);
    set_int(program, "paper_sweep", r->options.method == SHAPE_GL_PAPER_NDT);
    set_int(program, "paper_lod", r->options.paper_lod);
}

static shape_status bake(shape_gl_renderer *renderer, const shape_view *view, shape_error *error)
{
    double start = now_ms();
    shape_status status = gl_grids_bake(&renderer->grids, &renderer->scene, renderer->volume, view,
                                        renderer->options.bake_voxels, error);
    renderer->costs.bake_ms = now_ms() - start;
    return status;
}

static void draw_triangle(const shape_gl_renderer *renderer)
{
    glBindVertexArray(renderer->empty_array);
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

/* Draws with the running mean as blending: sample n counts 1 / (n + 1). */
static void draw_into_mean(const shape_gl_renderer *renderer, int sample)
{
    if (sample) {
        glEnable(GL_BLEND);
        glBlendFunc(GL_CONSTANT_ALPHA, GL_ONE_MINUS_CONSTANT_ALPHA);
        glBlendColor(0, 0, 0, 1.0f / (float)(sample + 1));
    }
    draw_triangle(renderer);
    glDisable(GL_BLEND);
}

static void use_copy(const shape_gl_renderer *renderer, const gl_target *from, bool looking)
{
    glUseProgram(renderer->copy);
    bind(renderer->copy, "part_radiance", 12, GL_TEXTURE_2D, from->textures[0]);
    bind(renderer->copy, "part_work", 13, GL_TEXTURE_2D, from->textures[1]);
    set_int(renderer->copy, "looking", looking);
}

/* Whether a sample has pixels that are not finished: counted by the GPU, so that no picture has to be read. */
static bool unfinished(const shape_gl_renderer *renderer, const gl_target *part, const gl_target *other)
{
    GLuint any = 0;
    glBindFramebuffer(GL_FRAMEBUFFER, other->framebuffer);
    use_copy(renderer, part, true);
    glBeginQuery(GL_ANY_SAMPLES_PASSED, renderer->query);
    draw_triangle(renderer);
    glEndQuery(GL_ANY_SAMPLES_PASSED);
    glGetQueryObjectuiv(renderer->query, GL_QUERY_RESULT, &any);
    return any;
}

/* A part stops a pixel after some work and says where; the next goes on from there, until all are finished. */
static shape_status draw_in_parts(shape_gl_renderer *renderer, GLuint program, int sample, shape_error *error)
{
    enum { MOST_PARTS = 100000 };
    gl_target *part = &renderer->parts[0], *other = &renderer->parts[1];
    bool more = false;
    int parts = 0;
    do {
        if (++parts > MOST_PARTS)
            return shape_error_set(error, SHAPE_ERROR_LIMIT,
                                   "the exact view takes too long here (choose --method default)");
        glUseProgram(program);
        glBindFramebuffer(GL_FRAMEBUFFER, part->framebuffer);
        set_int(program, "resume", more);
        bind(program, "part_radiance", 12, GL_TEXTURE_2D, more ? other->textures[0] : 0);
        bind(program, "part_work", 13, GL_TEXTURE_2D, more ? other->textures[1] : 0);
        draw_triangle(renderer);
        more = unfinished(renderer, part, other);
        gl_target *swap = part;
        part = other;
        other = swap;
    } while (more);
    glBindFramebuffer(GL_FRAMEBUFFER, renderer->mean.framebuffer);
    use_copy(renderer, other, false);
    draw_into_mean(renderer, sample);
    return SHAPE_OK;
}

shape_status shape_gl_draw(shape_gl_renderer *renderer, const shape_view *view, int sample,
                           shape_error *error)
{
    shape_status status = prepare_targets(renderer, view->width, view->height, error);
    if (status)
        return status;
    if (renderer->options.method == SHAPE_GL_DEFAULT && !renderer->grids.baked)
        status = bake(renderer, view, error);
    if (status)
        return status;
    shape_camera camera = shape_view_camera(view);
    GLuint program = renderer->view_program;
    glUseProgram(program);
    glViewport(0, 0, view->width, view->height);
    gl_scene_place_eye(&renderer->scene, renderer->volume, &camera);
    if (renderer->options.method == SHAPE_GL_DEFAULT && sample == 0)
        gl_grids_compose(&renderer->grids, &renderer->scene, renderer->volume, &renderer->light,
                         renderer->sky_upper, renderer->sky_lower, camera.origin);
    int columns;
    GLuint tiles = gl_tiles_make(&renderer->scene, renderer->volume, view, &camera, &columns, &status, error);
    if (status)
        return status;
    bind_scene(&renderer->scene, program);
    bind_grids(&renderer->grids, program);
    bind(program, "tiles", 11, GL_TEXTURE_2D, tiles);
    set_int(program, "tile_columns", columns);
    set_light(renderer, program);
    set_camera(view, &camera, sample, program);
    set_method(renderer, view, program);
    if (in_parts(renderer)) {
        status = draw_in_parts(renderer, program, sample, error);
    } else {
        glBindFramebuffer(GL_FRAMEBUFFER, renderer->mean.framebuffer);
        draw_into_mean(renderer, sample);
    }
    glDeleteTextures(1, &tiles);
    if (!status && glGetError() == GL_OUT_OF_MEMORY)
        return shape_error_set(error, SHAPE_ERROR_MEMORY,
                               "the GPU has not enough memory (make the picture smaller)");
    return status;
}

void shape_gl_finish(void)
{
    glFinish();
}

shape_status shape_gl_read(shape_gl_renderer *renderer, float *rgba, shape_error *error)
{
    size_t width = (size_t)renderer->width, height = (size_t)renderer->height;
    float *rows = malloc(width * height * 4 * sizeof *rows);
    if (!rows)
        return shape_error_memory(error);
    glBindFramebuffer(GL_FRAMEBUFFER, renderer->mean.framebuffer);
    glReadBuffer(GL_COLOR_ATTACHMENT1);
    glReadPixels(0, 0, renderer->width, renderer->height, GL_RGBA, GL_FLOAT, rows);
    double steps = 0, fetches = 0;
    for (size_t i = 0; i < width * height; i++) {
        steps += (double)rows[4 * i];
        fetches += (double)rows[4 * i + 1];
    }
    renderer->costs.steps_per_pixel = steps / (double)(width * height);
    renderer->costs.fetches_per_pixel = fetches / (double)(width * height);
    glReadBuffer(GL_COLOR_ATTACHMENT0);
    glReadPixels(0, 0, renderer->width, renderer->height, GL_RGBA, GL_FLOAT, rows);
    for (size_t y = 0; y < height; y++)
        memcpy(rgba + y * width * 4, rows + (height - 1 - y) * width * 4, width * 4 * sizeof *rows);
    free(rows);
    return SHAPE_OK;
}

void shape_gl_show(shape_gl_renderer *renderer, float exposure_stops, int width, int height)
{
    glViewport(0, 0, width, height);
    glUseProgram(renderer->tonemap);
    bind(renderer->tonemap, "accumulated", 0, GL_TEXTURE_2D, renderer->mean.textures[0]);
    set_float(renderer->tonemap, "exposure", exp2f(exposure_stops));
    glBindVertexArray(renderer->empty_array);
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

shape_gl_costs shape_gl_get_costs(const shape_gl_renderer *renderer)
{
    return renderer->costs;
}

shape_status shape_gl_densities(shape_gl_renderer *renderer, const shape_vec3 *points, int count, float *rgba,
                                shape_error *error)
{
    enum { WIDTH = 2048 };
    shape_status status = SHAPE_OK;
    if (!renderer->density)
        status = gl_program_create(renderer->options.shader_folder, "view/density.frag", &renderer->density,
                                   error);
    int rows = (count + WIDTH - 1) / WIDTH;
    float *texels = calloc((size_t)rows * WIDTH * 4, sizeof *texels);
    if (!texels)
        return shape_error_memory(error);
    for (int i = 0; i < count; i++)
        memcpy(texels + 4 * i, &points[i], sizeof points[i]);
    if (!status)
        status = prepare_targets(renderer, WIDTH, rows, error);
    if (!status) {
        GLuint texture = gl_float_texture(texels, (size_t)rows * WIDTH, &status, error);
        shape_view view = shape_view_defaults();
        view.eye = shape_dvec3_make(0, 0, 0);
        /* A camera that sees everything: the records are wanted, not the view. */
        shape_camera camera = {view.eye, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        camera.right = camera.up = shape_dvec3_make(0, 0, 0);
        glUseProgram(renderer->density);
        glBindFramebuffer(GL_FRAMEBUFFER, renderer->mean.framebuffer);
        glViewport(0, 0, WIDTH, rows);
        gl_scene_place_eye(&renderer->scene, renderer->volume, &camera);
        bind_scene(&renderer->scene, renderer->density);
        bind(renderer->density, "points", 8, GL_TEXTURE_2D, texture);
        glDisable(GL_BLEND);
        glBindVertexArray(renderer->empty_array);
        glDrawArrays(GL_TRIANGLES, 0, 3);
        glReadBuffer(GL_COLOR_ATTACHMENT0);
        glReadPixels(0, 0, WIDTH, rows, GL_RGBA, GL_FLOAT, texels);
        glDeleteTextures(1, &texture);
        memcpy(rgba, texels, (size_t)count * 4 * sizeof *rgba);
    }
    free(texels);
    return status;
}
