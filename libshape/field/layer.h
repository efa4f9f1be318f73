/* Private to field/: the layer model. */
#ifndef SHAPE_FIELD_LAYER_H
#define SHAPE_FIELD_LAYER_H

#include "shape/volume.h"

/* Density at p, already displaced, of a layer. */
float layer_density(const shape_volume_cloud *cloud, shape_vec3 p);

#endif
