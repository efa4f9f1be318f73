/* An order of light and baked density carried out, on whatever thread; needs no OpenGL. */
#include <string.h>
#include <time.h>

#include "gl_private.h"

enum {
    FIRST_LIGHT = 40, /* cells along the longest side, to begin with: the sun's own light */
    FIRST_SCATTERING =
        12, /* the same of the scattered light, which takes much longer: cells of a single cloud, */
    FEW_SCATTERING = 3,    /* of one among very many */
    ALL_SCATTERING = 4000, /* of all clouds together */
    FIRST_VOXELS = 150000  /* of all clouds together */
};

void gl_grids_drop(gl_grids *grids)
{
    gl_light_drop(grids->light);
    gl_baked_drop(grids->baked);
    memset(grids, 0, sizeof *grids);
}

static double now_ms(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return 1e3 * (double)time.tv_sec + 1e-6 * (double)time.tv_nsec;
}

shape_status gl_order_make(const gl_order *order, gl_grids *made, double ms[2], shape_error *error)
{
    double start = now_ms();
    shape_status status = order->want_light ? gl_light_make(order, &made->light, error) : SHAPE_OK;
    double middle = now_ms();
    if (!status && order->want_baked)
        status = gl_baked_make(order, &made->baked, error);
    if (order->want_light)
        ms[0] = middle - start;
    if (order->want_baked)
        ms[1] = now_ms() - middle;
    return status;
}

/* Cells along the longest side of each cloud's first scattered light: the fewer the more clouds are to be lit. */
static int first_scattering(const gl_order *order)
{
    int clouds = 0, cells = FIRST_SCATTERING;
    shape_camera camera = shape_view_camera(&order->view);
    for (size_t i = 0; i < order->volume->cloud_count; i++)
        clouds += !(order->light_from && order->light_from->lit[i]) &&
                  gl_in_sight(&order->volume->clouds[i], &camera, GL_MARGIN);
    while (cells > FEW_SCATTERING && clouds * cells * cells * cells > ALL_SCATTERING)
        cells--;
    return cells;
}

void gl_order_first(gl_order *order)
{
    order->first = order->missing_only = true;
    if (order->light_options.resolution > FIRST_LIGHT)
        order->light_options.resolution = FIRST_LIGHT;
    order->scattering_cells = first_scattering(order);
    if (order->bake_voxels > FIRST_VOXELS)
        order->bake_voxels = FIRST_VOXELS;
}
