/* Private to field/: details on a cloud of primitives. */
#ifndef SHAPE_FIELD_DETAIL_H
#define SHAPE_FIELD_DETAIL_H

#include "shape/volume.h"

/* How far beyond a primitive's surface, in radii, it still counts for a cloud's density: the factor of detail_tree. */
float detail_reach(const shape_field *field, float support);
/* Fills what a cloud with details, or a layer, needs besides lists and trees. */
void detail_prepare(shape_volume_cloud *cloud);
/* Density at p of such a cloud; 0 outside its supports. */
float detail_density(const shape_volume_cloud *cloud, shape_vec3 p);

#endif
