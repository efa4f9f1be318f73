/* Between the files of viewer/gl only. */
#ifndef SHAPE_GL_PRIVATE_H
#define SHAPE_GL_PRIVATE_H

#include <epoxy/gl.h>

#include "shape_gl.h"

/* --- program.c --- */

/* Compiles view/fullscreen.vert with the named fragment shader; `#include "x"` lines are replaced by file x. */
shape_status gl_program_create(const char *folder, const char *fragment, GLuint *program, shape_error *error);

/* --- target.c --- */

/* What a pass draws into: radiance and coverage; steps, fetches and where to go on. */
typedef struct gl_target {
    GLuint framebuffer, textures[2];
} gl_target;

/* Makes, or makes anew, the textures of a size. */
shape_status gl_target_make(gl_target *target, int width, int height, shape_error *error);
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
    GLuint grid_values;                     /* of voxel grids, where the exact view needs them */
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

/* --- volumes.c --- */

/* Uploads the values of all voxel grids, after gl_scene_load. */
shape_status gl_volumes_load(gl_scene *scene, const shape_volume *volume, shape_error *error);

/* --- tiles.c --- */

/* Which shown clouds each tile of 32x32 pixels may see, as a float texture: offset and count a tile, then numbers. */
GLuint gl_tiles_make(const gl_scene *scene, const shape_volume *volume, const shape_view *view,
                     const shape_camera *camera, int *columns, shape_status *status, shape_error *error);

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

#endif
