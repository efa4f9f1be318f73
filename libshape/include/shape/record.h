/* What the shaders of shaders/ read of a cloud: its record, 36 texels of a float texture. For programs that draw clouds
 * with these shaders in a renderer of their own; shaders/README.md lists the other inputs.
 *
 * Texels, each x, y, z, w:
 *   0..2    rows of the world-to-cloud matrix; w: the eye in the cloud's frame
 *   3, 4    box, low with the extinction (of a voxel grid: that of its largest value), high with the number of its tree's
 *           first node
 *   5       kappa, octaves, 1 / noise scale, model
 *   6       first sphere, first ellipsoid, nodes of the tree, support
 *   7       edge, spheres, ellipsoids, metres of the world a noise cell
 *   8       light grid: its place in the light textures [cells]
 *   9       light grid: cells along x, y, z; droplet diameter
 *   10, 11  light grid: box
 *   12..15  noise offsets of 16 octaves, x + 64 y + 4096 z
 *   16      albedo, phase function, g, g2
 *   17      lobe mix, mean cosine, share in the phase function's peak, g of the rest
 *   18..23  the program's own (the viewer keeps the places of a baked density and of a voxel grid there); these functions
 *           leave them alone
 *   24      whether the cloud has details or is a layer (else the rest is 0), first sphere and ellipsoid of its shapes,
 *           nodes of the shapes' tree
 *   25      the first of them, smoothness, displace, 1 / displace_scale
 *   26      billow, wisp, 1 / detail_depth, 1 / detail_scale
 *   27      base, 1 / height
 *   28, 29  keys of the noises, in halves of 16 bits, the low one first
 *   30      layer: bounds, noise, blend, gain
 *   31      layer: Worley's gain, frequency and octaves; planet's radius
 *   32      layer: A, B, coverage, cut
 *   33      layer: falloff, fades at the bottom, the top, the sides
 *   34      layer: 1 / cell along x, y, z; w, of any cloud: shape_beam_peak's `ahead`
 *   35      x, y, z the program's own (the viewer keeps ambient light and emission there), 0 without; w: shape_beam_peak's cap
 */
#ifndef SHAPE_RECORD_H
#define SHAPE_RECORD_H

#include "shape/lightgrid.h"
#include "shape/volume.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { SHAPE_RECORD_TEXELS = 36 };
typedef float shape_record[SHAPE_RECORD_TEXELS][4];

/* Where a cloud's primitives and tree nodes begin in the textures of all clouds: numbers of spheres, of ellipsoids and of
 * nodes, not of texels. Its supports' (`list`, `tree`), and its shapes' (`shape_list`, `detail_tree`), which only clouds
 * with details and layers have. */
typedef struct shape_record_places {
    size_t spheres, ellipsoids, nodes;
    size_t shape_spheres, shape_ellipsoids, shape_nodes;
} shape_record_places;

/* Fills what depends neither on the eye nor on the light: texels 3 to 7, 12 to 17, and from 24 on (0 where there are no details, but
 * the w of 34 and 35). */
void shape_record_fill(shape_record record, const shape_volume_cloud *cloud,
                       const shape_record_places *places);
/* Texels 8 to 11. place [cells]: where the grid's first cell lies in the light textures; NULL: at their beginning. */
void shape_record_set_light(shape_record record, const shape_volume_cloud *cloud, const shape_lightgrid *grid,
                            const int place[3]);
/* Texels 0 to 2, for an eye in world space. The shaders' rays begin at the eye, so that single precision is enough however
 * far from the world's origin it is. */
void shape_record_set_eye(shape_record record, const shape_volume_cloud *cloud, shape_dvec3 eye);

#ifdef __cplusplus
}
#endif
#endif
