/* Between the files of viewer/gl only. */
#ifndef SHAPE_GL_PRIVATE_H
#define SHAPE_GL_PRIVATE_H

#include <epoxy/gl.h>

#include "shape_gl.h"

/* --- program.c --- */

/* Compiles two shaders of shaders/; `#include "x"` lines are replaced by file x. */
shape_status gl_program_create(const char *folder, const char *vertex, const char *fragment, GLuint *program,
                               shape_error *error);

/* --- target.c --- */

/* What a pass draws into: radiance and coverage; steps, fetches and where to go on. */
typedef struct gl_target {
    GLuint framebuffer, textures[2], depth;
} gl_target;

/* Makes, or makes anew, the textures of a size, and a depth buffer where one is wanted. */
shape_status gl_target_make(gl_target *target, int width, int height, bool depth, shape_error *error);
void gl_target_free(gl_target *target);

/* --- atlas.c --- */

/* Boxes of whole texels packed into one 3-D texture. */
typedef struct gl_box {
    int size[3], place[3]; /* in: size; out: place */
} gl_box;

/* Places `count` boxes without overlap, none beyond `limit` on a side; *size gets what the texture needs. */
shape_status gl_atlas_pack(gl_box *boxes, int count, int limit, int size[3], shape_error *error);

/* --- upload.c --- */

/* The textures of a volume; what they hold stands in shaders/field/cloud.glsl and upload.c. */
typedef struct gl_scene {
    GLuint clouds, spheres, ellipsoids, nodes, noise_cells, noise_linear;
    float *records;                         /* what does not depend on the eye, then what was uploaded last */
    size_t *list_spheres, *list_ellipsoids; /* where each cloud's list begins, then where its shapes do */
    int *shown;                             /* the clouds that are in sight, as rows of the clouds texture */
    int cloud_count, shown_count;
} gl_scene;

enum { GL_RECORD_TEXELS = 36 };

shape_status gl_scene_load(gl_scene *scene, const shape_volume *volume, shape_error *error);
/* Rewrites the records for an eye (each cloud's frame is taken relative to it, in double precision) and uploads them;
 * clouds out of the view's sight are left out. */
void gl_scene_place_eye(gl_scene *scene, const shape_volume *volume, const shape_camera *camera);
void gl_scene_free(gl_scene *scene);
/* One texel of a cloud's record. */
void gl_scene_put(gl_scene *scene, int cloud, int texel, double x, double y, double z, double w);
/* A float texture of `texels` RGBA texels, filled row by row. */
GLuint gl_float_texture(const float *data, size_t texels, shape_status *status, shape_error *error);

/* --- tiles.c --- */

/* Which shown clouds each tile of 32x32 pixels may see. */
typedef struct gl_tiles {
    GLuint lists; /* offset and count a tile, then numbers of clouds, as a float texture */
    GLuint order; /* the tiles: those without a cloud, with one, with several; column, row, first cloud */
    int columns, empty_count, one_count, several_count;
} gl_tiles;

shape_status gl_tiles_make(gl_tiles *tiles, const gl_scene *scene, const shape_volume *volume,
                           const shape_view *view, const shape_camera *camera, shape_error *error);
void gl_tiles_free(gl_tiles *tiles);

/* --- grids.c --- */

/* Light grids and baked densities of all clouds, and their textures. */
typedef struct gl_grids {
    shape_lightgrid *light;
    gl_box *light_boxes;
    int light_size[3], count;
    float *seen; /* the composed light, as uploaded */
    GLuint light_a, light_b, light_seen, baked;
} gl_grids;

/* Takes over the light grids (allocated, one a cloud) and uploads them: both value textures, or only what
 * gl_grids_compose needs. */
shape_status gl_grids_set_light(gl_grids *grids, gl_scene *scene, const shape_volume *volume,
                                shape_lightgrid *light, bool values, shape_error *error);
/* Composes the light of the shown clouds for an eye and uploads it. */
void gl_grids_compose(gl_grids *grids, const gl_scene *scene, const shape_volume *volume,
                      const shape_light *light, const float sky_upper[3], const float sky_lower[3],
                      shape_dvec3 eye);
/* Bakes every cloud's density with voxels as fine as the view needs, within `budget` voxels in all, and uploads. */
shape_status gl_grids_bake(gl_grids *grids, gl_scene *scene, const shape_volume *volume,
                           const shape_view *view, size_t budget, shape_error *error);
void gl_grids_free(gl_grids *grids);

/* --- passes.c --- */

/* One picture, or one sample of it. */
typedef struct gl_frame {
    const shape_view *view;
    const shape_camera *camera;
    const gl_tiles *tiles;
    int sample;
    bool moving;
} gl_frame;

/* What the default method has of its own. */
typedef struct gl_preview {
    GLuint sky, one, several, fill, sky_picture_program;
    gl_target coarse;      /* a moving view's first pass: every second pixel each way */
    gl_target sky_picture; /* see shaders/view/sky_picture.glsl */
    bool moving;           /* the last picture was a moving view's */
} gl_preview;

struct shape_gl_renderer {
    shape_gl_options options;
    const shape_volume *volume;
    gl_scene scene;
    gl_grids grids;
    gl_preview preview;
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

void gl_draw_triangle(const shape_gl_renderer *renderer);
/* What is drawn next is blended into the running mean: sample n counts 1 / (n + 1). */
void gl_begin_mean(int sample);
/* Steps, candidates and starts of a method. */
void gl_set_method(const shape_gl_renderer *renderer, const shape_view *view, GLuint program);

/* --- preview.c: the default method --- */

shape_status gl_preview_create(gl_preview *preview, const char *folder, shape_error *error);
shape_status gl_preview_resize(gl_preview *preview, int width, int height, shape_error *error);
void gl_preview_draw(shape_gl_renderer *renderer, const gl_frame *frame);
void gl_preview_free(gl_preview *preview);

/* --- parts.c: the exact method --- */

/* Draws a sample by the view program, which is set up, in parts: a part stops a pixel after some work and says where;
 * the next goes on from there, until all are finished. */
shape_status gl_draw_in_parts(shape_gl_renderer *renderer, int sample, shape_error *error);

/* --- uniforms.c: what shaders are told; the program is in use --- */

void gl_bind(GLuint program, const char *name, int unit, GLenum kind, GLuint texture);
void gl_set_vector(GLuint program, const char *name, const float *v);
void gl_set_dvector(GLuint program, const char *name, shape_dvec3 v);
void gl_set_float(GLuint program, const char *name, float v);
void gl_set_int(GLuint program, const char *name, int v);
void gl_set_scene(const gl_scene *scene, GLuint program);
void gl_set_grids(const gl_grids *grids, GLuint program);
void gl_set_tiles(const gl_tiles *tiles, GLuint program);
void gl_set_light(const shape_gl_renderer *renderer, GLuint program);
void gl_set_camera(const shape_view *view, const shape_camera *camera, int sample, GLuint program);

#endif
