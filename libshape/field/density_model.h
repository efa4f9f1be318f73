/* Private to field/: the models' densities at a point p in the cloud's frame, already displaced. */
#ifndef SHAPE_FIELD_DENSITY_MODEL_H
#define SHAPE_FIELD_DENSITY_MODEL_H

#include "shape/volume.h"

/* The field's own fBm noise. */
float density_fbm(const shape_volume_cloud *cloud, shape_vec3 p);
/* Jiménez 2018 Eq. 2, for noise n at distance u; 0 to 1, also where n is 0 and kappa 1. */
float density_gamma(float kappa, float n, float u);
/* Jiménez 2018 Eq. 2 and Algorithm 1, at distance u. */
float density_spheroid(const shape_volume_cloud *cloud, shape_vec3 p, float u);
/* Eq. 20: the balls' field at p; Eq. 21: the density there. */
float density_metaball_sum(const shape_primitives *list, shape_vec3 p);
float density_metaball(const shape_volume_cloud *cloud, shape_vec3 p, float sum);

/* Whether a node of a tree holds p. */
static inline bool density_node_holds(const shape_tree_node *n, shape_vec3 p)
{
    return p.x >= n->min.x && p.x <= n->max.x && p.y >= n->min.y && p.y <= n->max.y && p.z >= n->min.z &&
           p.z <= n->max.z;
}

#endif
