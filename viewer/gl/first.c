/* The first picture's light and density, made before there is a renderer: while OpenGL is still being started. */
#include <stdlib.h>
#include <string.h>

#include "gl_private.h"

struct shape_gl_first {
    shape_light light;
    gl_order order;
    gl_grids grids;
    double ms[2]; /* that light and density took */
};

shape_status shape_gl_first_make(const shape_gl_options *options, const shape_volume *volume,
                                 const shape_light *light, const shape_view *view, shape_gl_first **made,
                                 shape_error *error)
{
    enum { FEW = 4, LEAST_LIMIT = 256 /* of every GPU's 3-D textures */ };
    *made = NULL;
    if (options->method != SHAPE_GL_DEFAULT || !options->background ||
        options->lighting.law != SHAPE_GL_LAW_GRID)
        return SHAPE_OK;
    shape_gl_first *first = calloc(1, sizeof *first);
    if (!first)
        return shape_error_memory(error);
    first->light = *light;
    first->order = (gl_order){.volume = volume,
                              .light = &first->light,
                              .want_light = true,
                              .want_baked = true,
                              .light_options = options->light,
                              .light_pixels = options->fixed_light ? gl_largest_side(volume, view) : 0,
                              .all_clouds = options->light.opaque || light->air.visibility > 0,
                              .view = *view,
                              .bake_voxels = options->bake_voxels,
                              .stop = options->stop,
                              .texture_limit = LEAST_LIMIT,
                              /* Starting OpenGL keeps a core busy, and is not done sooner. */
                              .threads = volume->cloud_count > FEW ? 0 : 1};
    gl_order_first(&first->order);
    shape_status status = gl_order_make(&first->order, &first->grids, first->ms, error);
    if (status == SHAPE_ERROR_LIMIT)
        status = SHAPE_OK; /* the renderer makes them, by what its GPU can */
    if (status) {
        shape_gl_first_free(first);
        return status;
    }
    *made = first;
    return SHAPE_OK;
}

void shape_gl_first_free(shape_gl_first *first)
{
    if (!first)
        return;
    gl_grids_drop(&first->grids);
    free(first);
}

void shape_gl_take_first(shape_gl_renderer *renderer, shape_gl_first *first)
{
    shape_gl_first_free(renderer->first);
    renderer->first = first;
}

static bool same_place(shape_dvec3 a, shape_dvec3 b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

bool gl_first_use(shape_gl_renderer *r, const gl_order *order, gl_grids *grids, double ms[2])
{
    shape_gl_first *first = r->first;
    if (!first)
        return false;
    const gl_order *own = &first->order;
    bool fits = order->want_light && order->want_baked && own->volume == order->volume &&
                first->grids.light && first->grids.baked && own->all_clouds == order->all_clouds &&
                own->bake_voxels == order->bake_voxels && same_place(first->light.sun, order->light->sun) &&
                same_place(own->view.eye, order->view.eye) &&
                same_place(own->view.target, order->view.target) && own->view.fov == order->view.fov &&
                own->view.height == order->view.height && own->view.width == order->view.width;
    if (fits) {
        *grids = first->grids;
        memset(&first->grids, 0, sizeof first->grids);
        memcpy(ms, first->ms, sizeof first->ms);
    }
    shape_gl_take_first(r, NULL);
    return fits;
}
