/* Density, albedo and extinction of a cloud at a point: which model, with details or without. Mirrored by
 * shaders/field/cloud.glsl. */
#include <math.h>

#include "field/density_model.h"
#include "field/detail.h"
#include "shape/grid.h"
#include "shape/volume.h"

float shape_cloud_density_at(const shape_volume_cloud *cloud, shape_vec3 p, float u2)
{
    if (!(u2 <= cloud->support * cloud->support))
        return 0;
    if (cloud->detailed)
        return detail_density(cloud, p);
    switch (cloud->field.model) {
    case SHAPE_MODEL_UNIFORM:
        return 1;
    case SHAPE_MODEL_SPHEROID:
        return density_spheroid(cloud, p, sqrtf(u2));
    case SHAPE_MODEL_METABALL:
        return density_metaball(cloud, p, density_metaball_sum(cloud->list, p));
    case SHAPE_MODEL_GRID:
        return shape_grid_sample(cloud->list->grid, p);
    case SHAPE_MODEL_LAYER: /* always detailed */
        break;
    }
    return 0;
}

float shape_cloud_density(const shape_volume_cloud *cloud, shape_vec3 p)
{
    return shape_cloud_density_at(cloud, p, shape_cloud_u2(cloud, p));
}

bool shape_cloud_is_coloured(const shape_volume_cloud *cloud)
{
    return cloud->field.model == SHAPE_MODEL_GRID && cloud->list->grid->coloured;
}

void shape_cloud_albedo(const shape_volume_cloud *cloud, shape_vec3 p, float rgb[3])
{
    rgb[0] = rgb[1] = rgb[2] = 1;
    if (shape_cloud_is_coloured(cloud))
        shape_grid_colour(cloud->list->grid, p, rgb);
    for (int c = 0; c < 3; c++)
        rgb[c] = fminf(rgb[c] * cloud->medium.albedo, 1);
}

double shape_volume_extinction(const shape_volume *volume, shape_dvec3 world)
{
    double sum = 0;
    for (size_t i = 0; i < volume->cloud_count; i++) {
        const shape_volume_cloud *cloud = &volume->clouds[i];
        shape_dvec3 p = shape_frame_point(&cloud->inverse, world);
        shape_vec3 local = {(float)p.x, (float)p.y, (float)p.z};
        sum += (double)cloud->medium.extinction * (double)shape_cloud_density(cloud, local);
    }
    return sum;
}
