/* The light of light grids as voxels: what engines store beside density. */
#ifndef SHAPE_LIGHTVOXELS_H
#define SHAPE_LIGHTVOXELS_H

#include "shape/lightgrid.h"
#include "shape/voxels.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Light grids of all clouds of a volume, and the light that they were made for. */
typedef struct shape_lightvoxels {
    const shape_volume *volume;
    shape_lightgrid *grids; /* one a cloud */
    float sun[3], upper[3], lower[3];
    float *thin; /* a cloud's 1 - albedo times the share of its forward peak */
} shape_lightvoxels;

/* Builds the grids with that many cells along each cloud's longest side (2 to 256). The volume must outlive them; the
 * caller frees by shape_lightvoxels_free. */
shape_status shape_lightvoxels_build(const shape_volume *volume, const shape_light *light, int resolution,
                                     int threads, shape_lightvoxels *made, shape_error *error);
void shape_lightvoxels_free(shape_lightvoxels *made);

/* The sample of a shape_voxel_request, with a shape_lightvoxels as context: the mean over all directions of the radiance
 * at a point (red, green, blue), from the sun, the sky, and the cloud's own scattering. Times albedo and extinction it is
 * what the point scatters towards any eye, if it scatters evenly. */
void shape_lightvoxels_sample(const void *context, size_t cloud, shape_vec3 p, float value[3]);

#ifdef __cplusplus
}
#endif
#endif
