/* How well voxels hold a density: trilinear interpolation between their centres against the density itself, at random
 * points of the supports. Nothing is filled for it. */
#include <math.h>
#include <stdlib.h>

#include "field/voxels_private.h"
#include "shape/random.h"

/* Density as a voxel would have it: clouds weighed by extinction; a ramp is not part of the question. */
static double density_at(const shape_volume *volume, int cloud, float most, shape_dvec3 world)
{
    double sum = 0;
    for (size_t i = 0; i < volume->cloud_count; i++) {
        const shape_volume_cloud *c = &volume->clouds[i];
        if (cloud >= 0 && i != (size_t)cloud)
            continue;
        shape_dvec3 p = shape_frame_point(&c->inverse, world);
        float weight = most > 0 ? c->medium.extinction / most : 1;
        sum += (double)(weight * shape_cloud_density(c, shape_vec3_make((float)p.x, (float)p.y, (float)p.z)));
    }
    return sum;
}

static double interpolated(const shape_volume *volume, const shape_voxel_lattice *l, int cloud, float most,
                           const double at[3])
{
    double sum = 0;
    int32_t base[3];
    double part[3];
    for (int k = 0; k < 3; k++) {
        double v = (at[k] - l->origin[k]) / l->edge;
        base[k] = (int32_t)floor(v);
        part[k] = v - base[k];
    }
    for (int corner = 0; corner < 8; corner++) {
        int32_t index[3];
        double weight = 1;
        for (int k = 0; k < 3; k++) {
            int up = corner >> k & 1;
            index[k] = base[k] + up;
            weight *= up ? part[k] : 1 - part[k];
        }
        sum += weight * density_at(volume, cloud, most, shape_voxel_point(l, index));
    }
    return sum;
}

/* A random point of a random form's box that lies in the form. */
static void draw_point(shape_random *random, const voxel_forms *forms, double at[3])
{
    const voxel_form *f = &forms->items[(size_t)(shape_random_unit(random) * (double)forms->count)];
    for (int round = 0; round < 100; round++) {
        double u2 = 0, v[3];
        for (int k = 0; k < 3; k++) {
            v[k] = shape_random_range(random, -1, 1) * (double)f->h[k];
            at[k] = f->c[k] + v[k];
        }
        for (int i = 0; i < 3; i++) {
            double x = (double)f->m[i][0] * v[0] + (double)f->m[i][1] * v[1] + (double)f->m[i][2] * v[2];
            u2 += x * x;
        }
        if (u2 <= 1)
            return;
    }
}

shape_status shape_voxels_error(const shape_volume *volume, const shape_voxel_request *request, double edge,
                                int samples, uint64_t seed, double *rmse, shape_error *error)
{
    double min[3], max[3], sum = 0;
    float most = 0;
    shape_voxel_lattice lattice, metres = {.edge = 1};
    voxel_forms forms;
    *rmse = 0;
    if (samples < 1)
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "%d samples (at least 1 is needed)", samples);
    bool any;
    shape_status status = shape_voxels_bounds(volume, request->cloud, false, min, max, &any, error);
    if (status || !any)
        return status;
    status = shape_voxels_lay_out(min, max, edge, false, &lattice, error);
    if (!status)
        status = voxel_forms_make(volume, request->cloud, &metres, &forms, error);
    if (status)
        return status;
    double(*points)[3] = malloc((size_t)samples * sizeof *points);
    double *squares = malloc((size_t)samples * sizeof *squares);
    if (!points || !squares) {
        free(points);
        free(squares);
        free(forms.items);
        return shape_error_memory(error);
    }
    shape_random random = shape_random_seed(seed, 0);
    for (int i = 0; i < samples; i++)
        draw_point(&random, &forms, points[i]);
    free(forms.items);
    for (size_t i = 0; i < volume->cloud_count; i++)
        if ((request->cloud < 0 || i == (size_t)request->cloud) && volume->clouds[i].medium.extinction > most)
            most = volume->clouds[i].medium.extinction;
#pragma omp parallel for schedule(dynamic, 64)
    for (int i = 0; i < samples; i++) {
        double d = interpolated(volume, &lattice, request->cloud, most, points[i]) -
                   density_at(volume, request->cloud, most,
                              shape_dvec3_make(points[i][0], points[i][1], points[i][2]));
        squares[i] = d * d;
    }
    for (int i = 0; i < samples; i++)
        sum += squares[i];
    free(points);
    free(squares);
    *rmse = sqrt(sum / samples);
    return SHAPE_OK;
}
