/* shape_gl: draws a volume with OpenGL 3.3, in a window of the caller's or without one. All functions need the context
 * that the renderer was made in to be current, and are not thread-safe. */
#ifndef SHAPE_GL_H
#define SHAPE_GL_H

#include <stdbool.h>

#include "shape/lightgrid.h"
#include "shape/view.h"
#include "shape/volume.h"

/* --- context.c: OpenGL without a window (EGL surfaceless; Mesa's llvmpipe where there is no GPU) --- */

typedef struct shape_gl_context shape_gl_context;

/* Makes a context and makes it current. SHAPE_ERROR_SYSTEM says what is missing. */
shape_status shape_gl_context_create(shape_gl_context **context, shape_error *error);
void shape_gl_context_destroy(shape_gl_context *context); /* NULL is allowed */

/* Whether the driver has lost the current context (a GPU that was reset, or taken away). All that was in it is gone, and
 * nothing but making another one helps. Always false where the driver cannot tell. */
bool shape_gl_is_lost(void);

/* --- passes.c: the renderer --- */

typedef enum shape_gl_method {
    SHAPE_GL_DEFAULT,  /* the preview */
    SHAPE_GL_EXACT,    /* the analytic field, small steps */
    SHAPE_GL_PAPER,    /* Jiménez 2018 Algorithm 1, as printed */
    SHAPE_GL_PAPER_NDT /* the same with Algorithm 2's sweep in the view */
} shape_gl_method;

/* By what a point of a cloud is lit, by the methods default and exact: the lights of shape/march.h that need the light pass
 * alone, whose cells the laws take the optical depth to the sun from. */
typedef enum shape_gl_law {
    SHAPE_GL_LAW_GRID, /* all scatterings of sun and sky */
    SHAPE_GL_LAW_SINGLE,
    SHAPE_GL_LAW_POWDER,
    SHAPE_GL_LAW_POWDER_ANGLE,
    SHAPE_GL_LAW_BEER_MAX,
    SHAPE_GL_LAW_OCTAVES
} shape_gl_law;

/* The members are those of shape_march_options. The methods of 2018 have a light of their own, and nothing of this. */
typedef struct shape_gl_lighting {
    shape_gl_law law;
    float powder;      /* k of the powder laws, 0 to 1000 */
    int octaves;       /* copies that octaves sum, 1 to 8 */
    float ambient[3];  /* radiance that reaches every point alike, 0 to 1e9 */
    float emission[3]; /* of density 1, radiance a metre, 0 to 1e9; clouds of extinction 0 show none */
} shape_gl_lighting;

typedef struct shape_gl_options {
    shape_gl_method method;
    shape_gl_lighting lighting; /* to begin with; default: by the grid, powder 2, 8 octaves, nothing else */
    const char *shader_folder;  /* read shaders from here instead of the built-in ones; NULL */
    shape_lightgrid_options light;
    /* The largest cloud in sight has light.resolution cells along its longest side in whatever view, and the others as many
     * fewer as they are smaller in the picture; default: a cell is a pixel and a half at least. */
    bool fixed_light;
    size_t bake_voxels; /* of all clouds' baked grids together, at most */
    uint64_t seed;      /* of the random starts of rays; default 1 */
    bool no_background; /* the sky lights the clouds and is not seen behind them */
    bool
        background; /* default method: draw at once by something coarse, and make the rest on a thread meanwhile */
    bool
        early; /* default method: moving views of clouds alone are drawn on the CPU until the shaders are compiled, which
                   happens bit by bit meanwhile; no matter with a shader_folder, opaque things or air */
    /* Asked while something is made that a picture waits for; where it is true, drawing returns SHAPE_ERROR_STOPPED, and may be
     * tried again. What is made meanwhile, on a thread, ends with the next load or the renderer. Default none. */
    shape_stop stop;
    bool paper_lod; /* the paper's printed distance formula for its step, rather than 0.1 */
} shape_gl_options;

shape_gl_options shape_gl_defaults(void);

typedef struct shape_gl_renderer shape_gl_renderer;

/* What the work cost. Times in milliseconds, of the last call of each kind. */
typedef struct shape_gl_costs {
    double upload_ms, light_ms, bake_ms;
    double steps_per_pixel, fetches_per_pixel; /* of the last picture read by shape_gl_read */
    size_t lit_clouds,
        baked_clouds; /* how often a cloud's light was made, and its density baked, since the beginning */
    size_t relit_clouds,
        rebaked_clouds; /* how often only what an edit changed was made again of a cloud's light, and of its density */
    size_t light_bytes,
        baked_bytes; /* that were sent to the GPU, of light as seen and of baked density, since then */
} shape_gl_costs;

/* Compiles the shaders. The caller destroys it. */
shape_status shape_gl_create(const shape_gl_options *options, shape_gl_renderer **renderer,
                             shape_error *error);
void shape_gl_destroy(shape_gl_renderer *renderer); /* NULL is allowed */

/* --- first.c: what the first picture needs of the processor, made while a context is being opened --- */

typedef struct shape_gl_first shape_gl_first;

/* Light and density for a renderer's first picture, for options with `background` set; else *made is NULL. Needs no OpenGL,
 * and may run on any thread. The volume must live as long as what is made. */
shape_status shape_gl_first_make(const shape_gl_options *options, const shape_volume *volume,
                                 const shape_light *light, const shape_view *view, shape_gl_first **made,
                                 shape_error *error);
void shape_gl_first_free(shape_gl_first *first); /* NULL is allowed */
/* The renderer takes it over. It is used where the first picture is of that volume, light and view, and no matter else. */
void shape_gl_take_first(shape_gl_renderer *renderer, shape_gl_first *first);

/* Uploads a volume; it must live until the next load has returned, or the end. With options.background the default method
 * compares it with the one before, cloud by cloud: grids of clouds that have not changed stay, and where few primitives have,
 * they are made again only there (shape/change.h), with the next picture; the scattered light follows, as does all that is
 * made meanwhile. shape_volume_keep_boxes makes that likelier. */
shape_status shape_gl_load(shape_gl_renderer *renderer, const shape_volume *volume, shape_error *error);
/* Whether, if this volume were loaded, the grids that are there would stay but for what an edit changed, so that the next
 * picture would not have to wait for others. */
bool shape_gl_stays(const shape_gl_renderer *renderer, const shape_volume *volume);
/* Sets the light; needed after shape_gl_load. The light pass, on the CPU, is made before the next picture. */
shape_status shape_gl_light(shape_gl_renderer *renderer, const shape_light *light, shape_error *error);

/* Sets by what the clouds are lit. Compiles shaders where it is another law. */
shape_status shape_gl_set_lighting(shape_gl_renderer *renderer, const shape_gl_lighting *lighting,
                                   shape_error *error);

/* A part of a picture: x and y of its lower left corner, from the whole's, in pixels; both multiples of
 * SHAPE_GL_PART_STEP, so that parts join without a seam: they are what the whole would be. */
enum { SHAPE_GL_PART_STEP = 32 };
typedef struct shape_gl_part {
    int x, y, width, height; /* width 0: the whole */
} shape_gl_part;

/* What is drawn from now on is that part of the view, for pictures larger than the GPU draws at once. Not while light and
 * density are made in the background. */
void shape_gl_set_part(shape_gl_renderer *renderer, shape_gl_part part);
/* The longest side of a picture, or part, that the GPU draws, at least 32. */
int shape_gl_largest(void);

/* Draws sample number `sample` of a picture into the renderer's buffer: sample 0 begins a new picture, each further one
 * refines it (other starts of the rays, other places within the pixels). Returns without waiting for the GPU. */
shape_status shape_gl_draw(shape_gl_renderer *renderer, const shape_view *view, int sample,
                           shape_error *error);
/* Draws a picture of a view that moves, as a sample 0 that is good enough for a moment: of the default method, every
 * second pixel each way is marched and the others are taken from their neighbours where those agree. The other methods
 * draw what shape_gl_draw draws. */
shape_status shape_gl_draw_moving(shape_gl_renderer *renderer, const shape_view *view, shape_error *error);
/* Whether something finer has come into use since the last call: time to begin a picture at rest anew. */
bool shape_gl_refined(shape_gl_renderer *renderer);
/* Whether something finer is still to come, or fading in: draw on. */
bool shape_gl_pending(const shape_gl_renderer *renderer);
/* Waits until all that was drawn is done. */
void shape_gl_finish(void);
/* Reads the picture: linear radiance, rows from the top, width * height * 4 floats into the caller's buffer (red,
 * green, blue, coverage). Fills the costs. */
shape_status shape_gl_read(shape_gl_renderer *renderer, float *rgba, shape_error *error);
/* Shows the picture in the current framebuffer (a window of the view's size), tone-mapped. */
void shape_gl_show(shape_gl_renderer *renderer, float exposure_stops, int width, int height);
/* What a heat map shows of each pixel. */
typedef enum shape_gl_heat {
    SHAPE_GL_HEAT_STEPS,
    SHAPE_GL_HEAT_FETCHES, /* texels read */
    SHAPE_GL_HEAT_CANDIDATES, /* primitives whose support the ray hits, of the methods that look at primitives; the
                                 default method marches baked density, and has none */
    SHAPE_GL_HEAT_DEPTH       /* optical depth of the clouds; where something opaque stands it is infinite */
} shape_gl_heat;

/* Shows a map in the same way, from black over red and yellow to white at `full`. */
void shape_gl_show_heat(shape_gl_renderer *renderer, shape_gl_heat kind, float full, int width, int height);
shape_gl_costs shape_gl_get_costs(const shape_gl_renderer *renderer);

/* For the tests: density (red), u^2 (green) and noise (blue) at `count` points of cloud 0, by the shaders. */
shape_status shape_gl_densities(shape_gl_renderer *renderer, const shape_vec3 *points, int count, float *rgba,
                                shape_error *error);

#endif
