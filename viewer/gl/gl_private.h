/* Between the files of viewer/gl only. */
#ifndef SHAPE_GL_PRIVATE_H
#define SHAPE_GL_PRIVATE_H

#include <epoxy/gl.h>
#include <stdatomic.h>

#include "shape/bake.h"
#include "shape_gl.h"

/* --- program.c --- */

/* Compiles two shaders of shaders/; `#include "x"` lines are replaced by file x. defines: lines before them, or "". */
shape_status gl_program_create(const char *folder, const char *vertex, const char *fragment,
                               const char *defines, GLuint *program, shape_error *error);

/* --- target.c --- */

/* What a pass draws into: radiance and coverage; steps, fetches and where to go on. */
typedef struct gl_target {
    GLuint framebuffer, textures[2], depth;
} gl_target;

/* Makes, or makes anew, the textures of a size, and a depth buffer where one is wanted. */
shape_status gl_target_make(gl_target *target, int width, int height, bool depth, shape_error *error);
void gl_target_free(gl_target *target);
/* Waits for what is being drawn, before a texture is written that may be in it. A driver that waits by itself (Mesa) does so
 * under a lock that all contexts share, and the window, which has another one, would stand still meanwhile. */
void gl_settle(void);
/* A 3-D texture with linear filtering, clamped at its edges; data may be NULL. */
GLuint gl_volume_texture(const int size[3], GLint internal, GLenum format, GLenum kind, const void *data);

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

enum { GL_RECORD_TEXELS = 36 }; /* SHAPE_RECORD_TEXELS */

shape_status gl_scene_load(gl_scene *scene, const shape_volume *volume, shape_error *error);
/* The noise, where the shaders evaluate it: of all methods but the default one. */
void gl_scene_load_noise(gl_scene *scene, const shape_noise *noise);
/* Rewrites the records for an eye (each cloud's frame is taken relative to it, in double precision) and uploads them;
 * clouds out of the view's sight are left out. */
void gl_scene_place_eye(gl_scene *scene, const shape_volume *volume, const shape_camera *camera);
void gl_scene_free(gl_scene *scene);
/* False where all corners of a cloud's box lie outside one side of the view's pyramid, made `wider` times as wide and high,
 * or behind the eye. */
bool gl_in_sight(const shape_volume_cloud *cloud, const shape_camera *camera, double wider);
/* One texel of a cloud's record. */
void gl_scene_put(gl_scene *scene, int cloud, int texel, double x, double y, double z, double w);
/* A float texture of `texels` RGBA texels, filled row by row. */
GLuint gl_float_texture(const float *data, size_t texels, shape_status *status, shape_error *error);

/* --- volumes.c --- */

/* Uploads the values of all voxel grids, after gl_scene_load. */
shape_status gl_volumes_load(gl_scene *scene, const shape_volume *volume, shape_error *error);

/* --- tiles.c --- */

/* Which shown clouds each tile of 32x32 pixels may see. */
typedef struct gl_tiles {
    GLuint lists; /* offset and count a tile, then numbers of clouds, as a float texture */
    GLuint order; /* the tiles: those without a cloud, with one, with several; column, row, first cloud */
    GLuint primitives; /* of a single cloud, see tile_primitives.c */
    bool listed;       /* whether there are such lists */
    int list_columns;  /* of their tiles */
    float list_scale;  /* see shaders/view/march_list.glsl */
    int columns, empty_count, one_count, several_count;
    float *texels; /* of `lists` */
} gl_tiles;

shape_status gl_tiles_make(gl_tiles *tiles, const gl_scene *scene, const shape_volume *volume,
                           const shape_view *view, const shape_gl_part *part, const shape_camera *camera,
                           shape_error *error);
void gl_tiles_free(gl_tiles *tiles);

/* --- tile_primitives.c --- */

/* Whether a volume is one that lists are made for: a single cloud of primitives. */
bool gl_tiles_can_list(const shape_volume *volume);
/* Lists of a single cloud's primitives for the tiles; none where a list would be longer than the tree's walk. */
shape_status gl_tiles_list_primitives(gl_tiles *tiles, const shape_volume *volume, const shape_view *view,
                                      const shape_gl_part *part, const shape_camera *camera,
                                      shape_error *error);

/* --- grid_light.c, grid_baked.c: what is made on the CPU and then uploaded --- */

/* Whether what there is of a cloud is what a view asks for; the worse the later. */
typedef enum gl_fit { GL_FITS, GL_TOO_FINE, GL_FAR_TOO_FINE, GL_TOO_COARSE, GL_MISSING } gl_fit;

typedef struct gl_light gl_light;
typedef struct gl_baked gl_baked;

/* --- update.c: what an edit leaves --- */

/* What differs between the volume that is loaded and another one. */
typedef struct gl_update {
    const shape_volume *volume; /* the other one */
    size_t count;
    shape_change *changes; /* of density, a cloud each */
    bool *replaced;        /* placed elsewhere, or of another medium: its light is another one */
    bool *shaded;          /* its own density or that of clouds between it and the sun has changed */
    bool pending;          /* loaded, and not yet done */
} gl_update;

/* What is to be made, and how. */
typedef struct gl_order {
    const shape_volume *volume;
    const shape_light *light;
    bool want_light, want_baked, paper;
    bool first;                 /* something coarse, to begin with */
    bool missing_only;          /* whatever is there already does */
    bool lenient;               /* what is a little too fine does */
    bool all_clouds;            /* light those out of sight, too: their shadows are seen */
    const gl_light *light_from; /* clouds' grids are taken over from these where they do; NULL: none do */
    const gl_baked *baked_from;
    const gl_light
        *dense_from;         /* under an earlier sun: the cells' densities are still true; NULL: none are */
    const gl_update *update; /* an edit's, which light_from is from before: only this is done; NULL: none */
    shape_stop stop;
    shape_lightgrid_options light_options;
    double
        light_pixels; /* the side of the cloud that light_options.resolution is for; 0: as fine as pixels */
    int scattering_cells; /* shape_lightgrid_options.scattering_resolution */
    shape_view view;
    size_t bake_voxels; /* at most, of all clouds together */
    int texture_limit, threads;
} gl_order;

enum {
    GL_KEPT_CELLS = 2000000, /* of light, of clouds out of sight */
    GL_KEPT_SWEEP = 64 << 20 /* bytes of a sweep that is kept for the next */
};
/* How much wider than what is seen the pyramid is within which clouds are lit and baked, so that they are ready when a view
 * turns to them. */
#define GL_MARGIN 1.4

/* Metres of the cloud's frame that a pixel covers where the cloud is nearest; 0 inside its box. */
double gl_pixel_size(const shape_volume_cloud *cloud, const shape_view *view);
/* The longest side in pixels of the largest cloud in sight, where that is at its nearest; 0 where there is none. */
double gl_largest_side(const shape_volume *volume, const shape_view *view);
/* Of two finenesses, in things a metre. */
gl_fit gl_fit_sizes(double has, double wants);

/* One cloud's light. */
typedef struct gl_lit {
    atomic_int uses;
    shape_lightgrid grid;
    int wanted; /* cells along the longest side, as the view asked for; 0: a first one, to be replaced */
    int cells, swept; /* along the longest side, of the grid and of the sweep */
    bool stale;       /* its scattered light is of what was there before an edit */
    float *shade; /* a number a cell: the sun's share that clouds let through; NULL where nothing is opaque */
} gl_lit;

/* A sweep that the next one may begin from. */
typedef struct gl_swept {
    atomic_int uses;
    shape_sunsweep *sweep;
} gl_swept;

/* Light grids of clouds, in one atlas. Shared: the last user's drop frees it. */
struct gl_light {
    int uses, count, size[3];
    int made;        /* clouds that were lit for it, not taken over */
    gl_lit **lit;    /* a cloud each; NULL: it has none */
    gl_swept *swept; /* NULL: none is kept */
    gl_box *boxes;
    float *cells; /* scratch, as large as the atlas */
    float *shade; /* the sun's share that clouds let through, for what is opaque; NULL where nothing is */
    GLuint a, b, seen, shade_texture;
    GLuint depth; /* to the sun, of the laws of law.c */
};

shape_status gl_light_make(const gl_order *order, gl_light **made, shape_error *error); /* needs no OpenGL */
/* What one set has, and of the other what it has not. The caller drops *made. */
shape_status gl_light_join(const gl_light *first, const gl_light *second, int texture_limit, gl_light **made,
                           shape_error *error);
void gl_light_upload(gl_light *light); /* the values as they are */
void gl_light_place(const gl_light *light, gl_scene *scene, const shape_volume *volume);
/* Composes the light of the shown clouds for an eye and uploads it. */
shape_status gl_light_compose(gl_light *light, shape_gl_renderer *renderer, shape_dvec3 eye,
                              shape_error *error);
/* Uploads the cells' depths to the sun, once. */
void gl_light_upload_depths(gl_light *light, shape_gl_renderer *renderer);
/* Of the clouds that the view sees, its pyramid made `wider` times as wide and high, the worst. */
gl_fit gl_light_fit(const gl_light *light, const gl_order *order, double wider);
void gl_light_drop(gl_light *light); /* NULL is allowed */

/* One cloud's density. */
typedef struct gl_dense {
    atomic_int uses;
    shape_baked baked;
    float
        wanted; /* voxel that the view asked for [m, cloud's frame]; INFINITY: a first one, to be replaced */
    bool at_limit; /* no finer one fits into the limit of voxels */
    /* Of the drawing thread: where it is in the pool [voxels], and how many of its layers have been sent. */
    bool resident, kept;
    int place[3], sent;
} gl_dense;

/* Baked densities of clouds. Shared like gl_light. */
struct gl_baked {
    int uses, count;
    int made; /* clouds that were baked for it, not taken over */
    gl_dense **dense;
    GLuint texture; /* the pool's */
};

shape_status gl_baked_make(const gl_order *order, gl_baked **made, shape_error *error); /* needs no OpenGL */
/* What one set has, and of the other what it has not. The caller drops *made. */
shape_status gl_baked_join(const gl_baked *first, const gl_baked *second, gl_baked **made,
                           shape_error *error);
void gl_baked_place(const gl_baked *baked, gl_scene *scene);
/* Of the clouds that the view sees, its pyramid made `wider` times as wide and high, the worst. */
gl_fit gl_baked_fit(const gl_baked *baked, const gl_order *order, double wider);
void gl_baked_drop(gl_baked *baked);       /* NULL is allowed */
gl_dense *gl_dense_share(gl_dense *dense); /* NULL is allowed, here and below */
void gl_dense_drop(gl_dense *dense);

/* --- pool.c --- */

/* Zero it before first use. */
typedef struct gl_pool {
    GLuint texture;
    int size[3];      /* texels */
    uint8_t *taken;   /* a flag a cell of 16^3 texels */
    gl_dense **items; /* what is in it */
    size_t count, capacity, resent_bytes;
} gl_pool;

/* Finds places for those of the set that have none; nothing is sent yet. */
shape_status gl_pool_place(gl_pool *pool, const gl_baked *baked, int texture_limit, shape_error *error);
/* Sends what has not been sent of a placed set, about `most` bytes of it; adds to *bytes. Returns whether all is there. */
bool gl_pool_send(gl_pool *pool, const gl_baked *baked, size_t most, size_t *bytes);
/* Sends the bricks of a grid that are flagged (shape_bake_again), where it has been sent already; adds to *bytes. */
void gl_pool_patch(const gl_pool *pool, const gl_dense *dense, const uint8_t *bricks, size_t *bytes);
/* Throws out what is in none of the sets, some of which may be NULL. */
void gl_pool_keep(gl_pool *pool, const gl_baked *const sets[], int count);
void gl_pool_free(gl_pool *pool);

typedef struct gl_grids {
    gl_light *light;
    gl_baked *baked; /* of the default method */
} gl_grids;

/* --- order.c, first.c: an order carried out; needs no OpenGL --- */

void gl_grids_drop(gl_grids *grids);
/* Makes of an order something coarse, of what is wholly missing. */
void gl_order_first(gl_order *order);
/* Makes what is wanted; ms gets how long light and density took, where they were. The caller drops the grids. */
shape_status gl_order_make(const gl_order *order, gl_grids *made, double ms[2], shape_error *error);
/* Whether what shape_gl_take_first has brought is what a first order asks for; then the caller gets it, with its times. */
bool gl_first_use(shape_gl_renderer *renderer, const gl_order *order, gl_grids *grids, double ms[2]);

/* --- surface.c, surface_shade.c: opaque things --- */

typedef struct gl_surface {
    GLuint program, shadow_program, array, buffer;
    GLuint map, map_framebuffer; /* distances towards the sun, as a depth texture */
    gl_target picture;           /* radiance and distance along the ray, of this sample */
    GLuint clouds;               /* records of all clouds, in sight or not */
    int count, solid_count;      /* triangles; those that are not the ground's */
    shape_dvec3 middle;          /* of these; what vertices are relative to */
    float radius;
    bool has_ground, mapped;
    double ground;
    float ground_colour[3];
} gl_surface;

/* The sun's share that clouds let through to each cell of a cloud's light grid; options: that grid's. Needs no OpenGL. */
shape_status gl_shade_make(const gl_order *order, const shape_lightgrid_options *light_options, size_t cloud,
                           gl_lit *lit, shape_error *error);
/* All of them at their places in light->shade; from the light itself where nothing is opaque. */
shape_status gl_shade_pack(gl_light *light, shape_error *error);
/* Tells a program what clouds leave of the sun (shaders/light/shade.glsl): all clouds' records for this eye, in the texture
 * `clouds`, and the share of the sun in their grids. */
shape_status gl_shade_set(shape_gl_renderer *renderer, GLuint program, GLuint clouds, shape_dvec3 eye,
                          shape_error *error);
/* The same of things: the map of what the sun sees of them. */
void gl_set_things(const shape_gl_renderer *renderer, GLuint program, shape_dvec3 eye);
/* Uploads the triangles of options.light.opaque, if there are any. */
shape_status gl_surface_load(shape_gl_renderer *renderer, shape_error *error);
shape_status gl_surface_resize(gl_surface *surface, int width, int height, shape_error *error);
void gl_surface_free(gl_surface *surface);

/* --- passes.c --- */

/* One picture, or one sample of it. */
typedef struct gl_frame {
    const shape_view *view;
    const shape_camera *camera;
    const gl_tiles *tiles;
    const shape_gl_part *part; /* of the view; never of width 0 */
    int sample;
    bool moving, quick; /* quick: of early.c, the first of all pictures */
    float share; /* of what is drawn in the picture that is there already, 1: all; of moving pictures */
} gl_frame;

/* What the default method has of its own. */
typedef struct gl_preview {
    GLuint sky_picture_program, one, fill, several, sky; /* in the order in which they are compiled */
    int warm;              /* how many of them the driver has made ready, too (gl_preview_warm) */
    gl_target coarse;      /* a moving view's first pass: every second pixel each way */
    gl_target sky_picture; /* see shaders/view/sky_picture.glsl */
    bool moving;           /* the last picture was a moving view's */
} gl_preview;

/* What the air needs, see air.c. */
typedef struct gl_air {
    GLuint slice, sum;              /* programs */
    GLuint textures[2];             /* the shadow in slices, and its sum */
    GLuint framebuffers[2], clouds; /* clouds: records of all clouds, in sight or not */
    int size[2];                    /* of a slice's picture */
} gl_air;

typedef struct gl_refinement gl_refinement;
enum { GL_FADE_FRAMES = 6 }; /* from old grids to new ones */

struct shape_gl_renderer {
    shape_gl_options options;
    const shape_volume *volume;
    gl_scene scene;
    gl_grids grids, last_grids; /* the last ones are faded out while fade_left frames remain */
    shape_gl_first *first;      /* what was made before there was a renderer, or NULL */
    gl_refinement *refinement;  /* what is being made on a thread, or NULL */
    gl_grids coming;            /* what it has made, while that is sent to the GPU; NULL where nothing is */
    double coming_ms[2];        /* how long light and baked density of it took */
    gl_update update;
    gl_light *earlier; /* under an earlier sun, for its densities; NULL */
    gl_pool pool;
    int fade_left;
    bool light_changed, refined;
    bool early, early_drawn; /* the picture that is being drawn, any picture: without shaders (early.c) */
    bool unsent;             /* the voxels in use are not on the GPU, since the first picture needs none */
    gl_preview preview;
    gl_surface surface;
    gl_air air;
    int made_for; /* the programs, see make_programs in passes.c */
    shape_light light;
    shape_sky sky;
    float sky_upper[3], sky_lower[3];
    /* By trees, by lists of primitives, and which volumes each is for (view_program.c). */
    GLuint view_programs[2];
    int view_kinds[2];
    GLuint tonemap, density, empty_array;
    GLuint copy, heat, query;
    shape_gl_part part;
    gl_target mean, parts[2]; /* the picture; two to draw a long sample in parts, each from the other */
    int width, height;
    float window_length; /* of the exact view's candidates [m] */
    shape_gl_costs costs;
};

/* Compares a volume that is about to be loaded with the one that is; false where no grids may stay. */
bool gl_update_begin(shape_gl_renderer *renderer, const shape_volume *volume);
/* After that volume has been loaded: makes again what differs of the grids that are there. */
shape_status gl_update_do(shape_gl_renderer *renderer, const gl_order *order, shape_error *error);
void gl_update_free(gl_update *update);
/* --- draw.c --- */

/* Over the whole target, or what a scissor leaves of it. */
void gl_draw_triangle(const shape_gl_renderer *renderer);
/* What is drawn next is blended into the running mean: sample n counts 1 / (n + 1). */
void gl_begin_mean(int sample);
/* What is drawn next is blended into the picture that is there, with this share. */
void gl_begin_mix(float share);

/* --- view_program.c: the methods that draw the whole picture by one program --- */

bool gl_is_paper(const shape_gl_renderer *renderer);
/* Compiles what the first picture will need. */
shape_status gl_prepare_view(shape_gl_renderer *renderer, shape_error *error);
/* Steps, candidates and starts of a method. */
void gl_set_method(const shape_gl_renderer *renderer, const shape_view *view, GLuint program);
/* Uses the view program, by lists or by trees, and tells it all that it may ask for; *used gets it. */
shape_status gl_use_view(shape_gl_renderer *renderer, const gl_frame *frame, bool listed, GLuint *used,
                         shape_error *error);

/* --- law.c: by what points are lit --- */

shape_gl_law gl_law(const shape_gl_renderer *renderer);
shape_status gl_law_check(const shape_gl_lighting *lighting, shape_error *error);
/* Whether the sky lights anything by it. */
bool gl_law_has_sky(shape_gl_law law);
/* Adds the line by which shaders are made for it, or nothing. */
void gl_law_define(const shape_gl_renderer *renderer, char *defines, size_t size);
/* Ambient light and emission: added to a cloud's cells as the eye sees them; and put into all clouds' records. */
void gl_law_glow(const shape_gl_renderer *renderer, const shape_medium *medium, size_t cells, float *rgba);
void gl_law_place(const shape_gl_renderer *renderer, gl_scene *scene);
/* Tells a marching program of it; after gl_set_grids. The program is in use. */
void gl_set_law(const shape_gl_renderer *renderer, const gl_grids *grids, GLuint program);

/* --- refine.c --- */

/* Before a picture: makes what it needs, or, in the background, something coarse, with the rest to come. */
shape_status gl_refine(shape_gl_renderer *renderer, const shape_view *view, shape_error *error);
/* Sends the voxels in use to the GPU, where that has not been done. */
shape_status gl_refine_send(shape_gl_renderer *renderer, shape_error *error);
/* Breaks the thread off, waits for it and throws away what it made. */
void gl_refine_stop(shape_gl_renderer *renderer);

/* --- surface.c, of a renderer --- */

/* Draws what is opaque, for the passes that march up to it. */
void gl_surface_draw(shape_gl_renderer *renderer, const gl_frame *frame);
/* Tells a marching program where rays end; the program is in use. */
void gl_set_surface(const shape_gl_renderer *renderer, GLuint program);

/* --- air.c --- */

/* Whether this renderer shows any. */
bool gl_has_air(const shape_gl_renderer *renderer);
/* Lays out the shadow of the air for a frame, where there is air; after gl_surface_draw. */
shape_status gl_air_draw(shape_gl_renderer *renderer, const gl_frame *frame, shape_error *error);
/* Tells a marching program of it; the program is in use. */
void gl_set_air(const shape_gl_renderer *renderer, GLuint program, shape_dvec3 eye);
void gl_air_free(gl_air *air);

/* --- preview.c: the default method --- */

enum { GL_PREVIEW_PROGRAMS = 5 };
/* How many of them a moving view of the volume needs. */
int gl_preview_needed(const shape_gl_renderer *renderer);
/* Compiles those of the first `count` programs that are not compiled yet. */
shape_status gl_preview_compile(shape_gl_renderer *renderer, int count, shape_error *error);
/* Draws next to nothing by one more program, since drivers compile the rest of a shader when it is first drawn with. */
shape_status gl_preview_warm(shape_gl_renderer *renderer, const gl_grids *grids, const gl_frame *frame,
                             shape_error *error);
/* marching: those alone that light comes into. */
void gl_preview_drop_programs(gl_preview *preview, bool marching);
shape_status gl_preview_resize(gl_preview *preview, int width, int height, shape_error *error);
void gl_preview_draw(shape_gl_renderer *renderer, const gl_grids *grids, const gl_frame *frame);
void gl_preview_free(gl_preview *preview);

/* --- early.c: the same without shaders --- */

/* Draws a moving view's picture on the CPU, after gl_light_compose and gl_tiles_make for it. No opaque things, no air. */
shape_status gl_early_draw(shape_gl_renderer *renderer, const gl_grids *grids, const gl_frame *frame,
                           shape_error *error);

/* --- parts.c: the exact method --- */

/* Draws a sample in parts: a part stops a pixel after some work and says where; the next goes on from there, until all are
 * finished. The first one reads lists of primitives, where there are any, the others walk trees. */
shape_status gl_draw_in_parts(shape_gl_renderer *renderer, const gl_frame *frame, shape_error *error);

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
void gl_set_camera(const gl_frame *frame, GLuint program);

#endif
